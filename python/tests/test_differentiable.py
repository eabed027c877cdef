"""Runs as functions of JAX and PyTorch: derivatives against closed forms and differences."""

import math

import numpy as np
import pytest
from conftest import BALL

import dalembert
from dalembert import Model, RequestError
from dalembert._final import Final

PASS = """
    Pass {
        coordinates { x; y; }
        lagrangian = dot(x)^2/2 + dot(y)^2/2;
        impacts { disk: x^2 + y^2 >= 1; }
        initial { x = -2; y = 1; dot(x) = 1; dot(y) = 0; until = 4; }
    }
"""

#: A ball that lands on a hill and slides down it.
SLOPE = """
    Slope {
        coordinates { x; y; }
        parameters { g > 0 = 9.81; slope = 0.3; }
        lagrangian = dot(x)^2/2 + dot(y)^2/2 - g*y;
        impacts { ground: y >= -slope*sin(x) => impact_plastic; }
        initial { x = 0; y = 1; dot(x) = 1/2; dot(y) = 0; until = 2; }
    }
"""

#: Models, varied quantities and arguments: a bounce, many bounces with constraints, sliding, a change of mode.
CASES = {
    "bounce": (lambda: Model.from_text(BALL), {"x": 1.0, "x_dot": 0.2, "g": 9.81}, {"until": 0.7, "tol": 1e-13}),
    "disk": (
        lambda: dalembert.models.rolling_disk, {"theta_dot": 12.0, "phi": 1.3, "x": 0.01, "R": 0.01, "ta": 0.15},
        {"until": 4, "tol": 1e-14},
    ),
    "sliding": (
        lambda: Model.from_text(SLOPE), {"x": 0.0, "y": 1.0, "x_dot": 0.5, "g": 9.81, "slope": 0.3},
        {"rest": "contact", "tol": 1e-13},
    ),
    "modes": (lambda: dalembert.models.filippov_field, {"x": 1.0, "y": 0.2, "fx": -2.0, "gy": -1.0}, {"tol": 1e-13}),
}


def of_jax(model, names, **arguments):
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    import dalembert.jax

    return dalembert.jax.final_state(model, names, **arguments)


def jacobians_of_jax(end, values):
    import jax

    values = np.array(values)
    return [jax.jacfwd(end)(values), jax.jacrev(end)(values), jax.jit(jax.jacrev(end))(values)]


def jacobians_of_torch(end, values):
    import torch

    values = torch.tensor(values, dtype=torch.float64, requires_grad=True)
    reverse = torch.autograd.functional.jacobian(end, values)
    with torch.autograd.forward_ad.dual_level():
        columns = []
        for direction in torch.eye(len(values), dtype=torch.float64):
            dual = torch.autograd.forward_ad.make_dual(values.detach(), direction)
            columns.append(torch.autograd.forward_ad.unpack_dual(end(dual)).tangent)
    return [reverse, torch.stack(columns, 1)]


def of_torch(model, names, **arguments):
    pytest.importorskip("torch")
    import dalembert.torch

    return dalembert.torch.final_state(model, names, **arguments)


FRAMEWORKS = {"jax": (of_jax, jacobians_of_jax), "torch": (of_torch, jacobians_of_torch)}


def differences(end, values):
    """The derivative by central differences, extrapolated."""
    columns = []
    for place, value in enumerate(values):
        def slope(h):
            moved = [np.array(values), np.array(values)]
            moved[0][place] += h
            moved[1][place] -= h
            return (end(moved[0]) - end(moved[1])) / (2 * h)

        h = 1e-4 * max(1e-1, abs(value))
        columns.append((4 * slope(h / 2) - slope(h)) / 3)
    return np.array(columns).T


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("framework", FRAMEWORKS)
def test_derivatives_agree_with_finite_differences(framework, case):
    make, jacobians = FRAMEWORKS[framework]
    build, varied, arguments = CASES[case]
    model, values = build(), list(varied.values())
    end = make(model, list(varied), **arguments)
    plain = Final(model, list(varied), dict(arguments))
    run = plain._run(tuple(values))
    assert len(run.events) > 0 and (case != "sliding" or run.contacts["begins"].tolist() == [True])
    value = np.asarray(end(np.array(values)) if framework == "jax" else end(__import__("torch").tensor(values, dtype=float)))
    np.testing.assert_allclose(value, plain.end(values), rtol=1e-15)
    expected = differences(plain.end, values)
    scale = np.abs(expected).max(axis=0)
    for found in jacobians(end, values):
        assert found.shape == expected.shape
        np.testing.assert_allclose(np.asarray(found) / scale, expected / scale, rtol=0, atol=1e-6)


@pytest.mark.parametrize("framework", FRAMEWORKS)
def test_a_bounce_has_the_derivative_of_its_closed_form(framework):
    make, jacobians = FRAMEWORKS[framework]
    end = make(Model.from_text(BALL), ["x", "g"], until=0.7, tol=1e-13)
    x0, g, e, until = 1.0, 9.81, 0.5, 0.7
    s = math.sqrt(2 * x0 / g)
    by_s = e * g * (until - 2 * s) + g * (until - s)
    expected = [by_s * s / (2 * x0), by_s * -s / (2 * g) + e * s * (until - s) - (until - s) ** 2 / 2]
    for found in jacobians(end, [x0, g]):
        np.testing.assert_allclose(np.asarray(found)[0], expected, rtol=1e-11)


@pytest.mark.parametrize("framework", FRAMEWORKS)
def test_a_graze_is_refused_by_its_name(framework):
    make, jacobians = FRAMEWORKS[framework]
    end = make(Model.from_text(PASS), ["y"])
    with pytest.raises(Exception, match="graze at surface `disk`"):
        jacobians(end, [1.0])


def test_functions_of_jax_are_mapped():
    end = of_jax(Model.from_text(BALL), ["x"], until=0.7)
    import jax

    heights = np.array([[0.9], [1.0], [1.1]])
    mapped = jax.vmap(jax.jacrev(end))(heights)
    np.testing.assert_allclose(mapped, [jax.jacfwd(end)(height) for height in heights], rtol=1e-12)


def test_functions_of_torch_take_batches():
    end = of_torch(Model.from_text(BALL), ["x"], until=0.7)
    import torch

    heights = torch.tensor([[0.9], [1.0], [1.1]], dtype=torch.float64, requires_grad=True)
    assert end(heights).shape == (3, 2)
    end(heights)[:, 0].sum().backward()
    one = [torch.autograd.functional.jacobian(end, height.detach())[0, 0] for height in heights]
    np.testing.assert_allclose(heights.grad[:, 0], one, rtol=1e-12)


def test_a_start_keeps_its_declared_value_when_its_parameter_is_varied():
    model = Model.from_text(
        "Drop { coordinates { x; } parameters { a = 2; } lagrangian = dot(x)^2/2 - a*x; initial { x = a; until = 1; } }"
    )
    final = Final(model, ["a"], {})
    np.testing.assert_allclose(final.end([3.0]), [2 - 1.5, -3])
    np.testing.assert_allclose(final.jacobian([3.0]), [[-0.5], [-1]], rtol=1e-12)


@pytest.mark.parametrize(("names", "arguments", "words"), [
    (["z"], {}, "`z` is no coordinate, velocity or parameter of ball; accepted: x, x_dot, m, g"),
    (["x"], {"q": [1], "qdot": [0]}, "the start is varied by name"),
    (["x"], {"until": 50}, "the run has no end to differentiate: zeno"),
])
def test_ends_that_are_refused(names, arguments, words):
    with pytest.raises(RequestError, match=words):
        Final(Model.from_text(BALL), names, arguments).end([1.0])
