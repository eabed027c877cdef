"""Errors of what was computed, against solutions with 34 digits; and the times that go with them."""

import json
from pathlib import Path

REFERENCE = json.loads((Path(__file__).resolve().parent / "reference.json").read_text())
IMPACT = 20
BOUNCES, GRAVITY, RESTITUTION = 1000, 9.81, 0.9
# Bounces of the ball that are right, and no later one: to this many seconds.
RIGHT = 1e-9


def bounces():
    """Times of the bounces of the ball, and where they accumulate."""
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
    """The error by which a work is compared; None where there is no result or none is needed."""
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
    """How many of the first bounces of the ball are at the right time."""
    times, _ = bounces()
    count = 0
    for actual, expected in zip(line["tev"], times):
        if actual is None or abs(actual - expected) > RIGHT:
            break
        count += 1
    return count


def cost(line, seconds):
    """Seconds as what is compared: microseconds for a simulated second, a trajectory or a bounce."""
    if line["work"] in ("W5", "W5r"):
        return seconds * 1e6 / line["n"]
    if line["work"] == "W4":
        return seconds * 1e6 / max(1, line["nev"])
    return seconds * 1e6 / line["T"]


def points(results, work):
    """For each peer the pairs of error and cost; heyoka also without what its callbacks in Python cost."""
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
