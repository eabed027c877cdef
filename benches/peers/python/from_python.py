"""This project from Python beside other programs from Python: time at equal measured error for W1 (to the 20th impact) and W3 (to 10 s).

python from_python.py [ROUNDS] needs this package and those of the peers: heyoka, scipy, numba, diffrax, pydy with cython. A peer whose
packages are missing is left out. Rounds are interleaved, and the least time of each case counts. Compilation is not counted.
"""

import json
import math
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import problems

REFERENCE = json.loads((Path(__file__).parents[1] / "reference.json").read_text())
IMPACTS = [float(impact[0]) for impact in REFERENCE["W1"]]
UNTIL = {"W1": IMPACTS[-1] + 0.1, "W3": 10.0}
WANTED = {"W1": (1e-6, 1e-9, 1e-11), "W3": (1e-3, 1e-5, 1e-7)}
WORKS = {"W1": "rolling disk, time of the 20th impact", "W3": "double pendulum, angle after 10 s"}


def package(integrator):
    """Runs of this package."""
    import dalembert

    pendulum, disk = dalembert.models.double_pendulum, dalembert.models.rolling_disk

    def solve(work, tolerance):
        arguments = {"integrator": integrator, "tol": max(tolerance, 1e-15), "until": UNTIL[work], "samples": 0}
        if work == "W3":
            return pendulum.simulate(q=[2, 2.5], qdot=[0, 0], **arguments).last["theta1"]
        return disk.simulate(state={"theta_dot": 10, "phi_dot": 0.2, "phi": math.pi / 2}, **arguments).events["t"]

    return solve


def heyoka():
    import heyoka_peer

    integrators = {}

    def solve(work, tolerance):
        if (work, tolerance) not in integrators:
            log = SimpleNamespace()
            integrators[work, tolerance] = heyoka_peer.compiled(work, tolerance, log), log
        integrator, log = integrators[work, tolerance]
        heyoka_peer.run(integrator, log, problems.start(work), UNTIL[work])
        return integrator.state[0] if work == "W3" else log.times

    return solve


def scipy():
    """Functions compiled by numba."""
    import scipy_peer

    def solve(work, tolerance):
        state, times, _, _ = scipy_peer.run(work, UNTIL[work], tolerance)
        return state[0] if work == "W3" else times

    return solve


def runs_of(module):
    """Peers with a function `runs`."""
    def made():
        runs = __import__(module).runs
        known = {}

        def solve(work, tolerance):
            run = known[work] if work in known else known.setdefault(work, runs(work))
            state, times = run(UNTIL[work], tolerance)
            return state[0] if work == "W3" else times

        return solve

    return made


PEERS = {
    "dalembert, taylor": lambda: package("taylor"), "dalembert, dop853": lambda: package("dop853"), "heyoka.py": heyoka,
    "diffrax": runs_of("diffrax_peer"), "SciPy DOP853, numba": scipy, "PyDy, LSODA": runs_of("pydy_peer"),
}
#: PyDy has no events.
WITHOUT_EVENTS = {"PyDy, LSODA"}


def present():
    found = {}
    for name, make in PEERS.items():
        try:
            found[name] = make()
            if name not in WITHOUT_EVENTS:
                found[name]("W1", 1e-6)
            found[name]("W3", 1e-6)
        except ImportError as error:
            print(f"{name} is left out: {error}", file=sys.stderr)
            found.pop(name, None)
    return found


def error(work, found):
    if work == "W3":
        return abs(found - float(REFERENCE[work]["10"][0]))
    return abs(found[-1] - IMPACTS[-1]) if len(found) == len(IMPACTS) else math.inf


def at(wanted, cases):
    """The shortest time among the tolerances that reach the wanted error."""
    return min((seconds for seconds, found in cases if found <= wanted), default=math.nan)


def main(rounds):
    peers = present()
    print(f"| ms, for the error | {' | '.join(peers)} |\n|{'---|' * (len(peers) + 1)}")
    for work in UNTIL:
        named = {name: solve for name, solve in peers.items() if not (work == "W1" and name in WITHOUT_EVENTS)}
        cases = {(name, tolerance): [math.inf, math.inf] for tolerance in problems.TOLERANCES for name in named}
        for _ in range(rounds + 1):
            for (name, tolerance), case in cases.items():
                begun = time.perf_counter()
                found = named[name](work, tolerance)
                case[0] = min(case[0], time.perf_counter() - begun)
                case[1] = error(work, found)
        for wanted in WANTED[work]:
            times = [1e3 * at(wanted, [tuple(case) for (peer, _), case in cases.items() if peer == name]) for name in peers]
            print(f"| {WORKS[work]}, {wanted:.0e} | {' | '.join('-' if math.isnan(it) else f'{it:.3g}' for it in times)} |")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 5)
