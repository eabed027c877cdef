"""Runs: samples, impacts, outcomes, refusals, signals."""

import math
import signal
import threading
import time

import numpy as np
import pytest
from conftest import BALL

import dalembert
from dalembert import Model, RequestError

LONG = """
Pendulum {
    coordinates { theta: angle; }
    lagrangian = dot(theta)^2/2 + cos(theta);
    initial { theta = 1; }
}
"""


@pytest.fixture
def ball():
    return Model.from_text(BALL)


def test_samples_are_those_of_the_closed_form(ball):
    run = ball.simulate(until=0.4, samples=5)
    np.testing.assert_array_equal(run.t, [0.0, 0.1, 0.2, 0.30000000000000004, 0.4])
    np.testing.assert_allclose(run["x"], 1 - 9.81 * run.t**2 / 2, rtol=1e-13)
    np.testing.assert_allclose(run["x_dot"], -9.81 * run.t, rtol=1e-13)
    np.testing.assert_allclose(run["p_x"], -9.81 * run.t / 2, rtol=1e-13)
    np.testing.assert_allclose(run.energy, 9.81 / 2, rtol=1e-13)
    assert run.q.shape == run.qdot.shape == run.p.shape == (5, 1)
    assert run.outcome.kind == "done" and run.outcome.reached and run.outcome.t == 0.4


def test_impacts_are_a_table(ball):
    run = ball.simulate(until=0.7)
    fall = math.sqrt(2 / 9.81)
    assert run.events.shape == (1,)
    [event] = run.events
    assert event["surface"] == "floor"
    assert event["t"] == pytest.approx(fall, rel=1e-14)
    assert event["before"]["x_dot"] == pytest.approx(-9.81 * fall, rel=1e-13)
    assert event["after"]["x_dot"] == pytest.approx(9.81 * fall / 2, rel=1e-13)
    assert not event["simultaneous"] and not event["grazing"]
    assert run.counters["impacts"] == 1
    assert run.laws == {"floor": "newton(0.5)"}


def test_impacts_that_accumulate_are_an_outcome(ball):
    run = ball.simulate(until=5)
    # The durations of the flights after the fall are a geometric series.
    end = 3 * math.sqrt(2 / 9.81)
    assert run.outcome.kind == "zeno" and not run.outcome.reached
    assert run.outcome.details["surface"] == "floor"
    assert run.outcome.details["accumulates_at"] == pytest.approx(end, rel=1e-9)
    assert run.t[-1] <= run.outcome.t < 5
    rests = ball.simulate(until=5, rest="contact")
    assert rests.outcome.kind == "done"
    [contact] = rests.contacts
    assert contact["surface"] == "floor" and contact["begins"]
    assert contact["accumulates_at"] == pytest.approx(end, rel=1e-9)


def test_laws_and_states_are_chosen(ball):
    run = ball.simulate(until=2, state={"x": 2, "x_dot": 1}, law="elastic")
    assert (run["x"][0], run["x_dot"][0]) == (2, 1)
    np.testing.assert_allclose(run.events["after"]["x_dot"], -run.events["before"]["x_dot"])
    again = ball.simulate(until=2, q=[2], qdot=[1], law={"floor": "newton:1"})
    np.testing.assert_allclose(again["x"], run["x"], rtol=1e-12)
    momenta = ball.simulate(until=2, q=[2], p=[0.5], law="elastic")
    np.testing.assert_array_equal(momenta["x"], run["x"])


def test_velocities_that_nobody_names_follow_from_the_constraints():
    disk = dalembert.models.rolling_disk
    run = disk.simulate(until=0.1, state={"theta_dot": 12, "phi": 0.3})
    assert run["x_dot"][0] == pytest.approx(disk.R * math.cos(0.3) * 12, rel=1e-14)


def test_a_number_of_impacts_ends_a_run(ball):
    run = ball.simulate(impacts=3, samples=11)
    assert run.outcome.kind == "impact_budget" and run.outcome.reached
    assert len(run.events) == 3
    assert run.t[-1] == run.events["t"][-1] == run.outcome.t


def test_times_are_chosen(ball):
    times = np.array([0.0, 0.2, 0.2, 0.7])
    run = ball.simulate(until=1, times=times)
    np.testing.assert_array_equal(run.t, times)
    np.testing.assert_allclose(run["x"][1], 1 - 9.81 * 0.04 / 2, rtol=1e-13)
    with pytest.raises(RequestError, match="times: they are not in order"):
        ball.simulate(until=1, times=[0.2, 0.1])
    with pytest.raises(RequestError, match="times: 2 is not accepted; expected times from 0 to 1"):
        ball.simulate(until=1, times=[0.2, 2])


def test_a_run_knows_all_its_times():
    run = dalembert.models.rolling_disk.simulate(until=20, samples=101)
    at = run(run.t[::-1].reshape(1, 101))
    assert at.q.shape == (1, 101, 4)
    np.testing.assert_array_equal(at["theta"][0, ::-1], run["theta"])
    np.testing.assert_array_equal(at.energy[0, ::-1], run.energy)
    assert run(0.25)["x"].shape == ()
    with pytest.raises(ValueError, match="t: times must be from 0 to 20"):
        run(21)


def test_arrays_are_not_copied(ball):
    run = ball.simulate(until=1)
    assert run.q is run.q
    assert np.shares_memory(run.q, run["x"])
    assert run.q.base is not None


def test_the_form_is_chosen():
    disk = dalembert.models.rolling_disk
    assert "reduced form" in repr(disk.simulate(until=1))
    globally = disk.simulate(until=1, form="global")
    assert "global form" in repr(globally)
    np.testing.assert_allclose(globally.q, disk.simulate(until=1).q, rtol=1e-6, atol=1e-9)


def test_modes():
    run = dalembert.models.tent_map.simulate()
    assert set(run.mode) <= set(run.model.modes)
    assert len(set(run.events["after"]["mode"])) > 1


def test_everything_derived_is_evaluated():
    disk = dalembert.models.rolling_disk
    values = disk.evaluate([0, 0, 0, 0.3], [disk.R * 2 * math.cos(0.3), disk.R * 2 * math.sin(0.3), 2, 0.5])
    assert values["metric"].shape == (4, 4)
    assert values["energy"] == pytest.approx((disk.m * disk.R**2 + disk.I) * 2 + disk.J / 8, rel=1e-14)
    assert values["multipliers"][0] == pytest.approx(-disk.m * disk.R * 2 * 0.5 * math.sin(0.3), rel=1e-12)


def test_fixed_steps_warn():
    run = dalembert.models.double_pendulum.simulate(until=20, integrator="rk4", step=0.5)
    assert "the energy is off by" in run.warnings[0]


@pytest.mark.parametrize(("arguments", "words"), [
    ({"until": -1}, "until: -1 is not accepted; expected a positive number"),
    ({"until": math.inf}, "until: inf is not accepted"),
    ({"tol": 1}, "tol: 1 is not accepted; expected a number from 1e-15 to 0.1"),
    ({"integrator": "dop835"}, "unknown integrator `dop835`; did you mean `dop853`?"),
    ({"step": 0.1}, "step: dop853, dopri5 and taylor choose their steps by tol"),
    ({"max_step": 0.1, "integrator": "rk4"}, "max_step: rk4, gauss4"),
    ({"state": {"xdot": 1}}, "state: unknown coordinate or velocity `xdot`"),
    ({"state": {"x": math.nan}}, "the position of `x` is not finite"),
    ({"q": [1]}, "q needs either qdot or p"),
    ({"q": [1, 2], "qdot": [0, 0]}, "qdot: expected 1 numbers (x), got 2"),
    ({"state": {"x": 1}, "q": [1], "qdot": [1]}, "state: it changes the declared initial state"),
    ({"law": "elstic"}, "unknown law `elstic`; did you mean `elastic`?"),
    ({"law": "newton"}, 'expected "newton:E" with E a number from 0 to 1'),
    ({"law": "newton:x"}, 'expected a law such as "elastic" or "newton:0.5"'),
    ({"law": {"wall": "elastic"}}, "law: unknown surface `wall`\n  accepted: floor"),
    ({"law": "reset"}, "law: surface `floor` declares no reset"),
    ({"form": "reduced"}, "form: `ball` has no form reduced to D"),
    ({"rest": "go"}, "unknown rest `go`"),
    ({"impacts": 0}, "impacts: 0 is not accepted"),
    ({"mode": "up"}, "unknown mode `up`; there are none"),
    ({"inputs": {"u": 1}}, "unknown input `u`; there are none"),
])
def test_requests_that_are_refused(ball, arguments, words):
    with pytest.raises(RequestError) as refused:
        ball.simulate(**arguments)
    assert words in str(refused.value)


def test_states_off_the_constraints_are_refused_with_a_way_out():
    disk = dalembert.models.rolling_disk
    off = {"x_dot": 1, "theta_dot": 0, "phi": 0}
    with pytest.raises(RequestError, match='use off_constraint="project"'):
        disk.simulate(q=[0, 0, 0, 0], qdot=[1, 0, 0, 0])
    run = disk.simulate(until=0.1, state=off, off_constraint="project")
    assert run["x_dot"][0] == pytest.approx(disk.R * run["theta_dot"][0], rel=1e-12)


def test_a_parameter_without_default_must_be_given():
    text = BALL.replace("g > 0 = 9.81;", "g > 0;")
    with pytest.raises(RequestError, match=r"parameter `g` has no default; give it by with_parameters\(g=..\)"):
        Model.from_text(text).simulate()
    assert Model.from_text(text).with_parameters(g=1).simulate().outcome.reached


@pytest.fixture
def interrupts():
    """Installs Python's handler of SIGINT. A Python that a shell started in the background has none."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interrupts")
def test_a_run_is_interrupted():
    pendulum = Model.from_text(LONG)
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        pendulum.simulate(until=1e9, samples=0, steps=10**12)
    assert time.monotonic() - began < 5


def test_other_threads_go_on_meanwhile():
    pendulum = Model.from_text(LONG)
    ticks, ended = [], threading.Event()

    def tick():
        while not ended.wait(0.01):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    began = time.monotonic()
    pendulum.simulate(until=1e9, samples=0, steps=1_000_000)
    length = time.monotonic() - began
    ended.set()
    thread.join()
    assert length > 0.1, "a run that is long enough"
    assert sum(tick < began + length for tick in ticks) > 3
