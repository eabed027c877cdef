"""Texts that are refused, with places and counterexamples as data."""

import math
import pickle

import pytest
from conftest import BALL, SLEIGH

import dalembert
from dalembert import Model, ModelError


def refused(text, **arguments):
    with pytest.raises(ModelError) as raised:
        Model.from_text(text, **arguments)
    return raised.value


def test_a_mistake_has_a_place_and_carets():
    error = refused(BALL.replace("m*g*x;", "m*g*xx;"), file="ball.dal")
    assert (error.line, error.column) == (11, 37)
    assert error.counterexample is None
    assert error.text.splitlines()[-4:] == [
        "  --> ball.dal:11:37",
        "   |",
        "11 |     lagrangian = m/2*dot(x)^2 - m*g*xx;",
        "   |                                     ^^",
    ]
    assert str(error) == error.text
    [mistake] = error.mistakes
    assert mistake.message.startswith("unknown name `xx`")
    assert mistake.width == 2


def test_all_mistakes_of_a_stage_are_told():
    error = refused(BALL.replace("m*g*x;", "m*g*xx + yy;"))
    assert [mistake.column for mistake in error.mistakes] == [37, 42]


def test_a_text_that_is_none():
    assert refused("Ball {").line == 1
    assert refused("").line == 1


def test_a_refuted_claim_has_its_counterexample_as_data():
    error = refused(SLEIGH)
    assert (error.line, error.column) == (8, 14)
    at = error.counterexample
    assert set(at) == {"theta", "m", "I", "a"}
    # A density that depends on q alone exists only if this coefficient is 0. The reported value is a positive multiple of it.
    delta = -at["m"] * at["a"] / (at["I"] + at["m"] * at["a"] ** 2)
    scale = error.mistakes[0].values["delta"] / delta
    assert math.isfinite(scale) and scale > 0
    assert "a density exists where a = 0" in error.text


def test_the_counterexample_of_a_conserved_quantity_refutes_it():
    error = refused(BALL.replace("initial", "claims { conserved: dot(x); } initial"))
    assert error.counterexample["g"] > 0
    assert "`conserved: dot(x)` is refuted" in error.mistakes[0].message


def test_errors_are_pickled():
    error = refused(SLEIGH)
    copy = pickle.loads(pickle.dumps(error))
    assert (copy.text, copy.mistakes) == (error.text, error.mistakes)


def test_every_exception_has_one_base():
    assert issubclass(ModelError, dalembert.DalembertError)
    assert issubclass(dalembert.RequestError, dalembert.DalembertError)
    assert issubclass(dalembert.RequestError, ValueError)
