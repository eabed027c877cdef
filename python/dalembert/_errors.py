"""Exceptions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping


class DalembertError(Exception):
    """Anything that this package refuses."""


class RequestError(DalembertError, ValueError):
    """A parameter, a state or a run that is refused, in the names of the model."""


class EnsembleError(DalembertError, RuntimeError):
    """An ensemble that cannot go on: workers that were lost too often, or files that were altered. Parts that are done are kept."""


@dataclass(frozen=True)
class Mistake:
    """A mistake in the text of a model.

    Attributes
    ----------
    message : str
        What is wrong, and what to write instead.
    line, column : int
        The place, from 1 on; columns count characters.
    width : int
        Columns that are wrong in this line.
    counterexample : mapping of str to float, or None
        A state that refutes a claim, parameters included.
    values : mapping of str to float, or None
        Quantities that contradict the claim at that state.
    """

    message: str
    line: int
    column: int
    width: int
    counterexample: Mapping[str, float] | None = None
    values: Mapping[str, float] | None = None


class ModelError(DalembertError, ValueError):
    """A text that declares no model, or whose claims are refuted or left open.

    Attributes
    ----------
    text : str
        All mistakes, each with its line of the text and carets below what is wrong.
    mistakes : tuple of Mistake
        The mistakes as data.
    line, column : int
        The place of the first mistake, from 1 on.
    counterexample : mapping of str to float, or None
        The state that refutes the first refuted claim.
    """

    def __init__(self, text: str, mistakes: list[dict[str, Any]]) -> None:
        super().__init__(text)
        self.text = text
        self.mistakes = tuple(Mistake(**mistake) for mistake in mistakes)
        self.line = self.mistakes[0].line
        self.column = self.mistakes[0].column
        found = (mistake.counterexample for mistake in self.mistakes)
        self.counterexample = next((one for one in found if one is not None), None)

    def __reduce__(self) -> Any:
        return ModelError, (self.text, [dict(vars(mistake)) for mistake in self.mistakes])
