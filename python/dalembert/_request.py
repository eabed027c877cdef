"""Arguments of runs, in the form that the extension module accepts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Mapping, Sequence

from ._errors import RequestError

if TYPE_CHECKING:
    from typing import Callable

    import numpy as np

    from ._events import StateFunction


def inputs(
    names: Sequence[str], given: Mapping[str, float | StateFunction],
) -> tuple[list[tuple[str, float]], Callable[..., list[float]] | None]:
    """The inputs that are numbers, and all inputs as one function of time and state; None if no input is a function."""
    numbers = {name: value for name, value in given.items() if not callable(value)}
    functions = {name: value for name, value in given.items() if callable(value)}
    if not functions:
        return pairs(numbers), None
    for name in functions:
        if name not in names:
            raise RequestError(f"unknown input `{name}`" + (f"\n  accepted: {', '.join(names)}" if names else "; there are none"))

    def control(t: float, q: np.ndarray, qdot: np.ndarray) -> list[float]:
        return [float(functions[name](t, q, qdot)) if name in functions else float(numbers.get(name, 0.0)) for name in names]

    return pairs(numbers), control


def pairs(values: Mapping[str, float]) -> list[tuple[str, float]]:
    return [(name, float(value)) for name, value in values.items()]


def start(
    state: Mapping[str, float] | None, q: Sequence[float] | None, qdot: Sequence[float] | None, p: Sequence[float] | None,
) -> dict[str, Any]:
    return {"state": pairs(state or {}), "q": floats(q), "qdot": floats(qdot), "p": floats(p)}


def floats(values: Sequence[float] | None) -> list[float] | None:
    return None if values is None else [float(value) for value in values]


def array(values: Sequence[float] | np.ndarray) -> np.ndarray:
    import numpy as np

    return np.ascontiguousarray(values, dtype=np.float64)


def laws(law: str | Mapping[str, str] | None) -> list[tuple[str | None, str, float | None]]:
    if law is None:
        return []
    given = {None: law} if isinstance(law, str) else law
    return [(surface, *_law(text)) for surface, text in given.items()]


def _law(text: str) -> tuple[str, float | None]:
    name, _, coefficient = text.partition(":")
    try:
        return name.strip(), float(coefficient) if coefficient else None
    except ValueError:
        raise RequestError(f"law: `{text}` is not accepted; expected a law such as \"elastic\" or \"newton:0.5\"") from None
