"""Equations: their display, and a check against the Euler-Lagrange equations of SymPy."""

import re
from pathlib import Path

import numpy as np
import pytest
import sympy
from conftest import BALL
from sympy.calculus.euler import euler_equations

import dalembert
from dalembert import Model

#: Models without constraints and with linear, affine and nonlinear ones, with families, resets and a moving wall.
NAMES = [
    "rolling_disk", "moving_wall_disk", "chaplygin_sleigh", "rolling_ball_euler", "ball_on_rotating_table", "two_wheels_rod",
    "holonomic_bead_on_ellipses", "appell_hamel", "constant_speed", "bouncing_ball", "point_billiard", "double_pendulum", "chain3",
    "harmonic_oscillator", "super_elastic_strip",
]

#: The functions that the documentation lists.
FUNCTIONS = re.search(
    r"the functions `([a-z0-9 ]+)`", (Path(__file__).parents[2] / "docs" / "language.md").read_text(encoding="utf-8"),
).group(1).split()


def admissible(model, generator):
    """A random state, and all derived quantities there."""
    for _ in range(100):
        state = {name: generator.uniform(-0.9, 0.9) for name in model.coordinates}
        rates = {name: generator.uniform(0.5, 1.5) for name in model.velocities}
        try:
            run = model.simulate(until=1e-9, state={**state, **rates}, off_constraint="project", samples=1)
            return run.q[0], run.qdot[0], model.evaluate(run.q[0], run.qdot[0])
        except dalembert.RequestError:
            continue
    raise AssertionError(f"no state of {model.name}")


@pytest.mark.parametrize("name", NAMES)
def test_the_motion_satisfies_the_equations_of_sympy(name):
    model = getattr(dalembert.models, name)
    symbolic = model.to_sympy()
    generator = np.random.default_rng(7)
    functions = list(symbolic.q.values())
    equations = euler_equations(symbolic.lagrangian, functions, symbolic.t)
    for _ in range(3):
        q, qdot, derived = admissible(model, generator)
        values = {symbol: model.parameters[item] for item, symbol in symbolic.parameters.items()}
        # Accelerations first: as derivatives, they contain the velocities, and these contain the coordinates.
        values |= dict(zip([item.diff(symbolic.t) for item in symbolic.qdot.values()], derived["acceleration"]))
        values |= dict(zip(symbolic.qdot.values(), qdot))
        values |= dict(zip(functions, q))
        values[symbolic.t] = 0

        def number(expression):
            return float(sympy.sympify(expression).subs(list(values.items())))

        multipliers, residuals, sizes = derived.get("multipliers", []), [], []
        for place, (item, equation) in enumerate(zip(symbolic.q, equations)):
            terms = [number(term) for term in sympy.Add.make_args(equation.lhs.doit())]
            terms.append(number(symbolic.forces[item]))
            terms += [
                multiplier * number(form[place])
                for multiplier, form in zip(multipliers, symbolic.constraint_forms.values())
            ]
            residuals.append(abs(sum(terms)))
            sizes.append(sum(map(abs, terms)))
        assert max(residuals) <= 1e-9 * max(sizes), (residuals, sizes)
        for constraint in symbolic.constraints.values():
            terms = [number(term) for term in sympy.Add.make_args(constraint)]
            assert abs(sum(terms)) <= 1e-9 * sum(map(abs, terms))


@pytest.mark.parametrize("name", NAMES)
def test_the_lagrangian_that_is_printed_is_that_of_the_declaration(name):
    model = getattr(dalembert.models, name)
    symbolic, printed = model.to_sympy(), model.lagrangian.to_sympy()
    generator = np.random.default_rng(3)
    names = [*symbolic.qdot.values(), *symbolic.q.values(), *symbolic.parameters.values(), symbolic.t]
    for _ in range(3):
        values = [(item, sympy.Float(generator.uniform(0.1, 0.9), 30)) for item in names]
        difference = (printed - symbolic.lagrangian).subs(values)
        assert abs(sympy.N(difference, 30)) < 1e-20


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_of_the_language_are_those_of_sympy(name):
    call = f"{name}(x, 1/3)" if name == "atan2" else f"{name}(x)"
    model = Model.from_text(f"One {{ coordinates {{ x; }} lagrangian = dot(x)^2/2; forces {{ push: {call}*d(x); }} }}")
    symbolic = model.to_sympy()
    force = symbolic.forces["x"].subs(symbolic.q["x"], 0.4)
    assert model.evaluate([0.4], [0])["pdot"][0] == pytest.approx(float(force), rel=1e-14)


def test_gaps_are_exported():
    symbolic = dalembert.models.rolling_disk.to_sympy()
    x, phi = symbolic.q["x"], symbolic.q["phi"]
    y, R, ta, tb = symbolic.q["y"], *(symbolic.parameters[item] for item in ["R", "ta", "tb"])
    edge = 1 - (x + R * sympy.cos(phi)) ** 2 / ta**2 - (y + R * sympy.sin(phi)) ** 2 / tb**2
    assert sympy.simplify(symbolic.surfaces["leading_edge"] - edge) == 0
    assert R.is_positive


def test_first_order_systems_have_rates():
    symbolic = dalembert.models.dimensionless_walker.to_sympy()
    assert symbolic.lagrangian is None
    assert list(symbolic.rates) == list(dalembert.models.dimensionless_walker.coordinates)


def test_modes_have_declarations_of_their_own():
    walker = dalembert.models.spring_mass_walker
    with pytest.raises(dalembert.RequestError, match="has modes; say which one by scene="):
        walker.to_sympy()
    symbolic = walker.to_sympy(walker.modes[0])
    assert symbolic.lagrangian is not None
    assert walker.derive(walker.modes[0]).lagrangian.to_sympy().free_symbols
    with pytest.raises(dalembert.RequestError, match="unknown scene `flight`"):
        walker.derive("flight")


def test_families_are_named_with_underscores():
    symbolic = dalembert.models.chain3.to_sympy()
    assert [str(item.func) for item in symbolic.q.values()][0].count("_") == 1


def test_derivations_are_shown_in_notebooks():
    model = Model.from_text(BALL)
    assert model.lagrangian._repr_latex_().startswith(r"$\displaystyle L = ")
    html = model._repr_html_()
    for part in ["<h3>ball</h3>", "<td>m</td><td>0.5</td>", "<h4>Lagrangian</h4>", r"\[ L = "]:
        assert part in html
    assert html.count(r"\[") == html.count(r"\]") > 3
    # Nothing in a formula may end it, or begin a tag.
    for formula in re.findall(r"\\\[(.*?)\\\]", html, re.DOTALL):
        assert "<" not in formula and "$" not in formula
    assert model.derive()._repr_html_().startswith("<h3>ball</h3>")
    assert str(model.lagrangian) == model.lagrangian.text


def test_verdicts_are_data():
    verdicts = dalembert.models.rolling_disk.check()
    assert [verdict.claim for verdict in verdicts][:3] == ["density: exact", "volume: kept", "conserved: energy"]
    assert {verdict.verdict for verdict in verdicts} == {"proved"}
    assert verdicts[-1].scene == "free"
    assert all(verdict.chance_of_error < 1e-15 for verdict in verdicts)


def test_scenes_have_derivations_of_their_own():
    disk = dalembert.models.rolling_disk
    assert "leading_edge" in disk.derive().text
    assert "leading_edge" not in disk.scene("free").derive().text
