#!/usr/bin/env python3
"""Checks certificates of dalembert: `dalembert check MODEL --certificate FILE`, then `check_certificate.py FILE ..`.

A certificate holds a declaration written out in coordinates, and the verdicts on its claims. This program uses nothing
of the generator. It sets up the equations of motion from the Lagrangian and the constraints by numerical differentiation in 120 or
220 digits, and tests every claim that was proved at random states:

  conserved          d/dt of the quantity along the motion is 0 (or, if the claim is that it changes, is not 0)
  conserved under    the quantity is the same before and after an impact or a transition
  density            the density times mu_C satisfies Liouville's equation
  exact              the same for the closed form exp(G); every argument of a logarithm in G is enclosed away from 0
  no_density         a density prescribes its logarithmic derivative along the fields of D and along their brackets; the prescribed
                     values contradict each other
  locally_exact      the same values do not contradict each other
  symmetry           the flow keeps the Lagrangian (up to a total derivative) and the constraints, or commutes with the rates
  volume_kept        the density satisfies Liouville's equation, and the motion through each surface keeps its volume
  factor             the factor is the determinant of the derivative of the motion through the surface, times the ratio of densities
  symplectic         forces are closed, and the motion through each surface keeps dp dq - dH dt; with constraints, the motion keeps
                     dp dq on all states, or on the leaves if the constraints are integrable
  invariant_form     the form is the same on vectors that the motion carries along, between surfaces and through each of them
  involution         the Poisson bracket of the functions, extended from D as constants along the constraint forces, is 0 on D
  integrable         the same, each function is conserved between surfaces and through each of them, and their differentials are
                     independent
  energy_not_increasing  the energy after an impact is not above that before

Random states cannot prove an identity, but a false one passes only where it holds to 28 digits (18 to 20 for symmetries,
forms and maps through surfaces). Only the standard library of Python is used.

The verdict on a claim is `holds`, `FAILED`, `partly` (the part that can be checked holds), `unchecked` (this kind of claim is not
checked) or `open` (the claim was not proved). Exit status: 0 if nothing failed, 1 if a claim failed, 2 if a file cannot be read.
"""

import argparse
import json
import random
import re
import sys
from copy import copy
from decimal import (
    ROUND_CEILING, ROUND_FLOOR, Context, Decimal, DivisionByZero, InvalidOperation, Overflow, localcontext,
)
from functools import lru_cache

FORMAT = "dalembert certificate 2"
# The part of a claim that can be checked holds; the rest is not checked.
PARTLY = "partly"
STATES = 3
ATTEMPTS = 200


class Unsuitable(Exception):
    """A state at which something does not exist; another one is tried."""


class NotChecked(Exception):
    """A claim of a kind that this program does not check."""


# Numbers ---------------------------------------------------------------------------------------------------------------

class Precision:
    """Digits of numbers, and the step of difference quotients."""

    def __init__(self, digits, step):
        self.digits, self.h = digits, Decimal(10) ** -step


SIMPLE = Precision(120, 25)
NESTED = Precision(220, 28)


def here():
    """The digits of the context."""
    from decimal import getcontext
    return getcontext().prec


@lru_cache(maxsize=None)
def pi_of(digits):
    """Machin's formula."""
    with localcontext(Context(prec=digits + 10)):
        def arctangent(n):
            term = total = Decimal(1) / n
            k = 1
            while abs(term) > Decimal(10) ** -(digits + 9):
                term = -term / (n * n)
                k += 2
                total += term / k
            return total
        return 4 * (4 * arctangent(5) - arctangent(239))


@lru_cache(maxsize=65536)
def sine_and_cosine(x, digits):
    with localcontext(Context(prec=digits + 15)):
        turn = 2 * pi_of(digits + 10 + max(0, x.adjusted()))
        x = x - turn * (x / turn).to_integral_value()
        # Eight halvings of the angle, the series of sine and cosine, then eight doublings.
        x /= 256
        square, sine, cosine = x * x, x, Decimal(1)
        term_s, term_c, k = x, Decimal(1), 1
        while abs(term_c) > Decimal(10) ** -(digits + 14):
            term_c = -term_c * square / (k * (k + 1))
            term_s = -term_s * square / ((k + 1) * (k + 2))
            cosine, sine, k = cosine + term_c, sine + term_s, k + 2
        for _ in range(8):
            sine, cosine = 2 * sine * cosine, cosine * cosine - sine * sine
    return +sine, +cosine


def sin(x):
    return sine_and_cosine(x, here())[0]


def cos(x):
    return sine_and_cosine(x, here())[1]


def tan(x):
    sine, cosine = sine_and_cosine(x, here())
    return sine / cosine


@lru_cache(maxsize=4096)
def arctangent_of(x, digits):
    with localcontext(Context(prec=digits + 15)):
        for _ in range(8):
            x = x / (1 + (1 + x * x).sqrt())
        square, term, total, k = x * x, x, x, 1
        while abs(term) > Decimal(10) ** -(digits + 14):
            term = -term * square
            k += 2
            total += term / k
        return total * 256


def atan(x):
    return +arctangent_of(x, here())


def atan2(y, x):
    if x == 0 and y == 0:
        raise Unsuitable("atan2(0, 0)")
    pi = pi_of(here())
    if abs(x) >= abs(y):
        angle = atan(y / x)
        return angle if x > 0 else angle + (pi if y >= 0 else -pi)
    return (pi / 2 if y > 0 else -pi / 2) - atan(x / y)


def sqrt(x):
    if x < 0:
        raise Unsuitable("the root of a negative number")
    return x.sqrt()


def ln(x):
    if x <= 0:
        raise Unsuitable("the logarithm of a number that is not positive")
    return x.ln()


def log1p(x):
    """The logarithm of 1 + x, to all digits for a small x."""
    if x <= -1:
        raise Unsuitable("log1p of a number that is not above -1")
    if x == 0 or x.adjusted() < -here():
        return x
    with localcontext(Context(prec=2 * here() + 5)):
        logarithm = (1 + x).ln()
    return +logarithm


def exp(x):
    return x.exp()


def asin(x):
    return atan2(x, sqrt(1 - x * x))


def acos(x):
    return atan2(sqrt(1 - x * x), x)


def sinh(x):
    return (exp(x) - exp(-x)) / 2


def cosh(x):
    return (exp(x) + exp(-x)) / 2


def tanh(x):
    return sinh(x) / cosh(x)


def power(base, numerator, denominator):
    """A power with a rational exponent."""
    if denominator != 1:
        if base < 0:
            raise Unsuitable("a power of a negative number")
        if base == 0:
            return Decimal(0)
        base = base.sqrt() if denominator == 2 else (base.ln() / denominator).exp()
    if base == 0 and numerator < 0:
        raise Unsuitable("a division by 0")
    return base ** numerator


def asinh(x):
    return -asinh(-x) if x < 0 else ln(x + sqrt(x * x + 1))


FUNCTIONS = {item.__name__: item for item in (
    sin, cos, tan, asin, acos, atan, atan2, sqrt, ln, log1p, exp, sinh, cosh, tanh, asinh, abs)}


# Expressions -----------------------------------------------------------------------------------------------------------

TOKEN = re.compile(r"\s*(?:(\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)|([^\W\d]\w*(?:\.\d+)*)|(.))")


class Parser:
    """Reads an expression into nested tuples."""

    def __init__(self, text):
        self.tokens = [match.groups() for match in TOKEN.finditer(text) if match.group().strip()]
        self.at = 0
        self.text = text

    def peek(self):
        return self.tokens[self.at] if self.at < len(self.tokens) else (None, None, None)

    def eat(self, sign):
        if self.peek()[2] == sign:
            self.at += 1
            return True
        return False

    def expect(self, sign):
        if not self.eat(sign):
            raise ValueError(f"expected {sign!r} in {self.text!r}")

    def whole(self):
        tree = self.sum()
        if self.at != len(self.tokens):
            raise ValueError(f"cannot read {self.text!r}")
        return tree

    def sum(self):
        tree = self.product()
        while True:
            if self.eat("+"):
                tree = ("+", tree, self.product())
            elif self.eat("-"):
                tree = ("-", tree, self.product())
            else:
                return tree

    def product(self):
        tree = self.unary()
        while True:
            if self.eat("*"):
                tree = ("*", tree, self.unary())
            elif self.eat("/"):
                tree = ("/", tree, self.unary())
            else:
                return tree

    def unary(self):
        if self.eat("-"):
            return ("neg", self.unary())
        return self.power()

    def power(self):
        base = self.atom()
        return ("^", base, self.unary()) if self.eat("^") else base

    def atom(self):
        number, name, _ = self.peek()
        if number is not None:
            self.at += 1
            return ("number", number)
        if name is not None:
            self.at += 1
            if name in ("dot", "momentum"):
                self.expect("(")
                inner = self.peek()[1]
                self.at += 1
                self.expect(")")
                return ("name", f"{name}({inner})")
            if self.eat("("):
                arguments = [self.sum()]
                while self.eat(","):
                    arguments.append(self.sum())
                self.expect(")")
                if name not in FUNCTIONS:
                    raise ValueError(f"unknown function {name!r} in {self.text!r}")
                return ("call", name, arguments)
            return ("name", name)
        self.expect("(")
        tree = self.sum()
        self.expect(")")
        return tree


def rational(tree):
    """An exponent as two integers."""
    kind = tree[0]
    if kind == "number" and re.fullmatch(r"\d+", tree[1]):
        return int(tree[1]), 1
    if kind == "neg":
        n, d = rational(tree[1])
        return -n, d
    if kind == "/":
        (a, b), (c, d) = rational(tree[1]), rational(tree[2])
        return a * d, b * c
    raise ValueError("an exponent that is not rational")


class Names:
    """The places of names in the list of values that expressions are evaluated at."""

    def __init__(self, names):
        self.places = {name: index for index, name in enumerate(names)}

    def compile(self, text):
        """The expression as a function of the list of values."""
        tree = Parser(text).whole()
        scope = dict(FUNCTIONS, D=Decimal, P=power, pi=lambda: pi_of(here()))
        return eval(f"lambda E: {self.code(tree)}", {"__builtins__": {}, **scope})

    def code(self, tree):
        kind = tree[0]
        if kind == "number":
            return f"D('{tree[1]}')"
        if kind == "name":
            if tree[1] == "pi":
                return "pi()"
            if tree[1] not in self.places:
                raise ValueError(f"unknown name {tree[1]!r}")
            return f"E[{self.places[tree[1]]}]"
        if kind == "neg":
            return f"(-{self.code(tree[1])})"
        if kind == "^":
            numerator, denominator = rational(tree[2])
            return f"P({self.code(tree[1])},{numerator},{denominator})"
        if kind == "call":
            return f"{tree[1]}({','.join(self.code(item) for item in tree[2])})"
        return f"({self.code(tree[1])}{kind}{self.code(tree[2])})"


# Linear algebra --------------------------------------------------------------------------------------------------------

def eliminated(rows, columns):
    """Rows after Gauss-Jordan elimination with pivots in the first `columns`; the pivots' places, and the determinant."""
    rows = [list(row) for row in rows]
    places, determinant, done = [], Decimal(1), 0
    size = max((abs(entry) for row in rows for entry in row[:columns]), default=Decimal(0))
    for column in range(columns):
        best = max(range(done, len(rows)), key=lambda i: abs(rows[i][column]), default=None)
        if best is None or abs(rows[best][column]) <= size * Decimal(10) ** -18:
            determinant *= 0
            continue
        if best != done:
            rows[best], rows[done] = rows[done], rows[best]
            determinant = -determinant
        pivot = rows[done][column]
        determinant *= pivot
        rows[done] = [entry / pivot for entry in rows[done]]
        for i, row in enumerate(rows):
            if i != done and row[column] != 0:
                factor = row[column]
                rows[i] = [item - factor * other for item, other in zip(row, rows[done])]
        places.append(column)
        done += 1
    return rows, places, determinant


def solve(matrix, right):
    rows, places, _ = eliminated([row + [item] for row, item in zip(matrix, right)], len(matrix))
    if len(places) < len(matrix):
        raise Unsuitable("a singular matrix")
    return [row[-1] for row in rows]


def determinant(matrix):
    return eliminated(matrix, len(matrix))[2] if matrix else Decimal(1)


def dot(a, b):
    return sum((x * y for x, y in zip(a, b)), Decimal(0))


def moved(point, direction, h):
    return [item + h * by for item, by in zip(point, direction)]


# The motion ------------------------------------------------------------------------------------------------------------

class Model:
    """A declaration, and the quantities that follow from it. A state is a list `[t, q.., v.., parameters..]`."""

    def __init__(self, content):
        self.q = [item["name"] for item in content["coordinates"]]
        self.v = [f"dot({name})" for name in self.q]
        self.n = len(self.q)
        self.coordinates, self.parameters = content["coordinates"], content["parameters"]
        names = ["t", *self.q, *self.v, *(item["name"] for item in self.parameters)]
        self.names = Names(names)
        extended = Names([*names, "energy", *(f"momentum({name})" for name in self.q)])
        self.compile_claimed = extended.compile
        motion = content["motion"]
        compile_all = lambda texts: [self.names.compile(item) for item in texts]
        self.rates = compile_all(motion["rates"]) if "rates" in motion else None
        if self.rates is None:
            self.metric = [compile_all(row) for row in motion["metric"]]
            self.linear = compile_all(motion["linear"])
            self.potential = self.names.compile(motion["potential"])
            self.forces = [compile_all(item) for item in motion["forces"]]
        self.constraints = [self.constraint(item) for item in content["constraints"]]
        self.is_nonlinear = any(item["nonlinear"] is not None for item in content["constraints"])
        #: Left sides of the position equations.
        self.levels = compile_all(item["position"] for item in content["constraints"] if item["position"] is not None)
        self.has_only_positions = 0 < len(self.levels) == len(self.constraints)
        self.surfaces = content["surfaces"]
        #: Indices of the surfaces at which the motion does not end.
        self.acting = [index for index, surface in enumerate(self.surfaces) if surface["law"] != "stop"]
        self.density = content["density"]
        self.parts = {}
        self.precision = SIMPLE

    def constraint(self, entry):
        """The components of a form and its affine part; for a nonlinear constraint, None and the function of the state."""
        if entry["nonlinear"] is not None:
            return None, self.names.compile(entry["nonlinear"])
        form = [self.names.compile(item) for item in entry["form"]]
        return form, self.names.compile(entry["affine"])

    def within(self, surface):
        """The model with the instantaneous constraints of a surface in addition to its own."""
        added = surface.get("instantaneous")
        if not added:
            return self
        found = copy(self)
        found.constraints = self.constraints + [self.constraint(item) for item in added]
        return found

    # Places of a state.
    def positions(self, state):
        return state[1:1 + self.n]

    def velocities(self, state):
        return state[1 + self.n:1 + 2 * self.n]

    def with_velocities(self, state, v):
        return [*state[:1 + self.n], *v, *state[1 + 2 * self.n:]]

    def along(self, state, dt=0, dq=None, dv=None):
        """A direction in which states are moved."""
        zeros = [Decimal(0)] * self.n
        rest = len(state) - 1 - 2 * self.n
        return [Decimal(dt), *(dq or zeros), *(dv or zeros), *([Decimal(0)] * rest)]

    def derivative(self, f, state, direction):
        """The derivative of a number or of a list of numbers."""
        h = self.precision.h
        after, before = f(moved(state, direction, h)), f(moved(state, direction, -h))
        if isinstance(after, list):
            return [(a - b) / (2 * h) for a, b in zip(after, before)]
        return (after - before) / (2 * h)

    def axis(self, i):
        return [Decimal(int(k == i)) for k in range(self.n)]

    # Quantities at a state.
    def metric_at(self, state):
        return [[item(state) for item in row] for row in self.metric]

    def admit(self, state):
        """Refuses a state that no run has: the metric is not positive definite, or a coefficient of a law is outside [0, 1]."""
        if self.rates is None:
            g = self.metric_at(state)
            if any(determinant([row[:k] for row in g[:k]]) <= 0 for k in range(1, self.n + 1)):
                raise Unsuitable("the metric is not positive definite")
        for surface in self.surfaces:
            written = surface["coefficient"]
            if written is not None and not 0 <= self.names.compile(written)(state) <= 1:
                raise Unsuitable("a coefficient of a law is outside [0, 1]")

    def momentum_at(self, state):
        v, g = self.velocities(state), self.metric_at(state)
        return [dot(row, v) + item(state) for row, item in zip(g, self.linear)]

    def kinetic_at(self, state):
        v, g = self.velocities(state), self.metric_at(state)
        return dot(v, [dot(row, v) for row in g]) / 2

    def energy_at(self, state):
        return self.kinetic_at(state) + self.potential(state)

    def lagrangian_at(self, state):
        linear = dot([item(state) for item in self.linear], self.velocities(state))
        return self.kinetic_at(state) + linear - self.potential(state)

    def forms_at(self, state):
        return [self.form_at(state, *item) for item in self.constraints]

    def form_at(self, state, form, phi):
        """The form; for a nonlinear constraint, its derivative with respect to the velocities (Chetaev's rule)."""
        if form is None:
            return [self.derivative(phi, state, self.along(state, 0, None, self.axis(i))) for i in range(self.n)]
        return [item(state) for item in form]

    def affine_at(self, state):
        return [affine(state) for _, affine in self.constraints]

    def residuals_at(self, state):
        v = self.velocities(state)
        linear = lambda form: Decimal(0) if form is None else dot([item(state) for item in form], v)
        return [linear(form) + rest(state) for form, rest in self.constraints]

    def acceleration(self, state):
        """From `d/dt dL/dv - dL/dq = F + lambda eta` and the rates of the constraints."""
        v, zeros = self.velocities(state), [Decimal(0)] * self.n
        drift = self.along(state, 1, v)
        slopes = [self.derivative(self.lagrangian_at, state, self.along(state, 0, self.axis(i))) for i in range(self.n)]
        rates = self.derivative(self.momentum_at, state, drift)
        right = [slope - rate for slope, rate in zip(slopes, rates)]
        for force in self.forces:
            right = [item + part(state) for item, part in zip(right, force)]
        forms, m = self.forms_at(state), len(self.constraints)
        bends = self.derivative(self.residuals_at, state, drift) if m else []
        g = self.metric_at(state)
        matrix = [[*row, *(-forms[a][i] for a in range(m))] for i, row in enumerate(g)]
        matrix += [[*form, *([Decimal(0)] * m)] for form in forms]
        del zeros
        return solve(matrix, right + [-item for item in bends])[:self.n]

    def direction_of_motion(self, state):
        if self.rates is not None:
            rates = [item(state) for item in self.rates]
            return self.along(state, 1, rates)
        return self.along(state, 1, self.velocities(state), self.acceleration(state))

    def claimed(self, text):
        """A quantity that a claim names, as a function of the state."""
        compiled = self.compile_claimed(text)
        uses_motion = "energy" in text or "momentum" in text

        def value(state):
            if uses_motion and self.rates is None:
                return compiled([*state, self.energy_at(state), *self.momentum_at(state)])
            return compiled([*state, *([Decimal(0)] * (self.n + 1))])
        return value

    # Other modes.
    def mode(self, name):
        """The mode of a name, with the digits of this one."""
        mode = self.parts[name]
        mode.precision = self.precision
        return mode

    def state_of(self, other, state, q, v):
        """A state of this mode, with the time and the parameters of a state of another one."""
        places = other.names.places
        rest = [state[places[item["name"]]] for item in self.parameters]
        return [state[0], *q, *v, *rest]

    # Random states.
    def number(self, source, low, high):
        return Decimal(source.randint(1, 9999)) / 10000 * (high - low) + low

    def random_state(self, source, given):
        """A state on the constraints, with random values except the given ones."""
        state = [self.number(source, Decimal(-1), Decimal(1))]
        for item in self.coordinates:
            low, high = Decimal("-1.6"), Decimal("1.6")
            if item["kind"] == "angle":
                low, high = Decimal(-3), Decimal(3)
            if item["kind"] == "interval":
                low, high = (constant(item[end]) for end in ("low", "high"))
                if high - low > 8:
                    middle = min(max(Decimal(1), low + 1), high - 1)
                    low, high = max(low, middle - 4), min(high, middle + 4)
            state.append(self.number(source, low, high))
        state += [self.number(source, Decimal(-1), Decimal(1)) for _ in range(self.n)]
        state += [self.parameter(source, item) for item in self.parameters]
        for name, value in given.items():
            state[self.names.places[name]] = Decimal(repr(value))
        return self.on_constraints(self.at_zeros(self.levels, state))

    def at_zeros(self, functions, state):
        """The state with a position near by at which functions of the position are 0 (Newton's method)."""
        values = lambda state: [function(state) for function in functions]
        for _ in range(60 if functions else 0):
            excess = values(state)
            if all(abs(item) < Decimal(10) ** -(self.precision.digits - 30) for item in excess):
                return state
            columns = [self.derivative(values, state, self.along(state, 0, self.axis(i))) for i in range(self.n)]
            slopes = [list(row) for row in zip(*columns)]
            square = [[dot(a, b) for b in slopes] for a in slopes]
            q = self.positions(state)
            for factor, slope in zip(solve(square, excess), slopes):
                q = moved(q, slope, -factor)
            state = [state[0], *q, *state[1 + self.n:]]
        if functions:
            raise Unsuitable("positions that satisfy the equations were not reached")
        return state

    def parameter(self, source, item):
        assumption, default = item["assumption"], item["default"]
        if default is not None and source.random() < 0.5:
            return constant(default)
        if isinstance(assumption, list):
            return self.number(source, *(constant(end) for end in assumption))
        if assumption in ("positive", "nonnegative"):
            return self.number(source, Decimal("0.3"), Decimal(2))
        return self.number(source, Decimal("0.2"), Decimal("1.4")) * source.choice((1, -1))

    def on_constraints(self, state):
        """The state with velocities that satisfy the constraints, changed as little as possible."""
        if self.rates is not None or not self.constraints:
            return state
        for _ in range(40 if self.is_nonlinear else 1):
            forms, residuals = self.forms_at(state), self.residuals_at(state)
            square = [[dot(a, b) for b in forms] for a in forms]
            by = solve(square, [-item for item in residuals])
            v = self.velocities(state)
            for factor, form in zip(by, forms):
                v = moved(v, form, factor)
            state = self.with_velocities(state, v)
        if self.is_nonlinear and not all(is_small(item, 1, 40) for item in self.residuals_at(state)):
            raise Unsuitable("the constraints were not reached")
        return state

    # The volume mu_C.
    def dependent(self, state):
        """The indices of velocities that the others determine at this state, through a matrix that is not nearly singular."""
        if not self.constraints:
            return []
        rows, chosen = [list(item) for item in self.forms_at(state)], []
        for a in range(len(rows)):
            best = max((j for j in range(self.n) if j not in chosen), key=lambda j: abs(rows[a][j]))
            if abs(rows[a][best]) < Decimal("1e-6"):
                raise Unsuitable("dependent constraints")
            chosen.append(best)
            for b in range(a + 1, len(rows)):
                factor = rows[b][best] / rows[a][best]
                rows[b] = [x - factor * y for x, y in zip(rows[b], rows[a])]
        return sorted(chosen)

    def completed(self, state, u, dependent):
        """The state with these independent velocities and the dependent ones that follow."""
        independent = [i for i in range(self.n) if i not in dependent]
        if self.is_nonlinear:
            return self.reached(state, dict(zip(independent, u)), dependent)
        v = [Decimal(0)] * self.n
        for place, value in zip(independent, u):
            v[place] = value
        if dependent:
            forms, affine = self.forms_at(state), self.affine_at(state)
            matrix = [[form[j] for j in dependent] for form in forms]
            right = [-(dot(form, v) + item) for form, item in zip(forms, affine)]
            for place, value in zip(dependent, solve(matrix, right)):
                v[place] = value
        return self.with_velocities(state, v)

    def reached(self, state, given, dependent):
        """The nearby state with the given velocities that satisfies nonlinear constraints (Newton's method)."""
        v = [given.get(i, item) for i, item in enumerate(self.velocities(state))]
        state = self.with_velocities(state, v)
        for _ in range(40):
            residuals = self.residuals_at(state)
            if all(is_small(item, 1, self.precision.digits - 10) for item in residuals):
                return state
            minor = [[form[j] for j in dependent] for form in self.forms_at(state)]
            v = list(self.velocities(state))
            for place, value in zip(dependent, solve(minor, residuals)):
                v[place] -= value
            state = self.with_velocities(state, v)
        raise Unsuitable("the constraints were not reached")

    def weight(self, state, dependent):
        minor = [[form[j] for j in dependent] for form in self.forms_at(state)]
        return determinant(self.metric_at(state)) / abs(determinant(minor))

    def divergence(self, state, u, dependent, density):
        """`div(density mu_C X) / (density mu_C)` in the coordinates q and u."""
        independent = [i for i in range(self.n) if i not in dependent]
        base = self.completed(state, u, dependent)
        whole = lambda s: density(s) * self.weight(s, dependent)

        def flux(i):
            return lambda s: (lambda item: whole(item) * self.velocities(item)[i])(self.completed(s, u, dependent))
        total = self.derivative(lambda s: whole(self.completed(s, u, dependent)), base, self.along(base, 1))
        for i in range(self.n):
            total += self.derivative(flux(i), base, self.along(base, 0, self.axis(i)))
        h = self.precision.h
        for k, place in enumerate(independent):
            ends = []
            for sign in (1, -1):
                shifted = [item + (sign * h if j == k else 0) for j, item in enumerate(u)]
                end = self.completed(base, shifted, dependent)
                ends.append(whole(end) * self.acceleration(end)[place])
            total += (ends[0] - ends[1]) / (2 * h)
        return total / whole(base)


def constant(text):
    return Names([]).compile(text)([])


# Intervals -------------------------------------------------------------------------------------------------------------

DOWN, UP = Context(prec=30, rounding=ROUND_FLOOR), Context(prec=30, rounding=ROUND_CEILING)
EVERYTHING = (Decimal("-Infinity"), Decimal("Infinity"))


def enclosure(tree, box):
    """An interval that contains the values of an expression over a box, which has an interval for each name."""
    kind = tree[0]
    if kind == "number":
        value = Decimal(tree[1])
        return value, value
    if kind == "name":
        if tree[1] == "pi":
            with localcontext(Context(prec=40)):
                pi = pi_of(40)
            return DOWN.plus(pi), UP.plus(pi)
        return box[tree[1]]
    if kind == "neg":
        low, high = enclosure(tree[1], box)
        return -high, -low
    if kind in "+-":
        (a, b), (c, d) = enclosure(tree[1], box), enclosure(tree[2], box)
        return (DOWN.add(a, c), UP.add(b, d)) if kind == "+" else (DOWN.subtract(a, d), UP.subtract(b, c))
    if kind == "*":
        return times(enclosure(tree[1], box), enclosure(tree[2], box))
    if kind == "/":
        return times(enclosure(tree[1], box), reciprocal(enclosure(tree[2], box)))
    if kind == "^":
        return raised(enclosure(tree[1], box), *rational(tree[2]))
    return called(tree[1], [enclosure(item, box) for item in tree[2]])


def times(x, y):
    zero = Decimal(0)
    product = lambda context, a, b: zero if a == 0 or b == 0 else context.multiply(a, b)
    pairs = [(a, b) for a in x for b in y]
    return min(product(DOWN, *item) for item in pairs), max(product(UP, *item) for item in pairs)


def reciprocal(x):
    low, high = x
    if low <= 0 <= high:
        return EVERYTHING
    return DOWN.divide(1, high), UP.divide(1, low)


def raised(x, numerator, denominator):
    if numerator < 0:
        return reciprocal(raised(x, -numerator, denominator))
    low, high = x
    if denominator == 2:
        if low < 0:
            return (Decimal(0), EVERYTHING[1]) if numerator == 1 else EVERYTHING
        x = DOWN.sqrt(low), UP.sqrt(high)
    elif denominator != 1:
        return EVERYTHING
    result, base = (Decimal(1), Decimal(1)), x
    if numerator % 2 == 0:
        low, high = base
        largest = max(abs(low), abs(high))
        smallest = Decimal(0) if low <= 0 <= high else min(abs(low), abs(high))
        base = (smallest, largest)
    for _ in range(numerator):
        result = times(result, base)
    return result


def called(name, arguments):
    low, high = arguments[0]
    wide = lambda a, b: (DOWN.subtract(a, abs(a) * Decimal("1e-25") + Decimal("1e-40")),
                         UP.add(b, abs(b) * Decimal("1e-25") + Decimal("1e-40")))
    if name in ("sin", "cos"):
        if not (low.is_finite() and high.is_finite()) or high - low >= 6:
            return Decimal(-1), Decimal(1)
        with localcontext(Context(prec=40)):
            f = sin if name == "sin" else cos
            ends = [f(low), f(high)]
            quarter = pi_of(40) / 2
            # Extremes lie at odd multiples of a quarter turn for the sine, at even ones for the cosine.
            first, last = int((low / quarter).to_integral_value(ROUND_FLOOR)), int((high / quarter).to_integral_value(ROUND_CEILING))
            for k in range(first, last + 1):
                if k % 2 == (1 if name == "sin" else 0):
                    at = k * quarter
                    if low - Decimal("1e-30") <= at <= high + Decimal("1e-30"):
                        ends.append(Decimal(1) if k % 4 == (1 if name == "sin" else 0) else Decimal(-1))
        low, high = wide(min(ends), max(ends))
        return max(low, Decimal(-1)), min(high, Decimal(1))
    if name == "abs":
        return raised((low, high), 2, 1) and (
            (Decimal(0) if low <= 0 <= high else min(abs(low), abs(high))), max(abs(low), abs(high)))
    if name == "sqrt":
        return raised((low, high), 1, 2)
    if name in ("exp", "sinh", "tanh", "atan") and low.is_finite() and high.is_finite():
        if high > 1000 and name != "atan":
            return EVERYTHING if name != "tanh" else (Decimal(-1), Decimal(1))
        with localcontext(Context(prec=40)):
            f = FUNCTIONS[name]
            return wide(f(low), f(high))
    if name == "exp":
        return Decimal(0), EVERYTHING[1]
    return EVERYTHING


def is_exponential(tree):
    """True if an expression is a product of exponentials, hyperbolic cosines and numbers, which is never 0."""
    kind = tree[0]
    if kind == "number":
        return Decimal(tree[1]) != 0
    if kind == "call":
        return tree[1] in ("exp", "cosh")
    return kind in ("neg", "*", "/", "^") and all(is_exponential(item) for item in tree[1:3] if kind != "^" or item is tree[1])


def excludes_zero(tree, box, depth):
    """True if an expression is proved to be nowhere 0 in a box. The longest side of a box is halved, at most `depth` times."""
    if is_exponential(tree):
        return True
    low, high = enclosure(tree, box)
    if low > 0 or high < 0:
        return True
    if depth == 0 or not box:
        return False
    name = max(box, key=lambda item: box[item][1] - box[item][0])
    low, high = box[name]
    if high == low:
        return False
    if high.is_infinite() and low.is_infinite():
        middle = Decimal(0)
    elif high.is_infinite():
        middle = 2 * abs(low) + 1
    elif low.is_infinite():
        middle = -2 * abs(high) - 1
    else:
        middle = (low + high) / 2
    return all(excludes_zero(tree, dict(box, **{name: half}), depth - 1) for half in ((low, middle), (middle, high)))


# Claims ----------------------------------------------------------------------------------------------------------------

def states(model, source, test, count=STATES, at=None):
    """Calls `test` at random states, with the values `at` if given, until it has answered `count` times. Returns the answers."""
    answers = []
    for _ in range(ATTEMPTS):
        try:
            state = model.random_state(source, dict(at or []))
            model.admit(state)
            answers.append(test(state))
        except (Unsuitable, InvalidOperation, DivisionByZero, Overflow, ZeroDivisionError):
            continue
        if len(answers) == count:
            return answers
    raise NotChecked("no state was found at which everything exists")


def is_small(value, size, digits=28):
    return abs(value) <= (abs(size) + 1) * Decimal(10) ** -digits


def check_conserved(model, claim, source):
    quantity, at = model.claimed(claim["value"]), claim.get("at")
    count = STATES if at is None else 1
    if claim["under"] is not None:
        surface = model.surfaces[claim["under"]]
        pairs = states(model, source, lambda state: across(model, surface, claim["value"], state), count, at)
        changes = [(after - before, before) for before, after in pairs]
    else:
        def rate(state):
            return model.derivative(quantity, state, model.direction_of_motion(state)), quantity(state)
        changes = states(model, source, rate, count, at)
    is_kept = all(is_small(change, size) for change, size in changes)
    return is_kept == claim["holds"], f"changes by {', '.join(f'{float(item):.1e}' for item, _ in changes)}"


def across(model, surface, text, state):
    """A quantity before and after an impact at a state near this one."""
    state, slope, rate = arrived(model, surface, state)
    entered, after = landed(model, surface, state, slope, rate)
    return model.claimed(text)(state), entered.claimed(text)(after)


def arrived(model, surface, state):
    """A state on the surface near this one that approaches it, with the gradient of the gap and its rate."""
    gap = model.names.compile(surface["gap"])
    gradient = lambda s: [model.derivative(gap, s, model.along(s, 0, model.axis(i))) for i in range(model.n)]
    state = model.at_zeros([*model.levels, gap], state)
    slope = gradient(state)
    state = model.on_constraints(state)
    if not counts(model, surface, state):
        raise Unsuitable("the surface does not count here")
    rate = rate_of(model, gap, slope, state)
    if rate >= 0 and (model.rates is None or surface["transition"] is not None):
        raise Unsuitable("the surface is not approached")
    return state, slope, rate


def rate_of(model, gap, slope, state):
    """The rate of a gap along the motion."""
    velocities = model.velocities(state) if model.rates is None else [item(state) for item in model.rates]
    return dot(slope, velocities) + model.derivative(gap, state, model.along(state, 1))


def counts(model, surface, state):
    """True if a surface counts at a state: its own conditions hold, and no list of conditions that excludes it does."""
    value = lambda text: model.names.compile(text)(state)
    is_excluded = any(all(value(item) >= 0 for item in others) for others in surface["excluded"])
    return all(value(item) > 0 for item in surface["when"]) and not is_excluded


def landed(model, surface, state, slope, rate):
    """The mode in which the motion continues, and its state after the impact."""
    transition = surface["transition"]
    if transition is not None:
        return passed(model, model.mode(transition["enters"]), transition, state, slope, rate)
    if surface["reset"] is not None:
        count = model.n if model.rates is not None else 2 * model.n
        after = [model.names.compile(item)(state) for item in surface["reset"][:count]]
        return model, [state[0], *after, *state[1 + count:]]
    if model.rates is not None:
        raise NotChecked("the law of a first-order system is a reset")
    return model, struck(model, surface, slope, rate, state)


def passed(model, entered, transition, state, slope, rate):
    """The mode behind a transition and its state: as declared, or by refraction or reflection and the constraints."""
    declared = transition["state"]
    if declared is not None:
        values = {name: [model.names.compile(item)(state) for item in declared[name]] for name in ("q", "qdot")}
        velocities = values["qdot"] or [Decimal(0)] * entered.n
        return entered, entered.state_of(model, state, values["q"], velocities)
    after = entered.state_of(model, state, model.positions(state), model.velocities(state))
    if model.rates is not None:
        return entered, after
    if not transition["keeps_lagrangian"]:
        bent = refracted(model, entered, state, slope, rate)
        if bent is None:
            elastic = {"law": "elastic", "coefficient": None}
            return model, struck(model, elastic, slope, rate, state)
        after = entered.with_velocities(after, bent)
    return entered, nearest(entered, after)


def nearest(model, state):
    """The state with the nearest velocity, in the metric, that satisfies the constraints."""
    m = len(model.constraints)
    if m == 0:
        return state
    g, forms = model.metric_at(state), model.forms_at(state)
    matrix = [[*row, *(forms[a][i] for a in range(m))] for i, row in enumerate(g)]
    matrix += [[*form, *([Decimal(0)] * m)] for form in forms]
    step = solve(matrix, [*([Decimal(0)] * model.n), *(-item for item in model.residuals_at(state))])
    return model.with_velocities(state, moved(model.velocities(state), step[:model.n], 1))


def refracted(model, entered, state, slope, rate):
    """The velocity behind the surface for the momentum `p + c pi_D^* dh` at which the energies differ by `-c d_t h`; None if no
    such `c` exists."""
    momentum, normal = model.momentum_at(state), projected_normal(model, slope, state)
    push = [dot(row, normal) for row in model.metric_at(state)]
    after = entered.state_of(model, state, model.positions(state), model.velocities(state))
    g, linear = entered.metric_at(after), [item(after) for item in entered.linear]
    moving = rate - dot(slope, model.velocities(state))

    def excess(c):
        """Excess of the energy behind the surface, a quadratic function of c, and the velocity there."""
        velocity = solve(g, [p + c * by - a for p, by, a in zip(momentum, push, linear)])
        energy = entered.energy_at(entered.with_velocities(after, velocity))
        return energy - model.energy_at(state) + c * moving, velocity
    start, up, down = (excess(Decimal(c))[0] for c in (0, 1, -1))
    square, slant = (up + down) / 2 - start, (up - down) / 2
    under = slant * slant - 4 * square * start
    if square <= 0:
        raise Unsuitable("a metric that is not positive")
    if under < 0:
        return None
    return excess((-slant - sqrt(under)) / (2 * square))[1]


def projected_normal(model, slope, state):
    """`pi_D grad h`"""
    g, forms, m = model.metric_at(state), model.forms_at(state), len(model.constraints)
    matrix = [[*row, *(-forms[a][i] for a in range(m))] for i, row in enumerate(g)]
    matrix += [[*form, *([Decimal(0)] * m)] for form in forms]
    return solve(matrix, [*slope, *([Decimal(0)] * m)])[:model.n]


def struck(model, surface, slope, rate, state):
    """The state after an impulse along the projected gradient of the gap, within the instantaneous constraints."""
    within, moving = model.within(surface), rate - dot(slope, model.velocities(state))
    if within is not model:
        state = nearest(within, state)
        rate = moving + dot(slope, model.velocities(state))
        if rate >= 0:
            return state
    normal = projected_normal(within, slope, state)
    steep = dot(slope, normal)
    e = Decimal(1) if surface["coefficient"] is None else model.names.compile(surface["coefficient"])(state)
    law, velocities = surface["law"], model.velocities(state)
    if law in ("elastic", "restitution"):
        # The impulse of an elastic impact changes the energy by its work on the surface, which moves at the rate -dh/dt.
        push = dot([dot(row, normal) for row in model.metric_at(state)], velocities)
        size = -(1 + e) * (push + moving) / steep
    elif law == "newton":
        size = -(1 + e) * rate / steep
    else:
        share = steep / dot(slope, solve(model.metric_at(state), slope))
        shares = {"nonholonomic_plastic": 2 * share, "impact_plastic": Decimal(1), "totally_plastic": share}
        if law not in shares:
            raise NotChecked(f"the law `{law}` is not checked")
        size = -shares[law] * rate / steep
    return model.with_velocities(state, moved(velocities, normal, size))


class Crossing:
    """The derivative of the flow through an impact, in the coordinates t, q and independent velocities of both sides."""

    def __init__(self, model, surface, state):
        self.surface = surface
        self.before, slope, self.rate = arrived(model, surface, state)
        if self.rate == 0:
            raise Unsuitable("a grazing impact")
        entered, self.after = landed(model, surface, self.before, slope, self.rate)
        self.models = (model, entered)
        ends = zip(self.models, (self.before, self.after))
        self.dependent = [[] if mode.rates else mode.dependent(item) for mode, item in ends]
        size = len(self.coordinates(self.before, 0))
        carried = [self.derivative(i) for i in range(size)]
        incoming, outgoing = self.motion(self.before, 0), self.motion(self.after, 1)
        # The saltation term replaces the image of the motion before the surface by the motion after it.
        image = [dot(column, incoming) for column in zip(*carried)]
        gap = model.names.compile(surface["gap"])
        self.columns = []
        for i, column in enumerate(carried):
            share = model.derivative(gap, self.before, self.direction(i)) / self.rate
            self.columns.append([item + (to - by) * share for item, to, by in zip(column, outgoing, image)])

    def independent(self, side):
        return [i for i in range(self.models[side].n) if i not in self.dependent[side]]

    def coordinates(self, state, side):
        model = self.models[side]
        velocities = [] if model.rates else [model.velocities(state)[i] for i in self.independent(side)]
        return [state[0], *model.positions(state), *velocities]

    def at(self, coordinates, side=0):
        """The state of a side with these coordinates."""
        model, start = self.models[side], (self.before, self.after)[side]
        state = [*coordinates[:1 + model.n], *start[1 + model.n:]]
        return state if model.rates else model.completed(state, coordinates[1 + model.n:], self.dependent[side])

    def direction(self, i, side=0):
        """The tangent of a coordinate."""
        h, start = self.models[0].precision.h, self.coordinates((self.before, self.after)[side], side)
        ends = [self.at([item + (sign * h if k == i else 0) for k, item in enumerate(start)], side) for sign in (1, -1)]
        return [(a - b) / (2 * h) for a, b in zip(*ends)]

    def derivative(self, i):
        """The derivative with respect to a coordinate of the map at the surface, whose formula is defined near the surface, too."""
        model, entered = self.models
        h, start, ends = model.precision.h, self.coordinates(self.before, 0), []
        gap = model.names.compile(self.surface["gap"])
        for sign in (1, -1):
            state = self.at([item + (sign * h if k == i else 0) for k, item in enumerate(start)])
            slope = [model.derivative(gap, state, model.along(state, 0, model.axis(k))) for k in range(model.n)]
            mode, after = landed(model, self.surface, state, slope, rate_of(model, gap, slope, state))
            if mode is not entered:
                raise Unsuitable("a motion between refraction and reflection")
            ends.append(self.coordinates(after, 1))
        return [(a - b) / (2 * h) for a, b in zip(*ends)]

    def motion(self, state, side):
        model = self.models[side]
        if model.rates:
            return [Decimal(1), *(item(state) for item in model.rates)]
        acceleration = model.acceleration(state)
        return [Decimal(1), *model.velocities(state), *(acceleration[i] for i in self.independent(side))]

    def factor(self, densities):
        """The factor of the volume; 0 if a first-order motion slides: the gap rates on both sides differ in sign, and a transition leads back."""
        ends = list(zip(self.models, (self.before, self.after), self.dependent))
        weights = [Decimal(1) if mode.rates else mode.weight(state, dependent) for mode, state, dependent in ends]
        values = [density(state) * weight for density, (_, state, _), weight in zip(densities, ends, weights)]
        jacobian = determinant([item[1:] for item in self.columns[1:]])
        transition = self.surface["transition"]
        may_slide = self.models[0].rates and transition is not None and transition["state"] is None
        if may_slide and jacobian < 0 and self.comes_back():
            return Decimal(0)
        return abs(jacobian * values[1] / values[0])

    def comes_back(self):
        """True if a transition of the mode that is entered acts where it is entered."""
        entered = self.models[1]
        gaps = (entered.names.compile(item["gap"]) for item in entered.surfaces if item["transition"] is not None)
        return any(abs(gap(self.after)) < entered.precision.h for gap in gaps)

    def form_defects(self):
        """The change of `dp dq - dH dt`, without constraints."""
        before, after = (self.form(item, side) for side, item in enumerate((self.before, self.after)))
        size, columns = len(self.columns), self.columns
        inner = range(len(after))
        value = lambda a, b: sum((a[i] * b[j] * after[i][j] for i in inner for j in inner), Decimal(0))
        return [value(columns[i], columns[j]) - before[i][j] for i in range(size) for j in range(i)]

    def form(self, state, side):
        model = self.models[side]
        size = 1 + 2 * model.n
        axes = [[Decimal(int(k == i)) for k in range(len(state))] for i in range(size)]
        momenta = [model.derivative(model.momentum_at, state, item) for item in axes]
        energies = [model.derivative(model.energy_at, state, item) for item in axes]

        def entry(i, j):
            place = lambda item, k: Decimal(int(item == 1 + k))
            pairs = [momenta[i][k] * place(j, k) - momenta[j][k] * place(i, k) for k in range(model.n)]
            return sum(pairs, Decimal(0)) - energies[i] * int(j == 0) + energies[j] * int(i == 0)
        return [[entry(i, j) for j in range(size)] for i in range(size)]


def density_of(model, text):
    """The density that a text states; 1 without a text."""
    return (lambda state: Decimal(1)) if text is None else model.claimed(text)


def densities_of(model, surface, density):
    """The densities before and after. Behind a transition, the claims of the entered mode state it; 1 if they state none."""
    if surface["transition"] is None:
        return density, density
    entered = model.mode(surface["transition"]["enters"])
    return density, density_of(entered, entered.density)


def check_factor(model, claim, source):
    surface = model.surfaces[claim["under"]]
    stated = model.claimed(claim["value"])
    densities = densities_of(model, surface, density_of(model, model.density))
    if surface["instantaneous"]:
        return constrained_to_less(model, surface, stated, source)

    def change(state):
        crossing = Crossing(model, surface, state)
        return crossing.factor(densities) - stated(crossing.before)
    found = states(model, source, change)
    return all(is_small(item, 1, 20) for item in found), f"differs by {', '.join(f'{float(item):.1e}' for item in found)}"


def constrained_to_less(model, surface, stated, source):
    """True if the stated factor is 0, and the constraints of the motion do not imply the instantaneous ones. These then map volumes
    to 0."""
    def ranks(state):
        forms, m = model.forms_at(state), len(model.constraints)
        extra = [[model.names.compile(item)(state) for item in entry["form"]] for entry in surface["instantaneous"]]
        return len(eliminated([*forms, *extra], model.n)[1]) - m, stated(state)
    found = states(model, source, ranks)
    return all(rank > 0 and factor == 0 for rank, factor in found), "instantaneous constraints map all states on a line to the same state"


def check_kept(model, claim, source):
    """The motion, all impacts and all transitions keep one volume."""
    closed = claim.get("density")
    density = density_of(model, model.density) if closed is None else closed_density(model, closed)
    holds, text = balanced(model, source, density)
    for surface in (model.surfaces[index] for index in model.acting):
        densities = densities_of(model, surface, density)
        found = states(model, source, lambda state: Crossing(model, surface, state).factor(densities) - 1)
        holds = holds and all(is_small(item, 1, 20) for item in found)
    return holds, text


def check_symplectic(model, claim, source):
    """The forces are closed, and the motion through each surface keeps `dp dq - dH dt`. With constraints, the motion keeps `dp dq`
    as a form on all their states, or on the leaves if they are integrable."""
    if model.rates is not None:
        raise NotChecked("the symplectic form belongs to mechanical systems")
    entered = [model.mode(item["transition"]["enters"]) for item in model.surfaces if item["transition"] is not None]
    if model.constraints or any(mode.constraints for mode in entered):
        holds, text = kept_form(model, symplectic_terms, source)
        if not holds and model.constraints and are_integrable(model, source):
            return kept_form(model, symplectic_terms, source, True)
        return holds, text
    total = lambda state: [sum((item[i](state) for item in model.forces), Decimal(0)) for i in range(model.n)]

    def defects(state):
        slopes = [model.derivative(total, state, model.along(state, 0, model.axis(i))) for i in range(model.n)]
        found = [slopes[i][j] - slopes[j][i] for i in range(model.n) for j in range(i)]
        by_velocity = [model.derivative(total, state, model.along(state, 0, None, model.axis(i))) for i in range(model.n)]
        return found + [item for row in by_velocity for item in row] + [Decimal(0)]
    found = [item for state in states(model, source, defects) for item in state]
    for surface in (model.surfaces[index] for index in model.acting):
        crossings = states(model, source, lambda state: Crossing(model, surface, state).form_defects(), 2)
        found += [item for defects in crossings for item in defects]
    return all(is_small(item, 1, 20) for item in found), f"largest defect {float(max(map(abs, found))):.1e}"


class Chart:
    """Coordinates near a state: the time, the positions, the independent velocities."""

    def __init__(self, model, state, dependent=None):
        self.model, self.state = model, state
        self.dependent = dependent
        if dependent is None:
            self.dependent = [] if model.rates else model.dependent(state)
        self.independent = [] if model.rates else [i for i in range(model.n) if i not in self.dependent]
        self.size = 1 + model.n + len(self.independent)

    def coordinates(self):
        velocities = self.model.velocities(self.state)
        return [self.state[0], *self.model.positions(self.state), *(velocities[i] for i in self.independent)]

    def at(self, z):
        n = self.model.n
        state = [*z[:1 + n], *self.state[1 + n:]]
        if self.model.rates:
            return self.model.with_velocities(state, [item(state) for item in self.model.rates])
        return self.model.completed(state, z[1 + n:], self.dependent)

    def along(self, z, vector):
        """The tangent vector of states that has these components in the chart."""
        h = self.model.precision.h
        ends = [self.at(moved(z, vector, sign * h)) for sign in (1, -1)]
        return [(a - b) / (2 * h) for a, b in zip(*ends)]

    def motion(self, z):
        state = self.at(z)
        accelerations = [] if self.model.rates else self.model.acceleration(state)
        return [Decimal(1), *self.model.velocities(state), *(accelerations[i] for i in self.independent)]

    def form(self, terms, z, vectors):
        """The sum of `c det(df_i(v_j))`."""
        state, directions = self.at(z), [self.along(z, item) for item in vectors]
        total = Decimal(0)
        for coefficient, functions in terms:
            rows = [[self.model.derivative(item, state, by) for by in directions] for item in functions]
            total += coefficient(state) * determinant(rows)
        return total


def symplectic_terms(model):
    """`dp dq` of a mode."""
    return [(lambda state: Decimal(1), [model.claimed(f"momentum({name})"), model.claimed(name)]) for name in model.q]


def are_integrable(model, source):
    """True if the exterior derivatives of the forms `eta + eta_0 dt` vanish on all pairs of fields in their kernel (Frobenius)."""
    if model.is_nonlinear:
        return False

    def curls(state):
        n, rows, fields = model.n, range(len(model.constraints)), []
        whole = lambda s: [item for form, rest in model.constraints for item in (*(part(s) for part in form), rest(s))]
        axes = [model.along(state, 0, model.axis(i)) for i in range(n)] + [model.along(state, 1)]
        slopes = [model.derivative(whole, state, axis) for axis in axes]
        dependent, forms = model.dependent(state), model.forms_at(state)
        minor = [[form[j] for j in dependent] for form in forms]
        for place in (i for i in range(n) if i not in dependent):
            field = [Decimal(int(i == place)) for i in range(n)] + [Decimal(0)]
            for j, value in zip(dependent, solve(minor, [-form[place] for form in forms])):
                field[j] = value
            fields.append(field)
        fields.append([*model.velocities(state), Decimal(1)])
        curl = lambda a, i, j: slopes[i][a * (n + 1) + j] - slopes[j][a * (n + 1) + i]
        pairs = [(x, y) for k, x in enumerate(fields) for y in fields[:k]]
        size = range(n + 1)
        return [sum(curl(a, i, j) * x[i] * y[j] for i in size for j in size) for a in rows for x, y in pairs] or [Decimal(0)]
    return all(is_small(item, 1, 20) for row in states(model, source, curls) for item in row)


def check_form(model, claim, source):
    """The form is constant on vectors that the motion carries along, between surfaces and through each of them."""
    def terms_of(mode):
        return [(mode.claimed(item["coefficient"]), [mode.claimed(f) for f in item["differentials"]]) for item in claim["terms"]]
    return kept_form(model, terms_of, source, model.has_only_positions)


def along_leaves(chart, vectors):
    """The vectors of a chart with the dependent positions changed so that all constraint forms vanish on them."""
    if not chart.dependent:
        return vectors
    forms, found = chart.model.forms_at(chart.state), []
    minor = [[form[j] for j in chart.dependent] for form in forms]
    for vector in vectors:
        vector = list(vector)
        for j in chart.dependent:
            vector[1 + j] = Decimal(0)
        for j, value in zip(chart.dependent, solve(minor, [-dot(form, vector[1:1 + chart.model.n]) for form in forms])):
            vector[1 + j] = value
        found.append(vector)
    return found


def kept_form(model, terms_of, source, is_along_leaves=False, assumed=()):
    """The form of a mode is constant on vectors that the motion carries along, on all vectors or on those tangent to the leaves of
    the constraints. Modes in `assumed` are being examined; they are taken to keep the form on all their states."""
    terms = terms_of(model)
    degree = len(terms[0][1])
    on_leaves = {}

    def vectors(chart):
        given = [[Decimal(0), *(model.number(source, Decimal(-1), Decimal(1)) for _ in range(chart.size - 1))] for _ in range(degree)]
        return along_leaves(chart, given) if is_along_leaves else given

    def rate(state):
        chart = Chart(model, state)
        z, given, h, ends = chart.coordinates(), vectors(chart), model.precision.h, []
        drift = chart.motion(z)
        spread = [model.derivative(chart.motion, z, item) for item in given]
        for step in (h, -h):
            carried = [moved(item, by, step) for item, by in zip(given, spread)]
            ends.append(chart.form(terms, moved(z, drift, step), carried))
        return (ends[0] - ends[1]) / (2 * h)

    def needs_leaves(entered):
        """True if a mode, with its surfaces and the modes behind them, keeps the form only on the leaves of its constraints."""
        if entered is model:
            return is_along_leaves
        if terms_of is not symplectic_terms or not entered.constraints or entered in assumed:
            return False
        if entered not in on_leaves:
            keeps_all = lambda: kept_form(entered, terms_of, source, assumed=(*assumed, entered))[0]
            on_leaves[entered] = are_integrable(entered, source) and not keeps_all()
        return on_leaves[entered]

    def change(surface):
        def of(state):
            crossing = Crossing(model, surface, state)
            entered = crossing.models[1]
            before, after = (Chart(*item) for item in zip(crossing.models, (crossing.before, crossing.after), crossing.dependent))
            given = vectors(before)
            carried = [[dot(item, row) for row in zip(*crossing.columns)] for item in given]
            start = before.form(terms, before.coordinates(), given)
            found = [after.form(terms_of(entered), after.coordinates(), carried) - start]
            if needs_leaves(entered):
                forms = entered.forms_at(crossing.after)
                found += [dot(form, vector[1:1 + entered.n]) for form in forms for vector in carried]
            return found
        return of
    if model.is_nonlinear and model.acting:
        raise NotChecked("resets beside constraints that are not linear are not checked")
    found = states(model, source, rate)
    for surface in (model.surfaces[index] for index in model.acting):
        found += [item for row in states(model, source, change(surface), 2) for item in row]
    return all(is_small(item, 1, 18) for item in found), f"largest change {float(max(map(abs, found))):.1e}"


def check_energy(model, claim, source):
    surface = model.surfaces[claim["under"]]
    pairs = states(model, source, lambda state: across(model, surface, "energy", state))
    gains = [after - before for before, after in pairs]
    return all(item <= 0 or is_small(item, 1) for item in gains), f"gains {', '.join(f'{float(item):.1e}' for item in gains)}"


def check_density(model, claim, source):
    stated = model.claimed(claim["value"])
    return balanced(model, source, lambda state: stated(state))


def balanced(model, source, density):
    """Liouville's equation at random states."""
    if model.is_nonlinear:
        raise NotChecked("densities belong to systems with linear constraints")
    if model.rates is not None:
        def flux(i):
            return lambda state: density(state) * model.rates[i](state)

        def spread(state):
            total = model.derivative(density, state, model.along(state, 1))
            for i in range(model.n):
                total += model.derivative(flux(i), state, model.along(state, 0, model.axis(i)))
            return total / density(state)
        found = states(model, source, spread)
        return all(is_small(item, 1) for item in found), f"defects {', '.join(f'{float(item):.1e}' for item in found)}"

    def defect(state):
        dependent = model.dependent(state)
        u = [item for i, item in enumerate(model.velocities(state)) if i not in dependent]
        return model.divergence(state, u, dependent, density)
    defects = states(model, source, defect)
    return all(is_small(item, 1) for item in defects), f"defects {', '.join(f'{float(item):.1e}' for item in defects)}"


def closed_density(model, closed):
    """A density in closed form."""
    terms = [(model.names.compile(item["coefficient"]), item) for item in closed["terms"]]

    def density(state):
        total = Decimal(0)
        for coefficient, item in terms:
            total += coefficient(state) * summand(item, state)
        return exp(total)

    def summand(item, state):
        kind = item["kind"]
        if kind == "plain":
            return model.names.compile(item["of"])(state)
        if kind == "logarithm":
            return ln(abs(model.names.compile(item["of"])(state)))
        if kind == "metric_determinant":
            return ln(abs(determinant(model.metric_at(state))))
        forms = model.forms_at(state)
        if kind == "dependent_determinant":
            return ln(abs(determinant([[form[j] for j in closed["dependent"]] for form in forms])))
        g = model.metric_at(state)
        raised_forms = [solve(g, form) for form in forms]
        return ln(abs(determinant([[dot(a, b) for b in raised_forms] for a in forms])))
    return density


def check_exact(model, claim, source):
    closed = claim.get("density")
    if closed is None:
        holds, text = check_hull(model, source, exists=True)
        # Locally, a function has the prescribed derivatives. Its existence on all of Q is not checked.
        is_local = claim["kind"] == "locally_exact"
        return (holds if is_local or not holds else PARTLY), f"{text}; no closed form, periods are not checked"
    density = closed_density(model, closed)
    holds, text = balanced(model, source, density)
    if claim["kind"] == "exact":
        logarithms = [item["of"] for item in closed["terms"] if item["kind"] == "logarithm"]
        open_ones = [item for item in logarithms if not is_regular(model, item)]
        if open_ones:
            return False, f"0 could not be excluded for {', '.join(open_ones)} at the declared parameters"
        if not is_single_valued(model, density, source):
            return False, "the density is not periodic in an angle"
    return holds, text


def is_regular(model, text):
    """True if the function is proved to be nowhere 0, for the declared values of the parameters that have one."""
    box = {}
    for item in model.coordinates:
        low, high = EVERYTHING
        if item["kind"] == "angle":
            low, high = Decimal("-3.2"), Decimal("3.2")
        if item["kind"] == "interval":
            low, high = constant(item["low"]), constant(item["high"])
        box[item["name"]] = (low, high)
    for item in model.parameters:
        if item["default"] is not None:
            value = constant(item["default"])
            box[item["name"]] = (value, value)
        elif isinstance(item["assumption"], list):
            box[item["name"]] = tuple(constant(end) for end in item["assumption"])
        else:
            box[item["name"]] = (Decimal("1e-6"), EVERYTHING[1]) if item["assumption"] == "positive" else EVERYTHING
    tree = Parser(text).whole()
    used = set(re.findall(r"[^\W\d]\w*(?:\.\d+)*", text))
    box = {name: item for name, item in box.items() if name in used}
    box["t"] = EVERYTHING
    return excludes_zero(tree, {name: item for name, item in box.items() if name in used}, 14)


def is_single_valued(model, density, source):
    def ratios(state):
        turn, found = 2 * pi_of(model.precision.digits), []
        for i, item in enumerate(model.coordinates):
            if item["kind"] == "angle":
                found.append(density(moved(state, model.along(state, 0, model.axis(i)), turn)) / density(state) - 1)
        return found
    return all(is_small(item, 1) for found in states(model, source, ratios, 1) for item in found)


def check_hull(model, source, exists, at=None):
    """Compares the rank of the brackets of the fields of D with their rank together with the derivatives of ln(density) that they
    prescribe. Equal ranks show that a density exists locally. True if this agrees with `exists`."""
    if model.rates is not None or model.is_nonlinear:
        raise NotChecked("densities belong to mechanical systems with linear constraints")
    bends = states(model, source, lambda state: bend(model, state), 1, at)[0]
    if not is_small(bends, 1):
        return not exists, f"three states in a row have divergences whose second difference is {float(bends):.1e}"
    model.precision = NESTED
    with localcontext(Context(prec=NESTED.digits)):
        ranks = states(model, source, lambda state: hull_ranks(model, state), 1, at)[0]
    model.precision = SIMPLE
    return (ranks[0] == ranks[1]) == exists, f"brackets have rank {ranks[0]}, with their demands {ranks[1]}"


def bend(model, state):
    """The second difference of the divergence along a line of independent velocities: 0 if the divergence is affine in them."""
    dependent = model.dependent(state)
    u = [item for i, item in enumerate(model.velocities(state)) if i not in dependent]
    step = [Decimal(i + 1) * (-1) ** i for i in range(len(u))]
    rates = [model.divergence(state, moved(u, step, k), dependent, lambda item: Decimal(1)) for k in range(3)]
    return rates[0] - 2 * rates[1] + rates[2]


def hull_ranks(model, state):
    dependent = model.dependent(state)
    count = model.n - len(dependent)
    zero = [Decimal(0)] * count
    one = lambda item: Decimal(1)

    def demand(s, u):
        return -model.divergence(s, u, dependent, one)

    def drift(s):
        return [Decimal(1), *model.velocities(model.completed(s, zero, dependent)), demand(s, zero)]

    def generator(k):
        u = [Decimal(int(j == k)) for j in range(count)]

        def field(s):
            base = drift(s)
            ends = [*model.velocities(model.completed(s, u, dependent)), demand(s, u)]
            return [Decimal(0), *(item - other for item, other in zip(ends, base[1:]))]
        return field
    start = drift(state)
    generators = [generator(k) for k in range(count)]
    with_time = model.along(state, 1)
    changes = [sum(abs(item) for item in model.derivative(field, state, with_time)) for field in [drift, *generators]]
    depends_on_time = not all(is_small(change, 1, 20) for change in changes)
    if depends_on_time or not is_small(sum(abs(item) for item in start[1:]), 0, 20):
        generators.append(drift if depends_on_time else (lambda s: [Decimal(0), *drift(s)[1:]]))

    def bracket(x, y):
        def field(s):
            a, b = x(s), y(s)
            into = lambda item: model.along(s, item[0], item[1:1 + model.n])
            forth, back = model.derivative(y, s, into(a)), model.derivative(x, s, into(b))
            return [p - q for p, q in zip(forth, back)]
        return field
    elements, newest = [item(state) for item in generators], generators
    ranks = both_ranks(elements)
    while newest:
        found = []
        for x in generators:
            for y in newest:
                if x is y:
                    continue
                item = bracket(x, y)
                value = item(state)
                after = both_ranks([*elements, value])
                if after != ranks:
                    elements.append(value)
                    ranks = after
                    found.append(item)
                if ranks[1] > ranks[0]:
                    return ranks
        newest = found
    return ranks


def both_ranks(elements):
    width = len(elements[0])
    rank = lambda columns: len(eliminated([item[:columns] for item in elements], columns)[1])
    return rank(width - 1), rank(width)


def check_symmetry(model, claim, source):
    field = [model.names.compile(item) for item in claim["field"]]
    at = lambda state: [item(state) for item in field]
    if model.rates is not None:
        motion = lambda state: [item(state) for item in model.rates]

        def commutator(state):
            of_motion = model.derivative(motion, state, model.along(state, 0, at(state)))
            of_field = model.derivative(at, state, model.along(state, 1, motion(state)))
            return [item - other for item, other in zip(of_motion, of_field)]
        found = [item for state in states(model, source, commutator) for item in state]
        return all(is_small(item, 1, 20) for item in found), f"largest defect {float(max(map(abs, found))):.1e}"

    def change(state):
        """The derivative of L along the flow, lifted to velocities."""
        spread = model.derivative(at, state, model.along(state, 0, model.velocities(state)))
        return model.derivative(model.lagrangian_at, state, model.along(state, 0, at(state), spread))

    def gauge_at(state):
        """Coefficients of the velocities in the change of L. The change must be affine in them, with closed coefficients."""
        rest = change(model.with_velocities(state, [Decimal(0)] * model.n))
        return [change(model.with_velocities(state, model.axis(i))) - rest for i in range(model.n)]

    def lagrangian_defects(state):
        linear = gauge_at(state)
        found = [change(state) - dot(linear, model.velocities(state)) - change(
            model.with_velocities(state, [Decimal(0)] * model.n))]
        slopes = [model.derivative(gauge_at, state, model.along(state, 0, model.axis(i))) for i in range(model.n)]
        return found + [slopes[i][j] - slopes[j][i] for i in range(model.n) for j in range(i)]

    def defects(state):
        # Under position equations alone, L may change at positions and velocities that break them.
        is_kept = model.has_only_positions and is_small(change(state), 1, 20)
        found = [] if is_kept else lagrangian_defects(state)
        found += [model.derivative(level, state, model.along(state, 0, at(state))) for level in model.levels]
        forms, m = model.forms_at(state), len(model.constraints)
        if not m:
            return found
        spreads = [model.derivative(at, state, model.along(state, 0, model.axis(i))) for i in range(model.n)]
        along = model.along(state, 0, at(state))
        for a in range(m):
            row = lambda s: [*(item(s) for item in model.constraints[a][0]), model.constraints[a][1](s)]
            turned = model.derivative(row, state, along)
            turned = [turned[i] + dot(forms[a], spreads[i]) for i in range(model.n)] + turned[model.n:]
            rows = [[*form, item] for form, item in zip(forms, model.affine_at(state))]
            whole = eliminated([*rows, turned], model.n + 1)[1]
            found.append(Decimal(len(whole) - m))
        return found
    found = [item for state in states(model, source, defects) for item in state]
    return all(is_small(item, 1, 20) for item in found), f"largest defect {float(max(map(abs, found))):.1e}"


def on_d(model, state):
    """The state in D as a function of positions and momenta: the momenta are projected onto D along the constraint forces."""
    n = model.n

    def velocity(z):
        base = [state[0], *z[:n], *state[1 + n:]]
        g, forms = model.metric_at(base), model.forms_at(base)
        v = solve(g, [p - linear(base) for p, linear in zip(z[n:], model.linear)])
        duals = [solve(g, form) for form in forms]
        mass = [[dot(form, dual) for dual in duals] for form in forms]
        lost = [dot(form, v) + affine for form, affine in zip(forms, model.affine_at(base))]
        for factor, dual in zip(solve(mass, lost), duals):
            v = moved(v, dual, -factor)
        return model.with_velocities(base, v)
    return velocity


def bracket(model, f, g, state):
    """`f_q g_p - f_p g_q` of functions of positions and momenta."""
    n, onto = model.n, on_d(model, state)
    z = [*model.positions(state), *model.momentum_at(state)]

    def slope(function, i):
        axis = [Decimal(int(k == i)) for k in range(2 * n)]
        return model.derivative(lambda place: function(onto(place)), z, axis)
    slopes = [[slope(function, i) for i in range(2 * n)] for function in (f, g)]
    return dot(slopes[0][:n], slopes[1][n:]) - dot(slopes[0][n:], slopes[1][:n])


def check_involution(model, claim, source):
    if model.is_nonlinear:
        raise NotChecked("brackets belong to systems with linear constraints")
    functions = [model.claimed(value) for value in claim["values"]]
    pairs = [(f, g) for j, g in enumerate(functions) for f in functions[:j]]
    found = states(model, source, lambda state: [bracket(model, *pair, state) for pair in pairs])
    found = [value for row in found for value in row] or [Decimal(0)]
    return all(is_small(value, 1) for value in found), f"largest bracket {float(max(map(abs, found))):.1e}"


def check_integrable(model, claim, source):
    if len(claim["values"]) != model.n - len(model.constraints):
        return False, "not as many functions as degrees of freedom"
    for value in claim["values"]:
        for under in (None, *model.acting):
            holds, text = check_conserved(model, {"value": value, "under": under, "holds": True}, source)
            if not holds:
                return False, f"{value} {text}"
    functions = [model.claimed(value) for value in claim["values"]]

    def rank(state):
        chart = Chart(model, state)
        z, rows = chart.coordinates(), []
        for function in functions:
            axes = [[Decimal(int(k == i)) for k in range(chart.size)] for i in range(1, chart.size)]
            axes = along_leaves(chart, axes) if model.has_only_positions else axes
            rows.append([model.derivative(lambda at: function(chart.at(at)), z, axis) for axis in axes])
        return len(eliminated(rows, chart.size - 1)[1])
    if min(states(model, source, rank)) < len(functions):
        return False, "the differentials are dependent"
    return check_involution(model, claim, source)


CHECKS = {
    "conserved": check_conserved,
    "density": check_density,
    "exact": check_exact,
    "locally_exact": check_exact,
    "no_density": lambda model, claim, source: check_hull(model, source, False, claim.get("at")),
    "symmetry": check_symmetry,
    "volume_kept": check_kept,
    "factor": check_factor,
    "symplectic": check_symplectic,
    "invariant_form": check_form,
    "energy_not_increasing": check_energy,
    "involution": check_involution,
    "integrable": check_integrable,
}


def is_prime(n):
    """Miller and Rabin, with bases that decide below 3e24."""
    if n < 2:
        return False
    odd, twos = n - 1, 0
    while odd % 2 == 0:
        odd, twos = odd // 2, twos + 1
    for base in (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41):
        if n % base == 0:
            return n == base
        x = pow(base, odd, n)
        if x not in (1, n - 1) and all((x := x * x % n) != n - 1 for _ in range(twos - 1)):
            return False
    return True


def judged(model, claim, source):
    """The verdict on a claim, and its reason."""
    if claim["verdict"] != "proved":
        return "open", claim["verdict"]
    if not all(is_prime(item) and item > 2 ** 60 for item in claim["primes"]):
        return "FAILED", "a modulus is no prime of 61 bits"
    if claim["points"] > 0 and not claim["chance_of_error"] < 1e-12:
        return "FAILED", "the chance of error is not small"
    try:
        with localcontext(Context(prec=SIMPLE.digits)):
            holds, text = CHECKS[claim["kind"]](model, claim, source)
    except NotChecked as reason:
        return "unchecked", str(reason)
    finally:
        model.precision = SIMPLE
    return {True: "holds", False: "FAILED", PARTLY: "partly"}[holds], text


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", metavar="FILE")
    parser.add_argument("--seed", type=int, default=1, help="of the random states (default 1)")
    options = parser.parse_args(arguments)
    tally = {}
    for path in options.files:
        try:
            with open(path, encoding="utf-8") as file:
                document = json.load(file)
            if document["format"] != FORMAT:
                raise ValueError(f"its format is {document['format']!r}, expected {FORMAT!r}")
            parts = [(item["name"], item["content"], Model(item["content"])) for item in document["parts"]]
            modes = {name: model for name, _, model in parts}
            for _, _, model in parts:
                model.parts = modes
        except (OSError, ValueError, KeyError, TypeError) as error:
            print(f"{path}: {error}", file=sys.stderr)
            return 2
        for name, content, model in parts:
            for claim in content["claims"]:
                word, why = judged(model, claim, random.Random(f"{options.seed} {name} {claim['claim']}"))
                tally[word] = tally.get(word, 0) + 1
                print(f"{word:10} {name}: {claim['claim']} ({why})", flush=True)
    print(", ".join(f"{count} {word}" for word, count in sorted(tally.items())) or "no claims")
    return 1 if tally.get("FAILED") else 0


if __name__ == "__main__":
    sys.exit(main())
