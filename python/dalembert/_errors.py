"""Exceptions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping


class DalembertError(Exception):
    """Base class of the exceptions of this package."""


class RequestError(DalembertError, ValueError):
    """A parameter, a state or a run is refused. The message uses the names of the model."""


class EnsembleError(DalembertError, RuntimeError):
    """An ensemble cannot go on: workers were lost too often, or files were altered. Finished parts are kept."""


@dataclass(frozen=True)
class Mistake:
    """A mistake in the text of a model.

    Attributes
    ----------
    message : str
        The mistake and its remedy.
    line, column : int
        The place, from 1 on; columns count characters.
    width : int
        Number of wrong characters in this line.
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
        All mistakes, each with its line of the text and carets below the wrong characters.
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
