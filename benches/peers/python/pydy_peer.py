"""PyDy: the double pendulum by Kane's method of SymPy, its right-hand side in C through Cython, integrated by LSODA of SciPy."""

import numpy as np
import problems
from pydy.system import System
from sympy import symbols
from sympy.physics import mechanics


def kane():
    """Equations of two unit masses on unit rods, with absolute angles."""
    angles, rates, g = mechanics.dynamicsymbols("q1:3"), mechanics.dynamicsymbols("u1:3"), symbols("g")
    space, origin = mechanics.ReferenceFrame("N"), mechanics.Point("O")
    origin.set_vel(space, 0)
    point, particles, loads = origin, [], []
    for angle, rate in zip(angles, rates):
        rod = space.orientnew("R", "Axis", (angle, space.z))
        rod.set_ang_vel(space, rate * space.z)
        end = point.locatenew("P", -rod.y)
        end.v2pt_theory(point, space, rod)
        particles.append(mechanics.Particle("mass", end, 1))
        loads.append((end, -g * space.y))
        point = end
    slopes = [rate - angle.diff() for angle, rate in zip(angles, rates)]
    method = mechanics.KanesMethod(space, q_ind=angles, u_ind=rates, kd_eqs=slopes)
    method.kanes_equations(particles, loads)
    return method, [*angles, *rates], g


def runs(work):
    """A function of tolerance and end: the last state, and no impacts."""
    if work != "W3":
        raise ValueError(f"{work}: PyDy has no events")
    method, state, g = kane()
    system = System(method, constants={g: 9.81}, initial_conditions=dict(zip(state, problems.start(work))))
    system.generate_ode_function(generator="cython")

    def run(until, tolerance):
        system.times = np.array([0.0, until])
        return system.integrate(rtol=tolerance, atol=tolerance, mxstep=1_000_000)[-1], []

    return run
