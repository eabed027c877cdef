"""Derivations and verdicts on claims."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any, Mapping, Sequence

from . import _native

if TYPE_CHECKING:
    import sympy


@dataclass(frozen=True)
class Expression:
    """An expression of the language.

    Attributes
    ----------
    name : str
        The name of the quantity.
    text : str
        The expression as the language writes it.
    latex : str
        The same in LaTeX.
    declaration : mapping
        The declaration that explains its names: :attr:`Derivation.declaration`.
    """

    name: str
    text: str
    latex: str
    declaration: Mapping[str, Any] = field(repr=False, compare=False)

    def __str__(self) -> str:
        return self.text

    def _repr_latex_(self) -> str:
        return rf"$\displaystyle {self.name} = {self.latex}$"

    def to_sympy(self) -> sympy.Expr:
        """The expression in SymPy, over functions of time.

        Returns
        -------
        sympy.Expr
            The expression in the objects of :meth:`Model.to_sympy`: coordinates are functions of ``t``, velocities their
            derivatives, parameters symbols with the declared signs. Members of families have names with an underscore: ``theta_3``.
        """
        from ._sympy import Scope

        return Scope(self.declaration).read(self.text)


@dataclass(frozen=True)
class Section:
    """A part of a derivation.

    Attributes
    ----------
    title : str
        The title.
    equation, equation_latex : str
        The equation of the section; empty if there is none.
    items : tuple of str or (str, str) pairs with rows
        Lines of text, or left sides with the rows of a matrix. Left sides and entries are given as text and as LaTeX.
    """

    title: str
    equation: str
    equation_latex: str
    items: tuple[Any, ...]

    def to_html(self) -> str:
        """The section in HTML, with formulas for MathJax.

        Returns
        -------
        str
            One element for each item.
        """
        parts = [f"<h4>{escape(self.title)}</h4>"]
        if self.equation_latex:
            parts.append(_display(self.equation_latex))
        for item in self.items:
            parts.append(f"<p>{escape(item)}</p>" if isinstance(item, str) else _display(_formula(*item)))
        return "".join(parts)


@dataclass(frozen=True)
class Verdict:
    """The verdict on a claim.

    Attributes
    ----------
    claim : str
        The claim as written.
    verdict : {"proved", "refuted", "assumed", "undecided"}
        The verdict. A model that was loaded with its claims has no refuted claim.
    grounds : str
        The certificate, the counterexample or the reason, in words.
    remarks : tuple of str
        Further findings.
    scene : str
        The scene of the claim; ``"all"`` for the model itself.
    chance_of_error : float or None
        An upper bound of the probability that the proof is wrong; 0 for a proof without random choices.
    counterexample, values : mapping of str to float, or None
        A state that refutes the claim, and quantities that contradict it there.
    """

    claim: str
    verdict: str
    grounds: str
    remarks: tuple[str, ...] = ()
    scene: str = "all"
    chance_of_error: float | None = None
    counterexample: Mapping[str, float] | None = None
    values: Mapping[str, float] | None = None


class Derivation:
    """The equations of a model, in the order of their derivation. In a notebook it is shown with MathJax."""

    def __init__(self, native: dict[str, Any], scene: str) -> None:
        self._native = native
        self._scene = scene

    @property
    def text(self) -> str:
        """The derivation as text, as the command `derive` prints it."""
        return self._native["text"]

    @property
    def latex(self) -> str:
        """The derivation as a document of LaTeX."""
        return self._native["latex"]

    @property
    def declaration(self) -> dict[str, Any] | None:
        """The declaration in coordinates, as data; expressions are texts of the language. None for a model with modes."""
        return self._native["declaration"]

    @cached_property
    def sections(self) -> tuple[Section, ...]:
        """The sections, in order."""
        return tuple(
            Section(title, *equation, tuple(items)) for title, equation, items in self._native["sections"]
        )

    @cached_property
    def verdicts(self) -> tuple[Verdict, ...]:
        """The verdicts on the claims, in order."""
        return tuple(
            Verdict(**{**each, "remarks": tuple(each["remarks"])}, scene=self._scene) for each in self._native["findings"]
        )

    @property
    def lagrangian(self) -> Expression:
        """The Lagrangian.

        Raises
        ------
        AttributeError
            A first-order system has none, nor has a model with modes as a whole.
        """
        for section in self.sections:
            if section.title == "Lagrangian":
                (name, _), [[(text, latex)]] = section.items[0]
                return Expression(name, text, latex, self.declaration)
        raise AttributeError("no Lagrangian is declared here; of a model with modes, each scene has one")

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return self.text

    def to_html(self, heading: bool = True) -> str:
        """The derivation in HTML, with formulas for MathJax.

        Parameters
        ----------
        heading : bool, default True
            Begin with name and documentation.

        Returns
        -------
        str
            HTML without scripts; notebooks load MathJax.
        """
        name, documentation = self._native["name"], self._native["documentation"]
        head = f"<h3>{escape(name)}</h3><p>{escape(documentation)}</p>" if heading else ""
        return head + "".join(section.to_html() for section in self.sections)

    def _repr_html_(self) -> str:
        return self.to_html()


def derivations(source: str, claims: bool, scenes: Sequence[str]) -> dict[str, Derivation]:
    """The derivations of a model and of its scenes, by name of the scene."""
    natives = _native.derive(source, claims)
    return {scene: Derivation(native, scene) for scene, native in zip(scenes, natives)}


def _display(latex: str) -> str:
    return rf"\[ {escape(latex, quote=False)} \]"


def _formula(left: Sequence[str], rows: Sequence[Sequence[Sequence[str]]]) -> str:
    cells = [[entry[1] for entry in row] for row in rows]
    if len(cells) == len(cells[0]) == 1:
        return f"{left[1]} = {cells[0][0]}"
    matrix = r" \\ ".join(" & ".join(row) for row in cells)
    return rf"{left[1]} = \begin{{pmatrix}} {matrix} \end{{pmatrix}}"
