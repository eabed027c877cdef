"""Events and callbacks of a run."""

from __future__ import annotations

import re
import sys
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, Iterator, Sequence

from . import _native
from ._errors import ModelError, RequestError

if TYPE_CHECKING:
    import numpy as np

    from ._model import Model

#: A function of time, positions and velocities.
StateFunction = Callable[[float, "np.ndarray", "np.ndarray"], float]

#: Signs that would end an expression, or hide the rest of the declaration.
_FOREIGN = (";", "{", "}", "//", "/*", "\n")


@dataclass(frozen=True)
class Event:
    """An event: a change of sign of a function of the state.

    Attributes
    ----------
    function : str or callable
        An expression of the language, in the quantities that outputs may contain: time, coordinates, velocities ``dot(x)``,
        parameters and others. Or a function of ``t``, ``q`` and ``qdot``, which is called 9 times or more in each step.
    direction : int, default 0
        Positive: only rises count. Negative: only falls count.
    terminal : bool, default False
        End the run there, with the outcome ``event``.
    name : str, optional
        The name in tables. Default: the expression, or the name of the function.

    Examples
    --------
    >>> import dalembert
    >>> run = dalembert.models.bouncing_ball.simulate(until=2, events=[dalembert.Event("dot(x)", direction=-1, name="top")])
    >>> run.crossings["event"][0]
    'top'
    """

    function: str | StateFunction
    direction: int = 0
    terminal: bool = False
    name: str | None = None

    @property
    def label(self) -> str:
        """The name in tables."""
        if self.name is not None:
            return self.name
        return self.function if isinstance(self.function, str) else getattr(self.function, "__name__", "event")


@dataclass(frozen=True)
class Occurrence:
    """The argument of the callback `on_event` of :meth:`Model.simulate`.

    Attributes
    ----------
    kind : {"impact", "contact", "release", "rising", "falling"}
        An impact, the beginning or the end of a contact, or a change of sign of an event.
    name : str
        The surface or the event.
    t : float
        The time.
    q, qdot : array
        The state; at an impact, the state before it.
    q_after, qdot_after : array
        At an impact, the state after it; otherwise the same state.
    """

    kind: str
    name: str
    t: float
    q: np.ndarray
    qdot: np.ndarray
    q_after: np.ndarray
    qdot_after: np.ndarray


def taken(events: Sequence[Any]) -> tuple[Event, ...]:
    """The events of a request. Each is an expression, a function, a tuple of one of these and a direction, or an :class:`Event`."""
    found = []
    for event in events:
        if isinstance(event, (str, tuple)) or (callable(event) and not isinstance(event, Event)):
            event = Event(*event) if isinstance(event, tuple) else Event(event)
        if not isinstance(event, Event) or not (isinstance(event.function, str) or callable(event.function)):
            raise RequestError(f"events: {event!r} is not accepted; expected an expression, a function or an Event")
        found.append(event)
    return tuple(found)


def watched(model: Model, events: Sequence[Event]) -> _native.NativeModel | None:
    """The model with the expressions of events as its last outputs; None without expressions."""
    texts = tuple(event.function for event in events if isinstance(event.function, str))
    if not texts:
        return None
    for text in texts:
        foreign = [sign for sign in _FOREIGN if sign in text]
        if foreign:
            raise RequestError(f"events: `{foreign[0]}` cannot be in the expression `{text}`")
        if re.search(r"\bintegral\s*\(", text):
            raise RequestError(f"events: `{text}`: an integral along a run is no function of its state")
    body = model.source.rpartition("}")[0].rstrip()
    lines = "".join(f"event_{place}: ({text});\n" for place, text in enumerate(texts))
    first = body.count("\n") + 3
    try:
        natives = _native.load(f"{body}\noutputs {{\n{lines}}}\n}}\n", "events", False)
    except ModelError as error:
        place = error.line - first
        if 0 <= place < len(texts):
            raise RequestError(f"events: `{texts[place]}`: {error.mistakes[0].message.splitlines()[0]}") from None
        raise
    native = natives[0] if model._scene == "all" else natives[0].in_scene(model._scene)
    return native.with_parameters([(name, value) for name, value in model.parameters.items() if value == value])


def listener(model: Model, events: Sequence[Event], call: Callable[[Occurrence], Any] | None) -> Callable[..., Any] | None:
    """The function that the extension module calls at events; None without a callback."""
    if call is None:
        return None
    surfaces, labels = list(model.surfaces), [event.label for event in events]

    def heard(kind: str, index: int, t: float, before: Any, after: Any) -> Any:
        name = labels[index] if kind in ("rising", "falling") else surfaces[index]
        return call(Occurrence(kind, name, t, *before, *after))

    return heard


@contextmanager
def progress(shows: bool, until: float | None, name: str) -> Iterator[Callable[[float], None] | None]:
    """A function that shows the time that a run has reached: by tqdm if it is installed, else in a line of the terminal."""
    if not shows:
        yield None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield lambda t: print(f"\r{name}: t = {t:.6g}", end="" if until is None else f" of {until:g}", file=sys.stderr, flush=True)
        print(file=sys.stderr)
        return
    with tqdm(total=until, desc=name, unit="t", bar_format=None if until is None else "{l_bar}{bar}| {n:.6g}/{total:g}") as bar:
        yield lambda t: bar.update(t - bar.n)
