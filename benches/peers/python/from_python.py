"""This project from Python, beside SciPy: time at equal measured error for W1 (to the 20th impact) and W3 (to 10 s).

python from_python.py [ROUNDS] needs the package, SciPy and numba; rounds are interleaved, and the least time of each case counts.
"""

import json
import math
import sys
import time
from pathlib import Path

import problems
import scipy_peer

import dalembert

REFERENCE = json.loads((Path(__file__).parents[1] / "reference.json").read_text())
IMPACTS = [float(impact[0]) for impact in REFERENCE["W1"]]
UNTIL = {"W1": IMPACTS[-1] + 0.1, "W3": 10.0}
WANTED = {"W1": (1e-6, 1e-9, 1e-11), "W3": (1e-3, 1e-5, 1e-7)}


def package(integrator):
    """Runs of this package."""
    pendulum, disk = dalembert.models.double_pendulum, dalembert.models.rolling_disk

    def solve(work, tolerance):
        arguments = {"integrator": integrator, "tol": max(tolerance, 1e-15), "until": UNTIL[work], "samples": 0}
        if work == "W3":
            run = pendulum.simulate(q=[2, 2.5], qdot=[0, 0], **arguments)
            return run.last["theta1"]
        return disk.simulate(state={"theta_dot": 10, "phi_dot": 0.2, "phi": math.pi / 2}, **arguments).events["t"]

    return solve


def scipy(work, tolerance):
    """Runs of SciPy with functions compiled by numba."""
    state, times, _, _ = scipy_peer.run(work, UNTIL[work], tolerance)
    return state[0] if work == "W3" else times


def error(work, found):
    if work == "W3":
        return abs(found - float(REFERENCE[work]["10"][0]))
    return abs(found[-1] - IMPACTS[-1]) if len(found) == len(IMPACTS) else math.inf


def at(wanted, cases):
    """The shortest time among the tolerances that reach the wanted error."""
    return min((seconds for seconds, found in cases if found <= wanted), default=math.nan)


def main(rounds):
    peers = {"dalembert, taylor": package("taylor"), "dalembert, dop853": package("dop853"), "SciPy DOP853, numba": scipy}
    for work in UNTIL:
        cases = {(name, tolerance): [math.inf, math.inf] for name in peers for tolerance in problems.TOLERANCES}
        for _ in range(rounds + 1):
            for (name, tolerance), case in cases.items():
                begun = time.perf_counter()
                found = peers[name](work, tolerance)
                case[0] = min(case[0], time.perf_counter() - begun)
                case[1] = error(work, found)
        for name in peers:
            mine = [tuple(case) for (peer, _), case in cases.items() if peer == name]
            times = ", ".join(f"{1e3 * at(wanted, mine):.3g} ms at {wanted:.0e}" for wanted in WANTED[work])
            print(f"{work}  {name:20}  {times}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 5)
