"""Ratios of our times to those of other programs at equal measured error, and the limits for these ratios."""

import itertools
import math
from dataclasses import dataclass

import accuracy

OURS = ("dalembert-taylor", "dalembert-abreast", "dalembert-dop853")


@dataclass
class Limit:
    """Limit for the ratio of our time for `work` to the time of the other peers for `other`, at errors of 10**decade."""

    work: str
    other: str
    decades: range
    most: float
    only: str = ""  # beginning of the names of the peers that are compared; all others if empty


LIMITS = (
    Limit("W1", "W1", range(-6, -12, -1), 0.40),
    Limit("W1", "W1r", range(-6, -12, -1), 0.55),
    Limit("W1", "W1", range(-3, -7, -1), 0.5, "hand-dop853"),
    Limit("W2", "W2", range(-3, -12, -1), 0.5),
    Limit("W2b", "W2b", range(-3, -11, -1), 0.5),
    Limit("W3", "W3", range(-1, -7, -1), 0.8),
    Limit("W5", "W5", range(-5, -13, -1), 0.45, "heyoka-batch"),
)
BOUNCE_LIMIT = 1.0
CHAIN_LIMIT, CHAIN_SIZE, CHAIN_PEER = 1.2, 32, "hand-tensions"
ACCUMULATION_ERROR = 1e-9


def front(points):
    """The Pareto front of errors and costs, the largest error first."""
    kept = []
    for size, cost in sorted(points, key=lambda point: (point[0], point[1])):
        if not kept or cost < kept[-1][1]:
            kept.append((max(size, 1e-17), cost))
    return kept[::-1]


def cost_at(points, size):
    """The cost of an error, interpolated between two tolerances by a power law; None if the error is not reached."""
    kept = front(points)
    if not kept or kept[-1][0] > size:
        return None
    if kept[0][0] <= size:
        return kept[0][1]
    for (loose, cheap), (tight, dear) in itertools.pairwise(kept):
        if tight <= size <= loose:
            part = math.log(loose / size) / math.log(loose / tight)
            return cheap * (dear / cheap) ** part
    return None


def fastest(found, size, names):
    """Cost and name of the cheapest peer that reaches an error; both are None if no peer reaches it."""
    costs = [(cost_at(found[name], size), name) for name in names if name in found]
    costs = [pair for pair in costs if pair[0] is not None]
    return min(costs, default=(None, None))


def rows(results, limit):
    """A row for each decade: its exponent, our cost and peer, cost and name of the fastest other, and the ratio."""
    ours, others = accuracy.points(results, limit.work), accuracy.points(results, limit.other)
    names = [name for name in others if name not in OURS and name.startswith(limit.only)]
    for decade in limit.decades:
        size = 10.0**decade
        our_cost, our_name = fastest(ours, size, OURS)
        cost, name = fastest(others, size, names)
        ratio = our_cost / cost if our_cost and cost else None
        yield decade, our_cost, our_name, cost, name, ratio


def number(value, digits=3):
    return "-" if value is None else f"{value:.{digits}g}"


def verdict(ratio, most):
    if ratio is None:
        return "-"
    return "ok" if ratio <= most else f"missed by {(ratio / most - 1) * 100:.0f} %"


def print_limit(results, limit):
    against = limit.only or "the fastest of all"
    print(f"\n{limit.work} against {against} on {limit.other}: at most {limit.most}")
    print(f"{'error':>6} {'ours':>8} {'by':>8}  {'other':>8}  {'by':<26} {'ratio':>6}")
    for decade, our_cost, our_name, cost, name, ratio in rows(results, limit):
        if our_cost is None and cost is None:
            continue
        way = (our_name or "-").removeprefix("dalembert-")
        cells = f"{number(our_cost):>8} {way:>8}  {number(cost):>8}  {name or '-':<26} {number(ratio, 2):>6}"
        print(f"  1e{decade:<3} {cells}  {verdict(ratio, limit.most)}")


def print_bounces(results):
    """Prints W4: nanoseconds for a bounce, and the results."""
    lines = [line for line in results if line["work"] == "W4"]
    _, accumulation = accuracy.bounces()
    print(
        f"\nW4, the ball that comes to rest at {accumulation:.6f}: at most {BOUNCE_LIMIT} of hand-dop853 for a bounce"
    )
    print(f"{'peer':<18} {'tol':>6} {'ns/bounce':>9} {'bounces':>8} {'right':>6}  end")
    for line in sorted(lines, key=lambda line: (line["peer"], -line["tol"])):
        seconds = line.get("time_without_callback", line["time"])
        each = accuracy.cost(line, seconds) * 1e3
        right = accuracy.right_bounces(line)
        print(
            f"{line['peer']:<18} {line['tol']:>6.0e} {each:>9.0f} {line['nev']:>8} {right:>6}  {ending(line, accumulation)}"
        )
    for tolerance in sorted({line["tol"] for line in lines}, reverse=True):
        by_peer = {line["peer"]: accuracy.cost(line, line["time"]) for line in lines if line["tol"] == tolerance}
        ours = [by_peer[name] for name in OURS if name in by_peer]
        if ours and "hand-dop853" in by_peer:
            ratio = min(ours) / by_peer["hand-dop853"]
            print(f"  {tolerance:.0e}: ratio {ratio:.2f}  {verdict(ratio, BOUNCE_LIMIT)}")


def ending(line, accumulation):
    if "outcome" in line:
        if line["outcome"] != "zeno":
            return line["outcome"]
        late = abs(line["accumulation"] - accumulation)
        return f"comes to rest, off by {late:.0e}" + ("" if late <= ACCUMULATION_ERROR else ", WRONG")
    height = line["y"][0]
    return "through the floor, no error" if height < -1e-6 else "stopped by the rule for its speed"


def print_chain(results):
    """Prints W3b: nanoseconds for a right-hand side."""
    table = {}
    for line in results:
        if line["work"] == "W3b":
            table.setdefault(line["peer"], {})[line["n"]] = line["ns"]
    sizes = sorted({n for row in table.values() for n in row})
    print(f"\nW3b, ns of the right-hand side of the chain: at most {CHAIN_LIMIT} of {CHAIN_PEER} for N = {CHAIN_SIZE}")
    print(f"{'peer':<18}" + "".join(f"{f'N = {n}':>10}" for n in sizes))
    for peer, row in table.items():
        print(f"{peer:<18}" + "".join(f"{number(row.get(n)):>10}" for n in sizes))
    ours = [row.get(CHAIN_SIZE) for peer, row in table.items() if peer.startswith("dalembert")]
    ours = [value for value in ours if value]
    other = table.get(CHAIN_PEER, {}).get(CHAIN_SIZE)
    if ours and other:
        print(f"  ratio {min(ours) / other:.2f}  {verdict(min(ours) / other, CHAIN_LIMIT)}")


def print_wrong(results):
    """Prints wrong right-hand sides, wrong numbers of impacts, and wrong outcomes of our runs."""
    for line in results:
        case = f"{line['peer']} {line['work']} {line.get('tol', line.get('n'))}"
        if "relerr" in line and not line["relerr"] < 1e-11:
            print(f"wrong: {case}, off by {line['relerr']:.0e}")
        if line["work"] in ("W5", "W5r") and line["nev"] != 7 * line["n"]:
            print(f"wrong: {case}, {line['nev']} impacts for {7 * line['n']}")
        if line["peer"] in OURS and line.get("outcome") not in (None, "done", "zeno"):
            print(f"wrong: {case} ends as {line['outcome']}")


def print_all(results):
    measured = {line["work"] for line in results}
    print("Microseconds for a simulated second (W5: for a trajectory) at equal measured error")
    for limit in LIMITS:
        if {limit.work, limit.other} <= measured:
            print_limit(results, limit)
    if "W4" in measured:
        print_bounces(results)
    if "W3b" in measured:
        print_chain(results)
    print()
    print_wrong(results)
