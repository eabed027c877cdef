"""Errors of the computed results against solutions with 34 digits, and the costs of these results."""

import json
from pathlib import Path

REFERENCE = json.loads((Path(__file__).resolve().parent / "reference.json").read_text())
IMPACT = 20
BOUNCES, GRAVITY, RESTITUTION = 1000, 9.81, 0.9
# A bounce is correct if the error of its time is at most this, in seconds.
RIGHT = 1e-9


def bounces():
    """Times of the bounces of the ball, and the time at which they accumulate."""
    first = (2 / GRAVITY) ** 0.5
    times, t, hop = [], first, 2 * first
    for _ in range(BOUNCES):
        times.append(t)
        hop *= RESTITUTION
        t += hop
    return times, first * (1 + 2 * RESTITUTION / (1 - RESTITUTION))


def largest(values, expected):
    """The largest difference; None if a value is missing."""
    if values is None or any(value is None for value in values):
        return None
    return max(abs(value - float(other)) for value, other in zip(values, expected))


def impact_error(line):
    times = line.get("tev") or []
    if len(times) < IMPACT or times[IMPACT - 1] is None:
        return None
    reference = REFERENCE["W2b" if line["work"] == "W2b" else "W1"]
    return abs(times[IMPACT - 1] - float(reference[IMPACT - 1][0]))


def error(line):
    """The error by which a workload is compared; None if there is no result, or if it is not compared by an error."""
    work = line["work"]
    if work in ("W1", "W1r", "W2b"):
        return impact_error(line)
    if work == "W2":
        return largest(line["y"], REFERENCE["W2"]["1000"])
    if work == "W3":
        return largest(line["probe"][1], REFERENCE["W3"]["10"])
    if work in ("W5", "W5r"):
        return largest(line["samples"], REFERENCE["W5"])
    return None


def right_bounces(line):
    """Number of bounces of the ball before the first one at a wrong time."""
    times, _ = bounces()
    count = 0
    for actual, expected in zip(line["tev"], times):
        if actual is None or abs(actual - expected) > RIGHT:
            break
        count += 1
    return count


def cost(line, seconds):
    """The cost that is compared: microseconds per simulated second, per trajectory (W5, W5r) or per bounce (W4)."""
    if line["work"] in ("W5", "W5r"):
        return seconds * 1e6 / line["n"]
    if line["work"] == "W4":
        return seconds * 1e6 / max(1, line["nev"])
    return seconds * 1e6 / line["T"]


def points(results, work):
    """For each peer the pairs of error and cost; for heyoka also without the time of its callbacks in Python."""
    found = {}
    for line in results:
        if line["work"] != work:
            continue
        size = error(line)
        if size is None:
            continue
        found.setdefault(line["peer"], []).append((size, cost(line, line["time"])))
        if "time_without_callback" in line:
            name = f"{line['peer']}, no callback"
            found.setdefault(name, []).append((size, cost(line, line["time_without_callback"])))
    return found
