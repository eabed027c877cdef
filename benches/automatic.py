#!/usr/bin/env python3
"""How good is the integrator that `--integrator auto` chooses?

Measures `taylor` and `dop853` with `dalembert accuracy` on all shipped models, and compares their times at equal error:
the time of a case at the tolerance `tol` with the error `e` is scaled by `(e / e0)**(1 / order)`, where `e0` is the
geometric mean of the errors of both. Prints for each tolerance how much longer the chosen integrator takes than the
better one: on average over the models, at most, and for which model.

    benches/automatic.py target/release/dalembert [MODEL ..]
"""

import json
import math
import subprocess
import sys

#: Errors below this number are rounding errors.
ROUNDING = 1e-13
ORDER_OF_DOP853 = 8


def measured(program, model):
    """The document of `accuracy` for both integrators."""
    flags = ["--integrator", "taylor", "--integrator", "dop853", "--rounds", "3", "--json", "-"]
    done = subprocess.run([program, "accuracy", model, *flags], capture_output=True, text=True)
    document = json.loads(done.stdout)
    return document if document["reference"]["confirmed"] else None


def scaled(case, error):
    """The time of a case if its error were this one."""
    order = ORDER_OF_DOP853
    if case["integrator"] == "taylor":
        order = max(case["coefficients"] / max(case["accepted"], 1), 3)
    part = min(max(max(case["error"], ROUNDING) / error, 1e-3), 1e3)
    return case["microseconds_per_unit"] * part ** (1 / order)


def losses(document):
    """Pairs of tolerance and loss: the time of the chosen integrator over that of the better one."""
    chosen = {entry["tol"]: entry["integrator"] for entry in document["automatic"]}
    cases = {(case["integrator"], case["tol"]): case for case in document["cases"]}
    for tol, name in chosen.items():
        both = [cases.get((integrator, tol)) for integrator in ("taylor", "dop853")]
        if None in both or not all(case["ends_as_reference"] for case in both):
            continue
        errors = [max(case["error"], ROUNDING) for case in both]
        times = {case["integrator"]: scaled(case, math.sqrt(errors[0] * errors[1])) for case in both}
        yield tol, times[name] / min(times.values())


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    program, models = sys.argv[1], sys.argv[2:]
    if not models:
        listed = subprocess.run([program, "list", "--format", "json"], capture_output=True, text=True, check=True)
        models = [model["name"] for model in json.loads(listed.stdout)]
    found = {}
    for model in models:
        print(model, file=sys.stderr)
        document = measured(program, model)
        if document is None:
            print(f"{model}: the reference is not confirmed", file=sys.stderr)
            continue
        for tol, loss in losses(document):
            found.setdefault(tol, []).append((loss, model))
    print(f"{'tol':>7} {'models':>7} {'mean':>6} {'above 1.2':>10} {'worst':>6}")
    for tol, entries in sorted(found.items(), reverse=True):
        mean = sum(loss for loss, _ in entries) / len(entries)
        worst, model = max(entries)
        above = sum(loss > 1.2 for loss, _ in entries)
        print(f"{tol:7.0e} {len(entries):7} {mean:6.2f} {above:10} {worst:6.2f}  {model}")


if __name__ == "__main__":
    main()
