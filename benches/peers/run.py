#!/usr/bin/env python3
"""Runs dalembert beside other programs and prints ratios of times at equal measured error."""

import argparse
import json
import sys
from pathlib import Path

import comparison
import rounds
from environment import Environment

EXAMPLES = """examples:
  python run.py build/                        everything, five rounds, about twenty minutes
  python run.py build/ --only W1,W1r          some workloads
  python run.py build/ --rounds 9 --out results.json
  python run.py --from results.json           prints kept results again
"""


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, epilog=EXAMPLES, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", nargs="?", type=Path, help="where peers are installed, built and kept")
    parser.add_argument("--only", metavar="WORKS", help=f"workloads, separated by commas: {', '.join(rounds.WORKS)}")
    parser.add_argument("--rounds", type=int, default=5, help="repetitions of every workload by every program; medians are compared")
    parser.add_argument("--out", type=Path, help="where results are written; results.json in the folder unless given")
    parser.add_argument("--from", dest="kept", type=Path, metavar="RESULTS", help="reads results, runs nothing")
    chosen = parser.parse_args()
    if not chosen.folder and not chosen.kept:
        parser.error("name a folder to build in, or results with --from")
    works = chosen.only.split(",") if chosen.only else list(rounds.WORKS)
    for work in works:
        if work not in rounds.WORKS:
            parser.error(f"--only: `{work}` is none of {', '.join(rounds.WORKS)}")
    return chosen, works


def measure(chosen, works):
    """Runs the workloads in order. After each, writes its results to a file, which keeps results of other workloads."""
    environment = Environment(chosen.folder)
    environment.prepare()
    out = chosen.out or environment.folder / "results.json"
    lines = json.loads(out.read_text())["lines"] if out.exists() else []
    for work in works:
        lines = [line for line in lines if line["work"] != work] + rounds.run(environment, work, chosen.rounds)
        out.write_text(json.dumps({"versions": environment.describe(), "lines": lines}, indent=1))
    print(f"results: {out}", file=sys.stderr)
    return lines


def main():
    chosen, works = arguments()
    lines = json.loads(chosen.kept.read_text())["lines"] if chosen.kept else measure(chosen, works)
    comparison.print_all([line for line in lines if line["work"] in works])


if __name__ == "__main__":
    main()
