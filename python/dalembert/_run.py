"""Runs that have ended: samples, impacts, outcome."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Mapping, Sequence

from . import _native

if TYPE_CHECKING:
    import numpy as np
    import pandas
    import polars
    import pyarrow
    import xarray
    from matplotlib.axes import Axes

    from ._animation import Animation
    from ._events import Event
    from ._model import Model


@dataclass(frozen=True)
class Outcome:
    """The outcome of a run.

    Attributes
    ----------
    kind : str
        ``"done"`` at the requested end; ``"event"`` at a terminal event; ``"stopped"`` by a callback; ``"zeno"``, ``"contact"``,
        ``"ambiguous"``, ``"left_chart"`` and others before the requested end.
    t : float
        The time of the end.
    reached : bool
        True if the requested time, number of impacts or event was reached.
    details : mapping of str to object
        Details of this kind of outcome, such as ``surface`` and ``accumulates_at``. Surfaces and coordinates have their declared
        names.
    words : str
        The outcome in a sentence.
    """

    kind: str
    t: float
    reached: bool
    details: Mapping[str, Any]
    words: str

    def __str__(self) -> str:
        facts = ", ".join(f"{name} {value}" for name, value in self.details.items())
        return f"{self.kind} at t = {self.t}" + (f" ({facts})" if facts else "")


class Run:
    """A run of a model.

    Arrays are not copied: they are those that the run has filled. Rows are samples, columns coordinates.

    Examples
    --------
    >>> import dalembert
    >>> run = dalembert.models.bouncing_ball.simulate(until=1)
    >>> run.q.shape
    (1000, 1)
    """

    def __init__(self, model: Model, native: _native.NativeRun, events: Sequence[Event] = ()) -> None:
        self.model = model
        self._native = native
        self._events = events

    # Samples ---------------------------------------------------------------------------------------------------------------

    @property
    def t(self) -> np.ndarray:
        """Times of the samples."""
        return self._native.samples.t

    @property
    def q(self) -> np.ndarray:
        """Positions, one row per sample."""
        return self._native.samples.q

    @property
    def qdot(self) -> np.ndarray:
        """Velocities, one row per sample."""
        return self._native.samples.qdot

    @property
    def p(self) -> np.ndarray:
        """Momenta, one row per sample."""
        return self._native.samples.p

    @property
    def energy(self) -> np.ndarray:
        """Energies of the samples."""
        return self._native.samples.energy

    @property
    def outputs(self) -> np.ndarray:
        """Declared outputs, one row per sample."""
        return self._native.samples.outputs

    @property
    def view(self) -> np.ndarray | None:
        """Points of the declared view, one row per sample; None without a view."""
        return self._native.samples.view

    @property
    def mode(self) -> np.ndarray | None:
        """Names of the modes of the samples; None for a model without modes."""
        return _modes(self.model, self._native.samples)

    def __getitem__(self, name: str) -> np.ndarray:
        """A quantity of all samples by name: ``"t"``, a coordinate, ``"x_dot"``, ``"p_x"``, ``"energy"``, an output."""
        return _column(self.model, self._native.samples, name)

    def __call__(self, t: float | Sequence[float] | np.ndarray, side: str = "right") -> Samples:
        """States at any times of the run.

        The run is repeated up to the last of the times, so ask for many times at once. The states are those of a run with these
        ``times``, to the bit: they come from the dense output of the integrator.

        Parameters
        ----------
        t : float or array of float
            Times from 0 to the end, in any order.
        side : {"right", "left"}
            At the time of an impact: the state after it (right) or before it (left).

        Returns
        -------
        Samples
            The states, with arrays in the shape of `t`.

        Raises
        ------
        ValueError
            A time outside of the run.
        """
        import numpy as np

        if side not in ("left", "right"):
            raise ValueError(f"side: `{side}` is not accepted; expected \"left\" or \"right\"")
        times = np.asarray(t, dtype=np.float64)
        if times.size and not (0 <= times.min() and times.max() <= self.outcome.t):
            raise ValueError(f"t: times must be from 0 to {self.outcome.t}, the end of the run")
        order = np.argsort(times, axis=None, kind="stable")
        table = self._native.at(np.ascontiguousarray(times.ravel()[order]), side == "left")
        back = np.argsort(order, kind="stable")
        return Samples(self.model, times, table, back)

    # Impacts ---------------------------------------------------------------------------------------------------------------

    @cached_property
    def events(self) -> np.ndarray:
        """Impacts, as a structured array.

        Fields are ``t``, ``surface`` (its name), ``simultaneous`` (another surface was hit at the same time), ``grazing`` (so
        light that rounding may have decided it), and ``before`` and ``after``, which have a field for each coordinate, each
        velocity and the energy: ``run.events["after"]["theta_dot"]``. For a model with modes, ``mode`` is a field of both.
        """
        item = self._native.impacts
        flags = {"simultaneous": item.simultaneous, "grazing": item.grazing}
        return self._table(item.surfaces, flags, {"before": item.before, "after": item.after})

    @cached_property
    def contacts(self) -> np.ndarray:
        """Beginnings and ends of contacts, as a structured array: a surface begins or ceases to hold the motion.

        Fields are ``t``, ``surface``, ``begins``, ``accumulates_at`` (NaN unless the contact begins with impacts that
        accumulate), and ``at``, the state.
        """
        item = self._native.contacts
        flags = {"begins": item.begins, "accumulates_at": item.accumulation}
        return self._table(item.surfaces, flags, {"at": item.at})

    @cached_property
    def crossings(self) -> np.ndarray:
        """Changes of sign of the functions of the given events, as a structured array.

        Fields are ``t``, ``event`` (its name), ``rising``, and ``at``, the state. Values within rounding of 0 have no sign: a
        function that begins at 0 or only touches 0 does not change its sign. A jump at an impact does not count either. A step is
        halved into parts until a polynomial of degree 8 shows at most one change on each part, so that close ones are found, too.
        """
        item, names = self._native.crossings, [event.label for event in self._events]
        return self._table(item.events, {"rising": item.rising}, {"at": item.at}, "event", names)

    def _table(
        self,
        places: np.ndarray,
        flags: Mapping[str, np.ndarray],
        states: Mapping[str, _native.Table],
        title: str = "surface",
        names: Sequence[str] | None = None,
    ) -> np.ndarray:
        import numpy as np

        names = np.array(list(self.model.surfaces if names is None else names) or [""])
        columns = [*self.model.coordinates, *self.model.velocities, "energy"]
        state = [(name, "f8") for name in columns]
        if self.model.modes:
            state.append(("mode", np.array(self.model.modes).dtype))
        first = next(iter(states.values()))
        kinds = [("t", "f8"), (title, names.dtype), *((name, flag.dtype) for name, flag in flags.items())]
        table = np.empty(len(first.t), [*kinds, *((name, state) for name in states)])
        table["t"] = first.t
        table[title] = names[places]
        for name, flag in flags.items():
            table[name] = flag
        for place, item in states.items():
            for name in columns:
                table[place][name] = _column(self.model, item, name)
            if self.model.modes:
                table[place]["mode"] = _modes(self.model, item)
        return table

    # The end ---------------------------------------------------------------------------------------------------------------

    @cached_property
    def outcome(self) -> Outcome:
        """The outcome of the run."""
        item = self._native
        event, callback = item.stop
        if event is not None:
            name = self._events[event].label
            return Outcome(item.kind, item.t_end, True, {"event": name}, f"stopped at the event `{name}`")
        if callback is not None:
            return Outcome(item.kind, item.t_end, item.reached, {"callback": callback}, f"stopped by {callback}")
        return Outcome(item.kind, item.t_end, item.reached, item.details, item.words)

    @property
    def last(self) -> dict[str, float]:
        """The last state: coordinates, velocities and the energy by name."""
        q, qdot, energy = self._native.last
        return {**dict(zip(self.model.coordinates, q)), **dict(zip(self.model.velocities, qdot)), "energy": energy}

    @property
    def counters(self) -> dict[str, int]:
        """Counts of work: rate evaluations, accepted and rejected steps, impacts, and others."""
        return self._native.counters

    @property
    def warnings(self) -> list[str]:
        """Warnings about the accuracy of an integrator with a fixed step, as texts."""
        return self._native.warnings

    @property
    def laws(self) -> dict[str, str | None]:
        """The laws that were in force, by surface."""
        return dict(self._native.laws)

    # Derivatives -----------------------------------------------------------------------------------------------------------

    def jacobian(self, wrt: Sequence[str]) -> np.ndarray:
        """Derivatives of the last positions and velocities, across impacts.

        The run is repeated together with its first variations. Times of start and end are fixed.

        Parameters
        ----------
        wrt : sequence of str
            Names of coordinates, velocities, quasi-velocities and parameters. With a velocity, the dependent velocities vary so
            that the constraints hold. With a parameter, the initial positions and velocities stay fixed.

        Returns
        -------
        array
            One column per name; rows are coordinates, then velocities, in the order of the model.

        Raises
        ------
        RequestError
            The run has no derivative: a graze, a corner, a velocity that follows from others, an integrator of fixed step.
        """
        return self._native.jacobian(list(wrt))

    # Tables ----------------------------------------------------------------------------------------------------------------

    def columns(self) -> dict[str, np.ndarray]:
        """The samples by name: time, coordinates, velocities, energy, outputs, mode.

        Returns
        -------
        dict of str to array
            The columns of the table that the command ``simulate --csv`` writes, without those of events.
        """
        names = ["t", *self.model.coordinates, *self.model.velocities]
        if not self.model.is_first_order:
            names.append("energy")
        columns = {name: self[name] for name in [*names, *self.model.outputs]}
        return columns if self.mode is None else {**columns, "mode": self.mode}

    def to_pandas(self) -> pandas.DataFrame:
        """The samples as a table of pandas.

        Returns
        -------
        pandas.DataFrame
            A row for each sample, with the columns of :meth:`columns`.
        """
        import pandas

        return pandas.DataFrame(self.columns())

    def to_polars(self) -> polars.DataFrame:
        """The samples as a table of polars.

        Returns
        -------
        polars.DataFrame
            A row for each sample, with the columns of :meth:`columns`.
        """
        import polars

        return polars.DataFrame(self.columns())

    def to_arrow(self) -> pyarrow.Table:
        """The samples as a table of Arrow.

        Returns
        -------
        pyarrow.Table
            A row for each sample, with the columns of :meth:`columns`.
        """
        import pyarrow

        return pyarrow.table(self.columns())

    def to_xarray(self) -> xarray.Dataset:
        """The samples as a data set of xarray over the dimension ``t``.

        Returns
        -------
        xarray.Dataset
            A variable for each of :meth:`columns`.
        """
        import xarray

        columns = self.columns()
        times = columns.pop("t")
        return xarray.Dataset({name: ("t", values) for name, values in columns.items()}, {"t": times})

    # Pictures --------------------------------------------------------------------------------------------------------------

    def plot(self, *quantities: str, ax: Axes | None = None) -> Axes:
        """Draw the run with matplotlib.

        Parameters
        ----------
        *quantities : str
            A single quantity is drawn over time. If there are several, all others are drawn over the first. Default: the declared
            view, in which both axes have the same scale, or all coordinates over time if there is no view.
        ax : matplotlib axes, optional
            The axes to draw on. Default: the current ones.

        Returns
        -------
        matplotlib axes
            The axes of the picture.
        """
        from . import _plot

        return _plot.plot(self, quantities, ax)

    def animate(self, *, duration: float = 10.0, fps: float = 25.0) -> Animation:
        """An animation of the run: the declared view with its region and the impacts, or each coordinate over time.

        Parameters
        ----------
        duration : float, default 10
            Duration in seconds.
        fps : float, default 25
            Frames per second.

        Returns
        -------
        Animation
            It plays in a notebook. :meth:`Animation.to_matplotlib` gives a ``FuncAnimation``, :meth:`Animation.save` writes a file.
        """
        from ._animation import Animation

        return Animation(self, duration, fps)

    def __repr__(self) -> str:
        form, integrator, tol, step = self._native.settings
        kept = f"tol {tol:g}" if step is None else f"step {step:g}"
        return (
            f"Run of {self.model.name}: {self.outcome}\n"
            f"  {len(self.t)} samples, {len(self._native.impacts.surfaces)} impacts, {integrator}, {form} form, {kept}"
        )


class Samples:
    """States at requested times, in the shape of these times. Items are quantities by name, as in a :class:`Run`."""

    def __init__(self, model: Model, times: np.ndarray, table: _native.Table, order: np.ndarray) -> None:
        self._model = model
        self._table = table
        self._order = order
        self.t = times

    def _rows(self, values: np.ndarray) -> np.ndarray:
        return values[self._order].reshape(self.t.shape + values.shape[1:])

    @property
    def q(self) -> np.ndarray:
        """Positions; the last axis runs over the coordinates."""
        return self._rows(self._table.q)

    @property
    def qdot(self) -> np.ndarray:
        """Velocities."""
        return self._rows(self._table.qdot)

    @property
    def p(self) -> np.ndarray:
        """Momenta."""
        return self._rows(self._table.p)

    @property
    def energy(self) -> np.ndarray:
        """Energies."""
        return self._rows(self._table.energy)

    @property
    def outputs(self) -> np.ndarray:
        """Declared outputs."""
        return self._rows(self._table.outputs)

    @property
    def view(self) -> np.ndarray | None:
        """Points of the declared view; None without one."""
        return None if self._table.view is None else self._rows(self._table.view)

    def __getitem__(self, name: str) -> np.ndarray:
        return self._rows(_column(self._model, self._table, name))


def _column(model: Model, table: _native.Table, name: str) -> np.ndarray:
    if name in ("t", "energy"):
        return getattr(table, name)
    if name in ("q", "qdot", "p", "outputs"):
        return getattr(table, name)
    for names, values in [
        (model.coordinates, table.q), (model.velocities, table.qdot), (model.momenta, table.p), (model.outputs, table.outputs),
    ]:
        if name in names:
            return values[:, names.index(name)]
    quantities = ["t", *model.coordinates, *model.velocities, *model.momenta, "energy", *model.outputs]
    accepted = ", ".join([*quantities, "q", "qdot", "p", "outputs"])
    raise KeyError(f"`{name}` is no quantity of {model.name}; accepted: {accepted}")


def _modes(model: Model, table: _native.Table) -> np.ndarray | None:
    import numpy as np

    return None if table.mode is None else np.array(model.modes)[table.mode]
