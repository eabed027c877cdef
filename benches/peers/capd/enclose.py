"""Compares certified motion with CAPD: widths of the enclosure at the end, and processor time of whole processes.

    python enclose.py --dalembert ../../../target/release/dalembert --capd FOLDER

FOLDER holds CAPD's sources, configured with cmake and built in its subfolder `build`.
"""

import argparse
import itertools
import json
import math
import pathlib
import resource
import statistics
import subprocess
import tempfile

HERE = pathlib.Path(__file__).parent
#: Model, half width of every component of the start, final time.
CASES = [
    ("rossler", 0.0, 20),
    ("rossler", 0.0, 100),
    ("rossler", 1e-10, 100),
    ("lorenz", 0.0, 10),
    ("lorenz", 0.0, 20),
    ("lorenz", 1e-10, 10),
    ("double_pendulum", 0.0, 5),
    ("double_pendulum", 0.0, 10),
    ("double_pendulum", 1e-10, 5),
]
STARTS = {
    "rossler": {"x": 0.0, "y": -8.3809417428298, "z": 0.029590060630665},
    "lorenz": {"x": 1.0, "y": 1.0, "z": 1.0},
    "double_pendulum": {"a": 1.0, "b": 2.0, "a_dot": 0.0, "b_dot": 0.0},
}
ORDERS = (12, 16, 20, 25, 30)
TOLERANCES = (1e-8, 1e-10, 1e-12, 1e-14, 1e-16)
ROUNDS = 5


def timed(command):
    """Output of a command and its processor time in user mode. The output is `None` if the command fails."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    taken = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    return (done.stdout, taken) if done.returncode == 0 else (None, taken)


def of_dalembert(program, name, half_width, until):
    """Ranges of the coordinates at the end, `None` if the enclosure is lost before, and processor time."""
    command = [program, "simulate", f"{HERE / 'enclose.dal'}:{name}", "--certify", "--until", str(until), "--json", "-"]
    if half_width:
        for component, value in STARTS[name].items():
            command += ["--certify-within", f"{component}={value - half_width!r}..{value + half_width!r}"]
    output, taken = timed(command)
    return json.loads(output)["outcome"]["q"] if output else None, taken


def of_capd(program, name, half_width, until, order, tolerance):
    """The same by CAPD. Its state of the double pendulum consists of angles and momenta; only the angles are returned."""
    output, taken = timed([program, name, repr(half_width), str(until), str(order), repr(tolerance)])
    coordinates = sum(not component.endswith("_dot") for component in STARTS[name])
    return json.loads(output)["end"][:coordinates] if output else None, taken


def width(ranges):
    return max(high - low for low, high in ranges) if ranges else math.inf


def compared(dalembert, capd, case):
    """A row of the table: this project, and CAPD with the order and tolerance that give its narrowest enclosure."""
    settings = list(itertools.product(ORDERS, TOLERANCES))
    found = {setting: width(of_capd(capd, *case, *setting)[0]) for setting in settings}
    narrowest = min(found, key=found.get)
    ranges, _ = of_dalembert(dalembert, *case)
    other, _ = of_capd(capd, *case, *narrowest)
    for ours, theirs in zip(ranges or [], other or []):
        assert ours[0] <= theirs[1] and theirs[0] <= ours[1], f"{case}: {ours} and {theirs} have no value in common"
    times = [[], []]
    for _ in range(ROUNDS):
        times[0].append(of_dalembert(dalembert, *case)[1])
        times[1].append(of_capd(capd, *case, *narrowest)[1])
    seconds = [statistics.median(of_one) for of_one in times]
    order, tolerance = narrowest
    return (
        f"| {case[0]} | {case[1]:g} | {case[2]} | {width(ranges):.1e} | {width(other):.1e} "
        f"| {seconds[0]:.3f} | {seconds[1]:.3f} | {order}, {tolerance:g} |"
    )


def build(folder):
    """Compiles `enclose.cpp` with the flags of CAPD's library on x86-64 with `CAPD_INTERVAL_TYPE=FILIB`, its default."""
    program = pathlib.Path(tempfile.mkdtemp()) / "enclose"
    flags = ["-O3", "-DNDEBUG", "-frounding-math", "-std=gnu++17", "-D__USE_FILIB__", "-DFILIB_HAVE_SSE"]
    headers = [*sorted(folder.glob("*/include")), folder / "capdExt/filibsrc"]
    libraries = [folder / "build/libcapd.a", folder / "build/capdExt/filibsrc/libfilib.a"]
    include = [f"-I{path}" for path in headers]
    subprocess.run(["g++", *flags, *include, HERE / "enclose.cpp", "-o", program, *libraries], check=True)
    return str(program)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dalembert", required=True, help="the command")
    parser.add_argument("--capd", required=True, type=pathlib.Path, help="folder of CAPD's sources, built in `build`")
    given = parser.parse_args()
    capd = build(given.capd.resolve())
    print("| problem | half width of the start | until | width | width, CAPD | s | s, CAPD | CAPD's order, tolerance |")
    print("|---|---|---|---|---|---|---|---|")
    for case in CASES:
        print(compared(given.dalembert, capd, case), flush=True)


if __name__ == "__main__":
    main()
