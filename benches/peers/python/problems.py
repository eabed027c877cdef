"""The workloads for peers that are called from Python: parameters, starts, impact maps, energies.

Numba compiles the impact maps of the disk and of the sleigh.
"""

import math

import numba
import numpy as np

TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14)
ENSEMBLE_TOLERANCES = (1e-3, 1e-4, 1e-6, 1e-9, 1e-12)
TRAJECTORIES = 10_000
SAMPLES = 10
# Number of trajectories that are timed together. They take so little time that other programs disturb only some repetitions.
PART = 80

M, R, I, J = 0.0025, 0.01, 1.25e-7, 6.25e-8
A, B = 0.15, 0.20
UNTIL = {"W1": 200.0, "W1r": 200.0, "W2": 1000.0, "W2b": 200.0, "W3": 100.0, "W4": 20.0}
PROBES = {"W2": (1.0, 10.0, 100.0), "W3": (1.0, 10.0, 20.0)}
SHOWN_IMPACTS = (0, 4, 9, 19)


def start(work):
    phi = math.pi / 2
    return np.array(
        {
            "W1": [0, 0, 0, phi, R * math.cos(phi) * 10, R * math.sin(phi) * 10, 10, 0.2],
            "W1r": [0, 0, 0, phi, 10, 0.2],
            "W2": [0, 0, 0, -1, 0, 0.2],
            "W2b": [0, 0, 0.3, math.cos(0.3), math.sin(0.3), 1],
            "W3": [2, 2.5, 0, 0],
            "W4": [1, 0],
        }[work],
        dtype=float,
    )


def rolling_rates():
    return 10 + 0.005 * (2 * np.arange(TRAJECTORIES) / (TRAJECTORIES - 1) - 1)


def samples(ends):
    return list(ends[:: (TRAJECTORIES - 1) // (SAMPLES - 1)][:SAMPLES])


@numba.njit
def disk_impact(y, edge, is_reduced):
    w = 4 if is_reduced else 6
    s, c = math.sin(y[3]), math.cos(y[3])
    reach = R if edge == 0 else -R
    hx, hy = -2 * (y[0] + reach * c) / A**2, -2 * (y[1] + reach * s) / B**2
    hw, ho = R * (hx * c + hy * s), reach * (-s * hx + c * hy)
    nw, no = hw / (I + M * R * R), ho / J
    k = 2 * (hw * y[w] + ho * y[w + 1]) / (hw * nw + ho * no)
    y[w] -= k * nw
    y[w + 1] -= k * no
    if not is_reduced:
        y[4] = R * c * y[6]
        y[5] = R * s * y[6]


@numba.njit
def sleigh_impact(y, tip):
    s, c = math.sin(y[2]), math.cos(y[2])
    reach = 0.5 if tip == 0 else -0.5
    hx, hy = -2 * (y[0] + reach * c) / 9, -2 * (y[1] + reach * s) / 16
    hv, ho = hx * c + hy * s, reach * (-s * hx + c * hy)
    nv, no = hv, ho / 1.09
    v, spin = c * y[3] + s * y[4], y[5]
    k = 2 * (hv * v + ho * spin) / (hv * nv + ho * no)
    v -= k * nv
    y[3], y[4], y[5] = v * c, v * s, spin - k * no


def ball_impact(y):
    y[1] = -0.9 * y[1]
    y[0] = 0.0


def impact(work, y, surface):
    if work in ("W1", "W1r"):
        disk_impact(y, surface, work == "W1r")
    elif work == "W2b":
        sleigh_impact(y, surface)
    else:
        ball_impact(y)


def energy(work, y):
    if work == "W1":
        return 0.5 * (M * (y[4] ** 2 + y[5] ** 2) + I * y[6] ** 2 + J * y[7] ** 2)
    if work == "W1r":
        return 0.5 * ((I + M * R * R) * y[4] ** 2 + J * y[5] ** 2)
    if work in ("W2", "W2b"):
        slip = -y[3] * math.sin(y[2]) + y[4] * math.cos(y[2])
        return 0.5 * (y[3] ** 2 + y[4] ** 2 + 1.09 * y[5] ** 2 + 0.6 * y[5] * slip)
    if work == "W3":
        height = 2 * math.cos(y[0]) + math.cos(y[1])
        return y[2] ** 2 + 0.5 * y[3] ** 2 + y[2] * y[3] * math.cos(y[0] - y[1]) - 9.81 * height
    return None


def energy_error(work, y):
    before = energy(work, start(work))
    return None if before is None else (energy(work, y) - before) / abs(before)
