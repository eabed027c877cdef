"""Derivatives of runs across impacts, against closed forms and differences."""

import math

import numpy as np
import pytest
from conftest import BALL

import dalembert
from dalembert import Model, RequestError
from dalembert._final import Final


def test_derivatives_across_a_bounce_are_those_of_the_closed_form():
    x0, g, e, end = 1.0, 9.81, 0.5, 0.7
    run = Model.from_text(BALL).simulate(until=end, tol=1e-13)
    # x(T) = e*g*s*(T - s) - g/2*(T - s)^2 with the time of the fall s = sqrt(2*x0/g).
    s = math.sqrt(2 * x0 / g)
    by_s = e * g * (end - 2 * s) + g * (end - s)
    ds = {"x": s / (2 * x0), "g": -s / (2 * g), "m": 0.0}
    explicit = {"x": 0.0, "g": e * s * (end - s) - (end - s) ** 2 / 2, "m": 0.0}
    names = ["x", "g", "m"]
    expected = [by_s * ds[name] + explicit[name] for name in names]
    rates = [(e * g + g) * ds["x"], (e * g + g) * ds["g"] + e * s - (end - s), 0.0]
    np.testing.assert_allclose(run.jacobian(names), [expected, rates], rtol=1e-11, atol=1e-14)


def test_derivatives_of_a_rolling_disk_are_differences():
    disk = dalembert.models.rolling_disk
    start = {"theta_dot": 12.0, "phi": 1.3, "x": 0.01}

    def end(parameters, **changes):
        run = disk.with_parameters(**parameters).simulate(until=4, state={**start, **changes}, tol=1e-14, samples=0)
        return np.array([*run.last.values()][:-1]), len(run.events)

    run = disk.simulate(until=4, state=start, tol=1e-14)
    assert len(run.events) > 0
    jacobian = run.jacobian(["x", "phi", "theta_dot", "phi_dot", "ta"])
    assert jacobian.shape == (8, 5)
    for column, (name, h) in enumerate([("x", 1e-6), ("phi", 1e-5), ("theta_dot", 1e-4), ("phi_dot", 1e-5), ("ta", 1e-6)]):
        value = {"phi_dot": 0.2, "ta": disk.ta, **start}[name]
        moved = [value + h, value - h]
        pairs = [end({name: item}) if name == "ta" else end({}, **{name: item}) for item in moved]
        assert {count for _, count in pairs} == {len(run.events)}
        difference = (pairs[0][0] - pairs[1][0]) / (2 * h)
        scale = np.abs(difference).max()
        np.testing.assert_allclose(jacobian[:, column], difference, rtol=1e-5, atol=1e-6 * scale, err_msg=name)


def test_quasi_velocities_are_the_velocities_of_their_forms():
    run = dalembert.models.rolling_disk.simulate(until=4, state={"theta_dot": 12})
    np.testing.assert_allclose(run.jacobian(["roll"]), run.jacobian(["theta_dot"]), rtol=1e-12)


@pytest.mark.parametrize(("name", "arguments", "wrt", "words"), [
    ("rolling_disk", {}, "x_dot", "`x_dot` follows from other velocities by the constraints; vary roll, turn"),
    ("rolling_disk", {"form": "global"}, "x", "need its reduced form"),
    ("bouncing_ball", {"integrator": "rk4", "step": 0.01}, "x", "dop853, dopri5 or taylor"),
    ("bouncing_ball", {}, "y", "unknown coordinate, velocity or parameter `y`"),
    ("bouncing_ball", {"law": "newton:0.5", "until": 50}, "x", "the run ends before its time"),
    ("smooth_and_rough_plane", {}, "x", "derivatives of a model with constraints need its reduced form"),
])
def test_derivatives_that_are_refused(name, arguments, wrt, words):
    run = getattr(dalembert.models, name).simulate(**arguments)
    with pytest.raises(RequestError) as refused:
        run.jacobian([wrt])
    assert words in str(refused.value)


def test_a_graze_has_no_derivative():
    run = Model.from_text("""
        Pass {
            coordinates { x; y; }
            lagrangian = dot(x)^2/2 + dot(y)^2/2;
            impacts { disk: x^2 + y^2 >= 1; }
            initial { x = -2; y = 1; dot(x) = 1; dot(y) = 0; until = 4; }
        }
    """).simulate()
    with pytest.raises(RequestError, match="graze at surface `disk`"):
        run.jacobian(["y"])


#: Modes with different numbers of coordinates, and a transition that declares the state after it.
MIXED = """
    Mixed {
        parameters { e in [0, 1] = 4/5; c = 1/3; }
        modes {
            pair {
                coordinates { x; y; }
                lagrangian = (dot(x)^2 + (2 + sin(x))*dot(y)^2)/2 - (x - y)^2/4 - y/3;
                impacts { floor: y >= -1/2 => newton(e); }
                initial { x = 0.3; y = 0.1; dot(x) = -1; dot(y) = -0.4; until = 3; }
            }
            single { coordinates { y; } lagrangian = dot(y)^2/2 - y; impacts { ground: y >= -1 => restitution(e); } }
        }
        transitions { lose: pair -> single when x + c <= 0 => reset { y = y; dot(y) = dot(y) + dot(x); }; }
    }
"""


@pytest.mark.parametrize(("text", "names", "arguments"), [
    (MIXED, ["x", "y", "x_dot", "y_dot", "e", "c"], {"until": 3}),
    (dalembert.models.text("filippov_field"), ["x", "y", "fx", "gx"], {}),
    (dalembert.models.text("tent_map"), ["y"], {}),
    (dalembert.models.text("rimless_wheel_five"), ["x", "x_dot", "alpha", "g"], {}),
    (dalembert.models.text("refracted_particle"), ["x", "y", "x_dot", "y_dot", "m1", "m2"], {}),
])
def test_derivatives_across_changes_of_mode_are_differences(text, names, arguments):
    end = Final(Model.from_text(text), names, {"tol": 1e-13, **arguments})
    model = end.model
    values = [model.initial.get(name, model.parameters.get(name, 0.0)) for name in names]
    run = end._run(tuple(values))
    modes = set(run.events["before"]["mode"]) | set(run.events["after"]["mode"])
    assert len(modes) > 1
    jacobian, lacks = end.jacobian(values), np.isnan(end.end(values))
    for place, value in enumerate(values):
        h = 1e-5 * max(0.1, abs(value))
        moved = [np.array(values), np.array(values)]
        moved[0][place] += h
        moved[1][place] -= h
        difference = (end.end(moved[0]) - end.end(moved[1])) / (2 * h)
        scale = max(1.0, np.abs(difference[~lacks]).max())
        np.testing.assert_allclose(jacobian[~lacks, place], difference[~lacks], rtol=0, atol=1e-6 * scale, err_msg=names[place])


def test_a_coordinate_that_the_first_mode_lacks_is_refused():
    run = Model.from_text(MIXED).simulate(mode="single", q=[0, 0], qdot=[0, 0], until=1)
    with pytest.raises(RequestError, match="the mode in which the run begins has no coordinate `x`"):
        run.jacobian(["x"])
    assert run.jacobian(["y"])[1, 0] != 0
