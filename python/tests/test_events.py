"""Events and callbacks of the user, and states on both sides of impacts."""

import math

import numpy as np
import pytest
from conftest import BALL

import dalembert
from dalembert import Event, Model, RequestError

#: A free particle. Its declared motion is x = t, y = 0.
FREE = """
Free {
    coordinates { x; y; }
    parameters { a = 1/2; }
    lagrangian = dot(x)^2/2 + dot(y)^2/2;
    initial { x = 0; y = 0; dot(x) = 1; dot(y) = 0; until = 10; }
}
"""


@pytest.fixture
def free():
    return Model.from_text(FREE)


def test_an_expression_is_found_where_it_changes_its_sign(free):
    run = free.simulate(events=["sin(x)", ("cos(x)", 1), Event("t - a", name="half")])
    sines = run.crossings[run.crossings["event"] == "sin(x)"]
    np.testing.assert_allclose(sines["t"], math.pi * np.arange(1, 4), rtol=1e-14)
    np.testing.assert_array_equal(sines["rising"], [False, True, False])
    np.testing.assert_allclose(sines["at"]["x"], sines["t"], rtol=1e-14)
    cosines = run.crossings[run.crossings["event"] == "cos(x)"]
    np.testing.assert_allclose(cosines["t"], [1.5 * math.pi], rtol=1e-14)
    assert run.crossings["t"][0] == pytest.approx(0.5, rel=1e-15)
    assert np.all(np.diff(run.crossings["t"]) > 0)


@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-5])
def test_two_changes_of_sign_close_to_each_other_are_both_found(free, gap):
    # The whole run is a few steps: both lie in one of them.
    run = free.simulate(events=[f"(x - 3)^2 - {gap**2!r}"])
    np.testing.assert_allclose(run.crossings["t"], [3 - gap, 3 + gap], rtol=0, atol=1e-9)
    np.testing.assert_array_equal(run.crossings["rising"], [False, True])


def test_touching_and_beginning_at_zero_are_no_changes_of_sign(free):
    assert len(free.simulate(events=["(x - 3)^2", "x", "0*x"]).crossings) == 0


def test_nothing_is_doubled_at_the_ends_of_steps(free):
    # Steps end at 0.01*k, where the sine has its zeros.
    run = free.simulate(integrator="rk4", step=0.01, events=["sin(100*pi*x)"])
    np.testing.assert_allclose(run.crossings["t"], 0.01 * np.arange(1, len(run.crossings) + 1), rtol=1e-11)
    assert len(run.crossings) in (999, 1000)


def test_a_function_of_python_is_the_same_as_its_expression():
    disk = dalembert.models.rolling_disk
    radius = lambda t, q, qdot: q[0] ** 2 + q[1] ** 2 - 0.01 + 0 * qdot[0] * t  # noqa: E731
    run = disk.simulate(until=20, state={"theta_dot": 12}, events=["x^2 + y^2 - 0.01", radius])
    by_expression, by_function = (run.crossings[run.crossings["event"] == name] for name in ["x^2 + y^2 - 0.01", "<lambda>"])
    assert len(by_expression) > 5
    np.testing.assert_allclose(by_expression["t"], by_function["t"], rtol=1e-12)
    # The motion is that without events.
    plain = disk.simulate(until=20, state={"theta_dot": 12})
    np.testing.assert_array_equal(run.q, plain.q)
    np.testing.assert_array_equal(run.events, plain.events)


def test_events_at_impacts():
    ball = Model.from_text(BALL)
    run = ball.simulate(until=1.2, law="elastic", events=["x", ("dot(x)", -1)])
    # The position touches 0 where the velocity jumps: neither is an event. The top is one.
    fall = math.sqrt(2 / 9.81)
    np.testing.assert_allclose(run.crossings["t"], [2 * fall], rtol=1e-13)
    assert run.crossings["event"][0] == "dot(x)"


def test_a_terminal_event_ends_the_run(free):
    run = free.simulate(events=[Event("x - 2", terminal=True), Event("x - 3", terminal=True)], samples=101)
    assert (run.outcome.kind, run.outcome.reached, run.outcome.details) == ("event", True, {"event": "x - 2"})
    assert run.outcome.t == pytest.approx(2, rel=1e-15) and run.last["x"] == pytest.approx(2, rel=1e-15)
    assert len(run.crossings) == 1 and run.t[-1] <= run.outcome.t and len(run.t) in (20, 21)
    with pytest.raises(ValueError, match="t: times must be from 0 to 2"):
        run(2.5)
    np.testing.assert_allclose(run(1.75)["x"], 1.75)
    np.testing.assert_allclose(run.jacobian(["x_dot"])[:2, 0], [2, 0], rtol=1e-13, atol=1e-13)


def test_modes_have_events():
    walker = dalembert.models.spring_mass_walker
    [name] = [item for item in walker.coordinates if item == walker.coordinates[0]]
    run = walker.simulate(events=[f"dot({name})"])
    assert run.outcome.reached and run.crossings.dtype["at"]["mode"].kind == "U"


def test_callbacks_on_steps():
    steps = []
    ball = Model.from_text(BALL)
    run = ball.simulate(until=1, on_step=lambda t, q, qdot: steps.append((t, q[0], qdot[0])))
    assert len(steps) == run.counters["accepted"] and steps[-1][0] == 1
    assert steps[-1][1:] == (run.last["x"], run.last["x_dot"])
    stopped = ball.simulate(until=1, on_step=lambda t, q, qdot: q[0] < 0.8)
    assert (stopped.outcome.kind, stopped.outcome.details) == ("stopped", {"callback": "on_step"})
    assert not stopped.outcome.reached and stopped.outcome.t < 1 and stopped.last["x"] < 0.8


def test_callbacks_on_events():
    seen = []
    ball = Model.from_text(BALL)
    run = ball.simulate(until=2, rest="contact", events=["dot(x)"], on_event=seen.append)
    assert [item.kind for item in seen[:3]] == ["impact", "falling", "impact"]
    assert seen[0].name == "floor" and seen[0].t == run.events["t"][0]
    assert seen[0].qdot_after[0] == run.events["after"]["x_dot"][0] == pytest.approx(-seen[0].qdot[0] / 2)
    assert seen[-1].kind == "contact"
    stopped = ball.simulate(until=2, events=["dot(x)"], on_event=lambda item: "stop" if item.kind == "falling" else None)
    assert (stopped.outcome.kind, stopped.outcome.t) == ("stopped", run.crossings["t"][0])
    at_impact = ball.simulate(until=2, on_event=lambda item: True)
    assert at_impact.outcome.t == run.events["t"][0] and at_impact.last["x_dot"] > 0


def test_errors_of_callbacks_are_raised(free):
    with pytest.raises(ZeroDivisionError):
        free.simulate(on_step=lambda t, q, qdot: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        free.simulate(events=[lambda t, q, qdot: 1 / 0])
    with pytest.raises(RequestError, match="a callback returned 7; expected None or False"):
        free.simulate(on_step=lambda t, q, qdot: 7)


@pytest.mark.parametrize(("events", "words"), [
    (["x +"], "events: `x +`: "),
    (["x", "z - 1"], "events: `z - 1`: unknown name `z`"),
    (["x; y: 1"], "events: `;` cannot be in the expression"),
    ([7], "events: 7 is not accepted; expected an expression, a function or an Event"),
    ([Event(None)], "expected an expression, a function or an Event"),
])
def test_events_that_are_refused(free, events, words):
    with pytest.raises(RequestError) as refused:
        free.simulate(events=events)
    assert words in str(refused.value)


def test_both_sides_of_an_impact():
    run = Model.from_text(BALL).simulate(until=0.7)
    [event] = run.events
    times = np.array([event["t"], 0.0, 0.7, 0.3])
    left, right = run(times, side="left"), run(times)
    assert left["x_dot"][0] == event["before"]["x_dot"] and right["x_dot"][0] == event["after"]["x_dot"]
    np.testing.assert_array_equal(left.q[1:], right.q[1:])
    np.testing.assert_array_equal(left.qdot[1:], right.qdot[1:])
    with pytest.raises(ValueError, match='side: `both` is not accepted; expected "left" or "right"'):
        run(0.1, side="both")


@pytest.mark.parametrize(("until", "impacts", "end"), [(1.0, None, "1"), (5.0, 1, "0.451524")])
@pytest.mark.parametrize("has_tqdm", [True, False])
def test_progress_ends_where_the_run_ends(has_tqdm, until, impacts, end, capsys, monkeypatch):
    if has_tqdm:
        pytest.importorskip("tqdm")
    else:
        monkeypatch.setitem(__import__("sys").modules, "tqdm.auto", None)
    run = Model.from_text(BALL).simulate(until=until, impacts=impacts, samples=0, progress=True)
    shown = capsys.readouterr().err
    last = shown.rstrip().splitlines()[-1].rsplit("\r", 1)[-1]
    assert last.startswith("ball") and f"{end}/{until:g}" in last.replace(" of ", "/"), shown
    assert f"{run.outcome.t:.6g}" == end
