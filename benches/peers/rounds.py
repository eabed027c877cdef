"""Runs the peers in turn and collects what they print."""

import json
import os
import re
import statistics
import subprocess
from pathlib import Path

from environment import HERE, say

WORKS = ("W1", "W1r", "W2", "W2b", "W3", "W3b", "W4", "W5", "W5r")
TIME_LIMIT = 600

# Repetitions inside a process: short workloads are repeated so often that some repetition is undisturbed.
REPETITIONS = {"W1": 30, "W1r": 30, "W2": 50, "W2b": 30, "W3": 10, "W3b": 7, "W4": 50, "W5": 5, "W5r": 5}


class Peer:
    """A program, the workloads it knows, and its slowness: it makes fewer repetitions, and takes part in fewer rounds."""

    def __init__(self, name, works, command, slowness=1):
        self.name, self.works, self.command, self.slowness = name, works, command, slowness

    def repetitions(self, work):
        return max(1, REPETITIONS[work] // self.slowness)

    def takes_part(self, work, number):
        return work in self.works and number * self.slowness < 30


def peers(environment):
    """The peers that can run here."""
    python = HERE / "python"
    every = [work for work in WORKS if work != "W3b"]
    found = [
        Peer("ours", ("W1", "W2", "W2b", "W3", "W3b", "W4", "W5"), ours(environment)),
        Peer("dop853", every, lambda work, count: [environment.dop853, work, count]),
        Peer("heyoka", every, lambda work, count: [environment.python, python / "heyoka_peer.py", work, count]),
        Peer("chain", ("W3b",), chain(environment, python)),
        Peer("scipy", ("W1", "W2", "W2b", "W3", "W4"), scipy(environment, python), slowness=30),
    ]
    if environment.sundials:
        for kind, slowness in (("adams", 10), ("erk", 20)):
            works = ("W1", "W1r", "W2", "W2b", "W3", "W4") + (("W5",) if kind == "adams" else ())
            found.append(Peer(kind, works, sundials(environment, kind), slowness))
    return found


def ours(environment):
    return lambda work, count: [environment.ours, work, "--repetitions", count]


def scipy(environment, python):
    return lambda work, count: [environment.python, python / "scipy_peer.py", work, count]


def sundials(environment, kind):
    return lambda work, count: [environment.sundials, work, count, kind]


def chain(environment, python):
    folder = environment.folder / "chain"
    return lambda work, count: [environment.python, python / "chain_peers.py", work, count, folder]


def run(environment, work, count):
    """Runs all rounds of a workload. In each round, every peer that takes part runs once."""
    measured = {}
    for number in range(count):
        for peer in peers(environment):
            if peer.takes_part(work, number):
                for line in lines(environment, peer, work):
                    key = (line["peer"], line["work"], line.get("tol", line.get("n")))
                    measured.setdefault(key, []).append(line)
    say(f"{work} is done")
    return [combined(found) for found in measured.values()]


def lines(environment, peer, work):
    """The results that one process prints; none if it takes too long."""
    command = [str(part) for part in peer.command(work, peer.repetitions(work))]
    cache = Path(environment.folder) / "heyoka"
    variables = dict(os.environ, HEYOKA_CACHE_DIR=str(cache), OMP_NUM_THREADS="1")
    try:
        result = subprocess.run(command, capture_output=True, text=True, env=variables, timeout=TIME_LIMIT)
    except subprocess.TimeoutExpired:
        say(f"{peer.name} takes more than {TIME_LIMIT} s for {work}")
        return []
    if result.returncode != 0 or result.stderr:
        say(f"{peer.name}, {work}: {result.stderr.strip()[-300:]}")
    return [json.loads(line, parse_constant=lambda _: None) for line in readable(result.stdout)]


def readable(text):
    """Lines of JSON. C prints `nan` and `inf`; both become `NaN`."""
    for line in text.splitlines():
        if line.startswith("{"):
            yield re.sub(r"(?<=[:,\[ ])-?(nan|inf)\b", "NaN", line)


def combined(found):
    """The last line of a case, with the medians of the times of all rounds."""
    line = dict(found[-1], rounds=len(found))
    for key in ("time", "time_without_callback", "ns"):
        if key in line:
            line[key] = statistics.median(other[key] for other in found)
    return line
