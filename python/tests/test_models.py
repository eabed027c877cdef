"""Construction of models, and their descriptions."""

import pickle
import subprocess
import sys

import pytest
from conftest import BALL, SLEIGH

import dalembert
from dalembert import Model, RequestError


def test_a_text_becomes_a_model():
    ball = Model.from_text(BALL)
    assert ball.name == "ball"
    assert ball.documentation == "A ball above a floor."
    assert ball.coordinates == ("x",)
    assert ball.velocities == ("x_dot",)
    assert ball.surfaces == {"floor": "newton(1/2)"}
    assert dict(ball.parameters) == {"m": 0.5, "g": 9.81}
    assert ball.initial == {"x": 1.0, "until": 1.0}


def test_a_file_becomes_a_model(tmp_path):
    path = tmp_path / "ball.dal"
    path.write_text(BALL, encoding="utf-8")
    assert Model.from_file(path).name == "ball"
    with pytest.raises(FileNotFoundError):
        Model.from_file(tmp_path / "none.dal")


def test_one_of_several_models_is_named():
    text = BALL + BALL.replace("Ball", "SecondBall")
    assert Model.from_text(text, "second_ball").name == "second_ball"
    assert Model.from_text(text, "SecondBall").name == "second_ball"
    with pytest.raises(RequestError, match="declares several models, ball, second_ball"):
        Model.from_text(text)
    with pytest.raises(RequestError, match="declares no model `cube`"):
        Model.from_text(text, "cube")


def test_parameters_are_attributes_and_make_other_models():
    ball = Model.from_text(BALL)
    moon = ball.with_parameters(g=1.62)
    assert (moon.g, moon.m, ball.g) == (1.62, 0.5, 9.81)
    assert "g" in dir(ball)
    with pytest.raises(AttributeError, match="no parameter or attribute `q`"):
        ball.q
    with pytest.raises(TypeError):
        ball.parameters["g"] = 1.0


@pytest.mark.parametrize(("values", "words"), [
    ({"m": -1}, "m: -1 is not accepted; expected a value > 0"),
    ({"m": float("nan")}, "m: NaN is not accepted"),
    ({"mm": 1}, "unknown parameter `mm`; did you mean `m`?"),
])
def test_parameters_that_are_refused(values, words):
    with pytest.raises(RequestError) as refused:
        Model.from_text(BALL).with_parameters(**values)
    assert words in str(refused.value)


def test_the_representation_has_values_assumptions_and_docs():
    shown = repr(Model.from_text(BALL).with_parameters(m=3))
    for line in ["Model ball", "  A ball above a floor.", "    m = 3            > 0  Mass.", "    g = 9.81         > 0  Gravity."]:
        assert line in shown.splitlines(), shown


def test_shipped_models_are_loaded_when_they_are_asked_for():
    assert len(dalembert.models.names()) > 30
    assert "rolling_disk" in dir(dalembert.models)
    disk = dalembert.models.rolling_disk
    assert disk is dalembert.models.rolling_disk
    assert disk.constraints == ("rolling_x", "rolling_y")
    assert "RollingDisk {" in dalembert.models.text("rolling_disk")
    with pytest.raises(AttributeError, match="no shipped model is called `rolling_dsk`"):
        dalembert.models.rolling_dsk


@pytest.mark.parametrize("name", dalembert.models.names())
def test_every_shipped_model_loads(name):
    if name == "chain16":
        pytest.skip("takes seconds")
    model = getattr(dalembert.models, name)
    assert model.name == name
    assert name in repr(model)


def test_scenes_are_models():
    disk = dalembert.models.rolling_disk.with_parameters(ta=0.3)
    free = disk.scene("free")
    assert free.surfaces == {}
    assert free.ta == 0.3
    with pytest.raises(RequestError, match="unknown scene `fre`; did you mean `free`?"):
        disk.scene("fre")


def test_models_are_pickled():
    model = dalembert.models.rolling_disk.with_parameters(m=0.003).scene("free")
    copy = pickle.loads(pickle.dumps(model))
    assert repr(copy) == repr(model)


def test_a_text_without_claims_is_loaded_without_examining_them():
    with pytest.raises(dalembert.ModelError):
        Model.from_text(SLEIGH)
    sleigh = Model.from_text(SLEIGH, claims=False)
    assert sleigh.check() == ()


def test_the_import_takes_no_numpy():
    code = "import sys, dalembert; assert 'numpy' not in sys.modules; dalembert.models.bouncing_ball.simulate()"
    subprocess.run([sys.executable, "-c", code], check=True)
