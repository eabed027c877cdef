"""diffrax in double precision, compiled by JAX, with its location of events; restarted after every impact.

Smooth motion takes Dopri8, impacts take Tsit5, whose interpolation locates them better.
"""

import math

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
import optimistix
import problems
from problems import A, B, I, M, R

jax.config.update("jax_enable_x64", True)

MANY_IMPACTS = 3000


def disk(_t, y, _args):
    s, c = jnp.sin(y[3]), jnp.cos(y[3])
    light, k = 1 / M, R * R / I
    g11, g12, g22 = light + k * c * c, k * s * c, light + k * s * s
    gamma1, gamma2 = R * s * y[7] * y[6], -R * c * y[7] * y[6]
    det = g11 * g22 - g12 * g12
    l1, l2 = -(g22 * gamma1 - g12 * gamma2) / det, -(g11 * gamma2 - g12 * gamma1) / det
    return jnp.array([y[4], y[5], y[6], y[7], l1 * light, l2 * light, -(R / I) * (c * l1 + s * l2), 0.0])


def pendulum(_t, y, _args):
    c, s = jnp.cos(y[0] - y[1]), jnp.sin(y[0] - y[1])
    r1 = -s * y[3] ** 2 - 2 * 9.81 * jnp.sin(y[0])
    r2 = s * y[2] ** 2 - 9.81 * jnp.sin(y[1])
    det = 2 - c * c
    return jnp.array([y[2], y[3], (r1 - c * r2) / det, (2 * r2 - c * r1) / det])


def edge(reach):
    def gap(t, y, args, **_):  # diffrax gives these by place and by name
        x, z = y[0] + reach * jnp.cos(y[3]), y[1] + reach * jnp.sin(y[3])
        return 1 - (x / A) ** 2 - (z / B) ** 2

    return gap


SYSTEMS = {"W1": (disk, [edge(R), edge(-R)]), "W3": (pendulum, [])}


def stretch(work):
    """The compiled run up to the next impact or to the end: time, state, and the surfaces that were met."""
    rate, gaps = SYSTEMS[work]
    method = diffrax.Tsit5() if gaps else diffrax.Dopri8()

    @jax.jit
    def solve(begin, end, y, tolerance):
        event = diffrax.Event(gaps, optimistix.Newton(rtol=tolerance, atol=tolerance), direction=[False] * len(gaps)) if gaps else None
        solution = diffrax.diffeqsolve(
            diffrax.ODETerm(rate), method, begin, end, None, y, stepsize_controller=diffrax.PIDController(tolerance, tolerance),
            event=event, max_steps=100_000, throw=False,
        )
        met = jnp.array(solution.event_mask) if gaps else jnp.zeros(1, bool)
        return solution.ts[-1], solution.ys[-1], met

    return solve


def runs(work):
    """A function of tolerance and end: the last state and the times of the impacts."""
    solve = stretch(work)

    def run(until, tolerance):
        t, y, times = 0.0, problems.start(work), []
        while len(times) < MANY_IMPACTS:
            end, state, met = solve(t, until, y, tolerance)
            t, y, met = float(end), np.array(state), np.asarray(met)
            if not met.any() or math.isnan(t):
                break
            problems.impact(work, y, int(np.argmax(met)))
            times.append(t)
        return y, times

    return run
