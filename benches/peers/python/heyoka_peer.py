"""heyoka: adaptive Taylor series compiled by LLVM, events as roots of the step's polynomial.

python heyoka_peer.py WORK REPETITIONS prints one line of JSON for each tolerance. `time` is the whole run;
`time_without_callback` leaves out the impact map, which is a callback in Python.
"""

import json
import sys
import time
from types import SimpleNamespace

import heyoka as hy
import numpy as np
import problems
from problems import A, B, I, M, R

MANY_IMPACTS = 3000
clock = time.perf_counter


def disk(is_reduced):
    x, y, th, ph, vx, vy, w, o = hy.make_vars("x", "y", "th", "ph", "vx", "vy", "w", "O")
    c, s = hy.cos(ph), hy.sin(ph)
    edges = [1 - (x + reach * c) ** 2 / A**2 - (y + reach * s) ** 2 / B**2 for reach in (R, -R)]
    if is_reduced:
        return [(x, R * w * c), (y, R * w * s), (th, w), (ph, o), (w, 0 * w), (o, 0 * o)], edges
    light, k = 1 / M, R * R / I
    g11, g12, g22 = light + k * c * c, k * s * c, light + k * s * s
    gamma1, gamma2 = R * s * o * w, -R * c * o * w
    det = g11 * g22 - g12 * g12
    l1, l2 = -(g22 * gamma1 - g12 * gamma2) / det, -(g11 * gamma2 - g12 * gamma1) / det
    rates = [vx, vy, w, o, l1 * light, l2 * light, -(R / I) * (c * l1 + s * l2), 0 * o]
    return list(zip((x, y, th, ph, vx, vy, w, o), rates)), edges


def sleigh():
    x, y, th, vx, vy, o = hy.make_vars("x", "y", "th", "vx", "vy", "O")
    a = 0.3
    s, c = hy.sin(th), hy.cos(th)
    f1, f2 = a * c * o * o, a * s * o * o
    turn = a * (s * f1 - c * f2)
    b1, b2 = f1 + a * s * turn, f2 - a * c * turn
    wt = -a * (s * s + c * c)
    w1, w2 = -s + a * s * wt, c - a * c * wt
    multiplier = -((-c * o * vx - s * o * vy) - s * b1 + c * b2) / (-s * w1 + c * w2)
    rates = [vx, vy, o, b1 + w1 * multiplier, b2 + w2 * multiplier, turn + wt * multiplier]
    tips = [1 - ((x + reach * c) / 3) ** 2 - ((y + reach * s) / 4) ** 2 for reach in (0.5, -0.5)]
    return list(zip((x, y, th, vx, vy, o), rates)), tips


def pendulum():
    t1, t2, w1, w2 = hy.make_vars("t1", "t2", "w1", "w2")
    g = 9.81
    c, s = hy.cos(t1 - t2), hy.sin(t1 - t2)
    r1 = -s * w2 * w2 - 2 * g * hy.sin(t1)
    r2 = s * w1 * w1 - g * hy.sin(t2)
    det = 2 - c * c
    return [(t1, w1), (t2, w2), (w1, (r1 - c * r2) / det), (w2, (2 * r2 - c * r1) / det)], []


def ball():
    x, v = hy.make_vars("x", "v")
    return [(x, v), (v, -9.81 + 0 * x)], [x]


def system(work):
    if work in ("W1", "W1r", "W5", "W5r"):
        return disk(work.endswith("r"))
    if work == "W2":
        return sleigh()[0], []
    return {"W2b": sleigh, "W3": pendulum, "W4": ball}[work]()


def compiled(work, tolerance, log):
    """The integrator. Its events apply the impact map and record the impacts in the log."""

    def on_impact(surface):
        def callback(integrator, _direction):
            begin = clock()
            y = integrator.state
            problems.impact(work, y, surface)
            log.times.append(integrator.time)
            log.states.append(y.copy())
            log.callback += clock() - begin
            return work != "W4" or (abs(y[1]) >= 1e-12 and len(log.times) < MANY_IMPACTS)

        return callback

    rates, gaps = system(work)
    events = [
        hy.t_event(gap, callback=on_impact(k), direction=hy.event_direction.negative) for k, gap in enumerate(gaps)
    ]
    return hy.taylor_adaptive(rates, problems.start(work), tol=tolerance, t_events=events)


def run(integrator, log, start, until):
    """Runs from the start, and returns the seconds that the run takes."""
    log.times, log.states, log.callback = [], [], 0.0
    integrator.time = 0.0
    integrator.state[:] = start
    if integrator.with_events:
        integrator.reset_cooldowns()
    begin = clock()
    log.steps = integrator.propagate_until(until)[3]
    return clock() - begin


def measure(work, repetitions):
    start, until = problems.start(work), problems.UNTIL[work]
    if work in ("W1", "W1r", "W2b"):
        problems.impact(work, problems.start(work), 0)  # compiles it
    for tolerance in problems.TOLERANCES:
        log = SimpleNamespace()
        begin = clock()
        integrator = compiled(work, tolerance, log)
        line = {"peer": "heyoka", "work": work, "tol": tolerance, "T": until, "compile": clock() - begin}
        run(integrator, log, start, until)
        times = []
        for _ in range(repetitions):
            seconds = run(integrator, log, start, until)
            times.append((seconds, seconds - log.callback))
        line["time"], line["time_without_callback"] = np.min(times, axis=0)
        line |= {"acc": log.steps, "order": integrator.order, "nev": len(log.times), "tev": log.times}
        line["dE"], line["y"] = problems.energy_error(work, integrator.state), list(integrator.state)
        line["yev"] = [list(log.states[k]) for k in problems.SHOWN_IMPACTS if k < len(log.states)]
        line["probe"] = []
        for probe in problems.PROBES.get(work, ()):
            run(integrator, log, start, probe)
            line["probe"].append(list(integrator.state))
        print(json.dumps(line), flush=True)


def lanes(work, tolerance, width, log):
    """The integrator of the ensemble for `width` trajectories at a time, and their starts."""
    is_reduced = work == "W5r"
    start = problems.start("W1r" if is_reduced else "W1")
    lane = start.copy()

    def on_impact(surface):
        def callback(integrator, _direction, index):
            begin = clock()
            lane[:] = integrator.state[:, index]
            problems.disk_impact(lane, surface, is_reduced)
            integrator.state[:, index] = lane
            log.callback += clock() - begin
            log.impacts += 1
            return True

        return callback

    rates, gaps = system(work)
    events = [
        hy.t_event_batch(gap, callback=on_impact(k), direction=hy.event_direction.negative)
        for k, gap in enumerate(gaps)
    ]
    starts = np.tile(start[:, None], (1, width))
    return hy.taylor_adaptive_batch(rates, starts, tol=tolerance, t_events=events), starts


def run_part(integrator, starts, rates, is_reduced):
    """Runs trajectories with these rates of rolling for 10 seconds, and returns their final x."""
    width, ends = starts.shape[1], np.empty_like(rates)
    for k in range(0, len(rates), width):
        some = rates[k : k + width]
        integrator.set_time(0.0)
        integrator.state[:] = starts
        integrator.state[4 if is_reduced else 6] = some
        if not is_reduced:
            integrator.state[4:6] = starts[4:6] / 10 * some
        integrator.reset_cooldowns()
        integrator.propagate_until(10.0)
        ends[k : k + width] = integrator.state[0]
    return ends


def run_ensemble(integrator, starts, is_reduced, log):
    """Seconds of every part, with and without callbacks, and the final x of all trajectories."""
    times, ends, log.impacts = [], [], 0
    for rates in problems.rolling_rates().reshape(-1, problems.PART):
        log.callback, begin = 0.0, clock()
        ends.append(run_part(integrator, starts, rates, is_reduced))
        seconds = clock() - begin
        times.append((seconds, seconds - log.callback))
    return times, np.concatenate(ends)


def measure_ensemble(work, repetitions):
    is_reduced = work == "W5r"
    problems.disk_impact(problems.start("W1r" if is_reduced else "W1"), 0, is_reduced)
    for width in sorted({4, hy.recommended_simd_size()}):
        for tolerance in problems.ENSEMBLE_TOLERANCES:
            log = SimpleNamespace()
            integrator, starts = lanes(work, tolerance, width, log)
            runs = [run_ensemble(integrator, starts, is_reduced, log) for _ in range(repetitions)]
            line = {"peer": f"heyoka-batch{width}", "work": work, "tol": tolerance, "n": problems.TRAJECTORIES}
            line["time"], line["time_without_callback"] = np.min([times for times, _ in runs], axis=0).sum(axis=0)
            ends = runs[-1][1]
            line |= {"nev": log.impacts, "sumx": ends.sum(), "samples": problems.samples(ends)}
            print(json.dumps(line), flush=True)


if __name__ == "__main__":
    hy.set_nthreads(1)
    work, repetitions = sys.argv[1], int(sys.argv[2])
    (measure_ensemble if work.startswith("W5") else measure)(work, repetitions)
