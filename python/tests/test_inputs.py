"""Inputs that are functions of time and state, called at every evaluation or held for a period; feedback laws."""

import math

import numpy as np
import pytest

import dalembert
from dalembert import Model, RequestError

CART = """
Cart {
    coordinates { x; }
    parameters { m > 0 = 2; c = 1/2; }
    inputs { u; w; }
    lagrangian = m/2*dot(x)^2;
    forces { push: (u + w)*d(x); }
    impacts { stop: x <= 1 => newton(1/2); }
    outputs { power: u*dot(x); }
    initial { x = 0; dot(x) = 1; until = 6; }
}
"""

#: The same model, with expressions in place of the inputs.
WRITTEN = CART.replace("inputs { u; w; }", "").replace("(u + w)*d(x)", "(-3*x - c*dot(x) + sin(t))*d(x)").replace(
    "power: u*dot(x)", "power: (-3*x - c*dot(x))*dot(x)",
)


@pytest.fixture
def cart():
    return Model.from_text(CART)


@pytest.mark.parametrize("integrator", ["dop853", "dopri5"])
def test_functions_are_the_forces_that_they_stand_for(cart, integrator):
    spring = {"u": lambda t, q, qdot: -3 * q[0] - 0.5 * qdot[0], "w": lambda t, q, qdot: math.sin(t)}
    run = cart.simulate(inputs=spring, state={"x": -0.5, "x_dot": 2.5}, tol=1e-12, integrator=integrator)
    written = Model.from_text(WRITTEN).simulate(state={"x": -0.5, "x_dot": 2.5}, tol=1e-12, integrator=integrator)
    assert len(run.events) == len(written.events) > 0
    np.testing.assert_allclose(run.events["t"], written.events["t"], rtol=1e-9)
    np.testing.assert_allclose(run.q, written.q, rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(run["power"], written["power"], rtol=1e-7, atol=1e-7)
    # An input that is given as a number is constant, also beside one that is a function.
    mixed = cart.simulate(inputs={"u": spring["u"], "w": 0.25}, until=1)
    assert mixed.outcome.reached and mixed.last["x"] != run.last["x"]


def test_values_are_held_for_a_period(cart):
    called = []

    def push(t, q, qdot):
        called.append(t)
        return -4 * q[0]

    run = cart.simulate(inputs={"u": push}, period=0.25, until=2, state={"x": 0.1, "x_dot": 0.2}, times=[0.25 * k for k in range(9)])
    np.testing.assert_allclose(called, [0.25 * k for k in range(9)], rtol=0, atol=1e-15)
    x, v, T = 0.1, 0.2, 0.25
    for k in range(9):
        np.testing.assert_allclose([run["x"][k], run["x_dot"][k]], [x, v], rtol=1e-12)
        a = -4 * x / 2
        x, v = x + v * T + a * T**2 / 2, v + a * T


def test_an_impact_within_a_period_changes_no_input(cart):
    run = cart.simulate(inputs={"u": lambda t, q, qdot: 2.0 + t}, period=0.8, until=0.8, state={"x_dot": 1.5})
    # The acceleration is 1 before and after the impact at x = 1.
    s = -1.5 + math.sqrt(1.5**2 + 2)
    [event] = run.events
    assert event["t"] == pytest.approx(s, rel=1e-12)
    rest, back = 0.8 - s, -(1.5 + s) / 2
    assert run.last["x"] == pytest.approx(1 + back * rest + rest**2 / 2, rel=1e-12)


@pytest.mark.parametrize("period", [None, 0.1])
def test_the_run_is_made_again(cart, period):
    run = cart.simulate(inputs={"u": lambda t, q, qdot: math.cos(3 * t)}, period=period, until=3)
    np.testing.assert_array_equal(run(run.t)["x"], run["x"])
    with pytest.raises(RequestError, match="jacobian: the derivatives of inputs that are functions are not known"):
        run.jacobian(["x"])


def test_a_closed_loop_is_the_model_with_the_law_written_out(cart):
    closed = cart.with_parameters(c=0.25).with_feedback(u="-3*x - c*dot(x)", w="sin(t)")
    assert closed.inputs == () and closed.parameters == {"m": 2, "c": 0.25}
    written = Model.from_text(WRITTEN).with_parameters(c=0.25)
    start = {"state": {"x": -0.5, "x_dot": 4}, "integrator": "taylor", "tol": 1e-12}
    run, other = closed.simulate(**start), written.simulate(**start)
    assert len(run.events) > 1 and run.last == other.last
    names = ["x", "x_dot", "c"]
    np.testing.assert_array_equal(run.jacobian(names), other.jacobian(names))
    # With a law for `u` only, `w` is still an input.
    half = cart.with_feedback(u="-3*x - c*dot(x)")
    assert half.inputs == ("w",)
    mixed = half.simulate(inputs={"w": lambda t, q, qdot: math.sin(t)}, until=2, tol=1e-12)
    assert mixed.last["x"] == pytest.approx(cart.with_feedback(u="-3*x - c*dot(x)", w="sin(t)").simulate(until=2, tol=1e-12).last["x"], abs=1e-9)


def test_laws_that_are_refused(cart):
    with pytest.raises(RequestError, match="no input `v`; the inputs are `u`, `w`"):
        cart.with_feedback(v="x")
    with pytest.raises(RequestError, match="write one expression"):
        cart.with_feedback(u="1; let y = 2")
    with pytest.raises(dalembert.ModelError, match="unknown name `y`"):
        cart.with_feedback(u="-y")


def test_constrained_models_have_inputs():
    text = """
        Blade {
            coordinates { x; y; theta: angle; }
            inputs { torque; }
            lagrangian = (dot(x)^2 + dot(y)^2 + dot(theta)^2)/2;
            constraints { blade: -sin(theta)*dot(x) + cos(theta)*dot(y) = 0; }
            forces { steer: torque*d(theta); }
            initial { theta = 0; dot(x) = 1; dot(theta) = 0; until = 2; }
        }
    """
    run = Model.from_text(text).simulate(inputs={"torque": lambda t, q, qdot: math.cos(t)}, tol=1e-12)
    np.testing.assert_allclose(run["theta"], 1 - np.cos(run.t), atol=1e-10)
    np.testing.assert_allclose(np.hypot(run["x_dot"], run["y_dot"]), 1, rtol=1e-10)


def test_errors_of_inputs_are_raised(cart):
    with pytest.raises(ZeroDivisionError):
        cart.simulate(inputs={"u": lambda t, q, qdot: 1 / 0})
    with pytest.raises(ZeroDivisionError):
        cart.simulate(inputs={"u": lambda t, q, qdot: 1 / 0}, period=0.1)


@pytest.mark.parametrize(("arguments", "words"), [
    ({"inputs": {"v": abs}}, "unknown input `v`\n  accepted: u, w"),
    ({"inputs": {"u": 1}, "period": 0.1}, "period: it belongs to inputs that are functions"),
    ({"inputs": {"u": lambda t, q, qdot: 0}, "period": 0}, "period: 0 is not accepted; expected a positive number"),
    ({"inputs": {"u": lambda t, q, qdot: 0}, "integrator": "taylor"}, "integrator: inputs that are functions need dop853"),
])
def test_inputs_that_are_refused(cart, arguments, words):
    with pytest.raises(RequestError) as refused:
        cart.simulate(**arguments)
    assert words in str(refused.value)


def test_a_model_without_inputs_takes_none():
    with pytest.raises(RequestError, match="unknown input `u`; there are none"):
        dalembert.models.bouncing_ball.simulate(inputs={"u": abs})
