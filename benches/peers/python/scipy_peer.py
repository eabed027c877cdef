"""SciPy: solve_ivp with DOP853, right-hand sides and events compiled by numba, restarted after every impact.

python scipy_peer.py WORK REPETITIONS prints one line of JSON for each tolerance.
"""

import json
import math
import sys
import time

import numpy as np
import problems
from numba import njit
from problems import A, B, I, M, R
from scipy.integrate import solve_ivp

MANY_IMPACTS = 3000
LEAST_TOLERANCE = 2.3e-14
SECONDS_OF_PENDULUM = 50.0


@njit
def disk(_t, y):
    s, c = math.sin(y[3]), math.cos(y[3])
    light, k = 1 / M, R * R / I
    g11, g12, g22 = light + k * c * c, k * s * c, light + k * s * s
    gamma1, gamma2 = R * s * y[7] * y[6], -R * c * y[7] * y[6]
    det = g11 * g22 - g12 * g12
    l1, l2 = -(g22 * gamma1 - g12 * gamma2) / det, -(g11 * gamma2 - g12 * gamma1) / det
    return np.array([y[4], y[5], y[6], y[7], l1 * light, l2 * light, -(R / I) * (c * l1 + s * l2), 0.0])


@njit
def sleigh(_t, y):
    a = 0.3
    s, c = math.sin(y[2]), math.cos(y[2])
    vx, vy, o = y[3], y[4], y[5]
    f1, f2 = a * c * o * o, a * s * o * o
    turn = a * (s * f1 - c * f2)
    b1, b2 = f1 + a * s * turn, f2 - a * c * turn
    w1, w2 = -s - a * s * a, c + a * c * a
    multiplier = -((-c * o * vx - s * o * vy) - s * b1 + c * b2) / (-s * w1 + c * w2)
    return np.array([vx, vy, o, b1 + w1 * multiplier, b2 + w2 * multiplier, turn - a * multiplier])


@njit
def pendulum(_t, y):
    s1, c1, s2, c2 = math.sin(y[0]), math.cos(y[0]), math.sin(y[1]), math.cos(y[1])
    c, s = c1 * c2 + s1 * s2, s1 * c2 - c1 * s2
    r1, r2 = -s * y[3] ** 2 - 2 * 9.81 * s1, s * y[2] ** 2 - 9.81 * s2
    scale = 1 / (2 - c * c)
    return np.array([y[2], y[3], (r1 - c * r2) * scale, (2 * r2 - c * r1) * scale])


@njit
def ball(_t, y):
    return np.array([y[1], -9.81])


def ellipse(angle, reach, a, b):
    """The gap of the point at the distance `reach` from (x, y), in the direction of the state's component `angle`."""

    @njit
    def gap(_t, y):
        x, z = y[0] + reach * math.cos(y[angle]), y[1] + reach * math.sin(y[angle])
        return 1 - (x / a) ** 2 - (z / b) ** 2

    return gap


@njit
def height(_t, y):
    return y[0]


SYSTEMS = {
    "W1": (disk, [ellipse(3, R, A, B), ellipse(3, -R, A, B)]),
    "W2": (sleigh, []),
    "W2b": (sleigh, [ellipse(2, 0.5, 3, 4), ellipse(2, -0.5, 3, 4)]),
    "W3": (pendulum, []),
    "W4": (ball, [height]),
}


def terminal(gap):
    def event(t, y):
        return gap(t, y)

    event.terminal, event.direction = True, -1
    return event


def run(work, until, tolerance):
    rate, gaps = SYSTEMS[work]
    events = [terminal(gap) for gap in gaps] or None
    t, y, times, states, evaluations = 0.0, problems.start(work), [], [], 0
    while t < until and len(times) < MANY_IMPACTS:
        rtol = max(tolerance, LEAST_TOLERANCE)
        solution = solve_ivp(rate, (t, until), y, method="DOP853", rtol=rtol, atol=tolerance, events=events)
        evaluations += solution.nfev
        t, y = solution.t[-1], solution.y[:, -1].copy()
        if solution.status != 1:
            break
        problems.impact(work, y, 0 if len(solution.t_events[0]) else 1)
        times.append(t)
        states.append(y.copy())
        if work == "W4" and abs(y[1]) < 1e-12:
            break
    return y, times, states, evaluations


def measure(work, repetitions):
    until = SECONDS_OF_PENDULUM if work == "W3" else problems.UNTIL[work]
    run(work, min(until, 5.0), 1e-6)  # compiles everything
    for tolerance in problems.TOLERANCES:
        seconds = []
        for _ in range(repetitions):
            begin = time.perf_counter()
            y, times, states, evaluations = run(work, until, tolerance)
            seconds.append(time.perf_counter() - begin)
        line = {"peer": "scipy-dop853", "work": work, "tol": tolerance, "T": until, "time": min(seconds)}
        line |= {"nf": evaluations, "nev": len(times), "tev": times, "y": list(y)}
        line["dE"] = problems.energy_error(work, y)
        line["yev"] = [list(states[k]) for k in problems.SHOWN_IMPACTS if k < len(states)]
        line["probe"] = [list(run(work, probe, tolerance)[0]) for probe in problems.PROBES.get(work, ())]
        print(json.dumps(line), flush=True)


if __name__ == "__main__":
    measure(sys.argv[1], int(sys.argv[2]))
