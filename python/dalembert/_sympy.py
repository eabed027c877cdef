"""Declarations in SymPy."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Mapping, Sequence

import sympy
from sympy import Expr, Function, Symbol

#: The time.
T = Symbol("t", real=True)

#: Functions of the language that have another name in SymPy, or none.
FUNCTIONS = {"ln": sympy.log, "log1p": lambda x: sympy.log(1 + x), "abs": sympy.Abs}

_TOKEN = re.compile(r"\s*(?:(\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)|([^\W\d]\w*(?:\.\d+)*)|(.))")
_ASSUMPTIONS = {"positive": {"positive": True}, "nonnegative": {"nonnegative": True}, "nonzero": {"real": True, "nonzero": True}}


class Scope:
    """Names of a declaration, as objects of SymPy.

    Coordinates are functions of the time, velocities their derivatives, parameters symbols with their assumptions. The index of a
    member of a family is written after an underscore: ``theta_3``.
    """

    def __init__(self, declaration: Mapping[str, Any]) -> None:
        self.q = {item["name"]: Function(_plain(item["name"]), real=True)(T) for item in declaration["coordinates"]}
        self.qdot = {name: function.diff(T) for name, function in self.q.items()}
        self.parameters = {item["name"]: _symbol(item) for item in declaration["parameters"]}

    def read(self, text: str) -> Expr:
        """The expression of a text of the language."""
        if "..." in text:
            raise ValueError("the expression is too long to be written out")
        return _Parser(text, self).whole()


def _plain(name: str) -> str:
    return name.replace(".", "_")


def _symbol(parameter: Mapping[str, Any]) -> Symbol:
    assumption = parameter["assumption"]
    known = _ASSUMPTIONS.get(assumption, {}) if isinstance(assumption, str) else {}
    return Symbol(_plain(parameter["name"]), **(known or {"real": True}))


class _Parser:
    """Reads an expression: sums of products of powers, from left to right; `^` binds tighter than a sign before it."""

    def __init__(self, text: str, scope: Scope) -> None:
        self.tokens = [match.groups() for match in _TOKEN.finditer(text) if match.group().strip()]
        self.place = 0
        self.text = text
        self.scope = scope

    def peek(self) -> Sequence[str | None]:
        return self.tokens[self.place] if self.place < len(self.tokens) else (None, None, None)

    def eat(self, sign: str) -> bool:
        found = self.peek()[2] == sign
        self.place += found
        return found

    def expect(self, sign: str) -> None:
        if not self.eat(sign):
            raise ValueError(f"expected `{sign}` in `{self.text}`")

    def whole(self) -> Expr:
        value = self.sum()
        if self.place != len(self.tokens):
            raise ValueError(f"cannot read `{self.text}`")
        return value

    def sum(self) -> Expr:
        terms = [self.product()]
        while True:
            if self.eat("+"):
                terms.append(self.product())
            elif self.eat("-"):
                terms.append(-self.product())
            else:
                return sympy.Add(*terms)

    def product(self) -> Expr:
        factors = [self.unary()]
        while True:
            if self.eat("*"):
                factors.append(self.unary())
            elif self.eat("/"):
                factors.append(1 / self.unary())
            else:
                return sympy.Mul(*factors)

    def unary(self) -> Expr:
        return -self.unary() if self.eat("-") else self.power()

    def power(self) -> Expr:
        base = self.atom()
        return base ** self.unary() if self.eat("^") else base

    def atom(self) -> Expr:
        number, name, _ = self.peek()
        self.place += number is not None or name is not None
        if number is not None:
            return sympy.Rational(number)
        if name == "dot":
            return self.velocity()
        if name is not None and self.peek()[2] == "(":
            return self.call(name)
        if name is not None:
            return self.named(name)
        self.expect("(")
        value = self.sum()
        self.expect(")")
        return value

    def velocity(self) -> Expr:
        self.expect("(")
        name = self.peek()[1]
        self.place += 1
        self.expect(")")
        return self.scope.qdot[name]

    def call(self, name: str) -> Expr:
        self.expect("(")
        arguments = [self.sum()]
        while self.eat(","):
            arguments.append(self.sum())
        self.expect(")")
        return FUNCTIONS.get(name, getattr(sympy, name, None))(*arguments)

    def named(self, name: str) -> Expr:
        known = {"t": T, "pi": sympy.pi, **self.scope.q, **self.scope.parameters}
        if name not in known:
            raise ValueError(f"unknown name `{name}` in `{self.text}`")
        return known[name]


@dataclass(frozen=True)
class Symbolic:
    """A declaration in SymPy.

    Attributes
    ----------
    t : Symbol
        The time.
    q, qdot : dict of str to Expr
        Functions of the time and their derivatives, by the name of the coordinate.
    parameters : dict of str to Symbol
        Parameters and inputs, with the declared signs.
    lagrangian : Expr or None
        The Lagrangian; None for a first-order system.
    rates : dict of str to Expr
        The field of a first-order system; else empty.
    forces : dict of str to Expr
        The sum of all forces, by coordinate.
    constraints : dict of str to Expr
        Functions of positions and velocities that vanish along the motion.
    constraint_forms : dict of str to tuple of Expr
        Their derivatives with respect to the velocities: directions of the constraint forces.
    surfaces : dict of str to Expr
        Gaps, positive where motion is allowed.
    """

    t: Symbol
    q: Mapping[str, Expr]
    qdot: Mapping[str, Expr]
    parameters: Mapping[str, Symbol]
    lagrangian: Expr | None
    rates: Mapping[str, Expr]
    forces: Mapping[str, Expr]
    constraints: Mapping[str, Expr]
    constraint_forms: Mapping[str, tuple[Expr, ...]]
    surfaces: Mapping[str, Expr]

    @classmethod
    def of(cls, declaration: Mapping[str, Any]) -> Symbolic:
        """The SymPy form of the declaration of a derivation."""
        scope = Scope(declaration)
        read, motion = scope.read, declaration["motion"]
        names, v = list(scope.q), sympy.Matrix(list(scope.qdot.values()))
        rates = dict(zip(names, map(read, motion.get("rates", []))))
        lagrangian, forces = None, dict.fromkeys(names, sympy.S.Zero)
        if not rates:
            metric = sympy.Matrix([[read(entry) for entry in row] for row in motion["metric"]])
            linear = sympy.Matrix([read(entry) for entry in motion["linear"]])
            lagrangian = (v.T * metric * v)[0] / 2 + (linear.T * v)[0] - read(motion["potential"])
            for force in motion["forces"]:
                forces = {name: forces[name] + read(entry) for name, entry in zip(names, force)}
        constraints = {item["name"]: _constraint(scope, item, v) for item in declaration["constraints"]}
        forms = {name: tuple(value.diff(rate) for rate in v) for name, value in constraints.items()}
        surfaces = {item["name"]: read(item["gap"]) for item in declaration["surfaces"]}
        return cls(
            T, scope.q, scope.qdot, scope.parameters, lagrangian, rates, forces, constraints, forms, surfaces,
        )


def _constraint(scope: Scope, item: Mapping[str, Any], v: sympy.Matrix) -> Expr:
    if item["nonlinear"] is not None:
        return scope.read(item["nonlinear"])
    form = sympy.Matrix([scope.read(entry) for entry in item["form"]])
    return (form.T * v)[0] + scope.read(item["affine"])
