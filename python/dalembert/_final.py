"""The end of a run as a function of numbers, with its derivatives. `dalembert.jax` and `dalembert.torch` wrap it."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any, Sequence

import numpy as np

from ._errors import RequestError

if TYPE_CHECKING:
    from ._model import Model
    from ._run import Run


class Final:
    """Positions and velocities at the end of a run, as a function of initial values and parameters.

    Initial values that are not varied are fixed numbers, given or declared. They do not change with a varied parameter.
    """

    def __init__(self, model: Model, names: Sequence[str], arguments: dict[str, Any]) -> None:
        self.model, self.names = model, list(names)
        state = [*model.coordinates, *model.velocities]
        unknown = [name for name in self.names if name not in state and name not in model.parameters]
        if unknown:
            accepted = ", ".join([*state, *model.parameters])
            raise RequestError(f"`{unknown[0]}` is no coordinate, velocity or parameter of {model.name}; accepted: {accepted}")
        if any(name in arguments for name in ("q", "qdot", "p")):
            raise RequestError("q, qdot and p: the start is varied by name; give the rest of it with state=")
        declared = {name: value for name, value in model.initial.items() if name != "until"}
        self._start = declared | dict(arguments.pop("state", None) or {})
        self._arguments = {"samples": 0, **arguments}
        if "until" not in self._arguments and "until" in model.initial:
            self._arguments["until"] = model.initial["until"]
        self._run = lru_cache(maxsize=16)(self._made)

    @property
    def size(self) -> int:
        """The number of components of an end: positions and velocities."""
        return 2 * len(self.model.coordinates)

    def _made(self, values: tuple[float, ...]) -> Run:
        given = dict(zip(self.names, values))
        parameters = {name: value for name, value in given.items() if name in self.model.parameters}
        state = {name: value for name, value in given.items() if name not in parameters}
        model = self.model.with_parameters(**parameters) if parameters else self.model
        run = model.simulate(state=self._start | state, **self._arguments)
        if run.outcome.kind != "done":
            raise RequestError(f"the run has no end to differentiate: {run.outcome}")
        return run

    def _each(self, values: Any, shape: tuple[int, ...], one: Any) -> np.ndarray:
        """A result for each vector of values, along the last axis."""
        values = np.asarray(values, dtype=np.float64)
        rows = values.reshape(-1, len(self.names))
        results = [one(self._run(tuple(row.tolist()))) for row in rows]
        return np.ascontiguousarray(results).reshape(values.shape[:-1] + shape)

    def end(self, values: Any) -> np.ndarray:
        """The ends of the runs with these values: positions, then velocities."""
        columns = [*self.model.coordinates, *self.model.velocities]
        return self._each(values, (self.size,), lambda run: [run.last[name] for name in columns])

    def jacobian(self, values: Any) -> np.ndarray:
        """The derivatives of these ends with respect to the values, across impacts."""
        return self._each(values, (self.size, len(self.names)), lambda run: run.jacobian(self.names))
