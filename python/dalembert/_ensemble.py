"""Ensembles that were run: columns, statistics and densities over all members."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, Mapping, Sequence, cast

from ._errors import RequestError

if TYPE_CHECKING:
    import os
    from pathlib import Path

    import numpy as np
    import pandas

    from ._model import Model
    from ._parts import Directory
    from ._units import Executor


@dataclass(frozen=True)
class Normal:
    """Values drawn from a normal distribution, in `vary` of :meth:`Model.ensemble`.

    Attributes
    ----------
    mean : float
        The mean.
    deviation : float
        The standard deviation.
    """

    mean: float
    deviation: float


@dataclass(frozen=True)
class Statistics:
    """Statistics of a column over all members: those of its finite numbers, correctly rounded from exact sums.

    Attributes
    ----------
    count : int
        Finite numbers.
    mean : float
        Their mean; NaN without any.
    std : float
        Their standard deviation, with ``count - 1``; NaN below two.
    least, greatest : float
        The extremes; NaN without any.
    """

    count: int
    mean: float
    std: float
    least: float
    greatest: float


@dataclass(frozen=True)
class Density:
    """States of all members, counted in cells.

    Attributes
    ----------
    names : tuple of str
        The two quantities.
    edges : tuple of numpy.ndarray
        Edges of the cells along each.
    counts : numpy.ndarray
        Numbers of states; rows belong to the second quantity, from its least values on.
    outside : int
        States outside of the cells.
    convergence : tuple of mapping of str to float
        For 1/16, 1/8, .. 1 of the states: the total variation distance between the densities of two halves by time and by
        members, and that of as many independent states.
    """

    names: tuple[str, str]
    edges: tuple[np.ndarray, np.ndarray]
    counts: np.ndarray
    outside: int
    convergence: tuple[Mapping[str, float], ...]


class Ensemble:
    """An ensemble whose members were all run. Items are columns over all members, in their order.

    Columns are those of the command line: ``in.NAME`` for varied quantities, ``outcome``, ``t``, ``end.NAME`` for the last state,
    ``energy``, ``energy_change``, ``out.NAME``, ``impacts.SURFACE``, counters, ``reason``.

    Examples
    --------
    >>> import dalembert
    >>> drops = dalembert.models.bouncing_ball.ensemble({"x": (0.5, 2)}, members=4, until=10)
    >>> drops["in.x"]
    array([0.5, 1. , 1.5, 2. ])
    >>> drops.outcomes
    {'done': 4}
    """

    def __init__(self, directory: Directory) -> None:
        self._directory = directory
        self._manifest, self._summary = directory.manifest(), directory.summary()

    @classmethod
    def open(cls, directory: str | os.PathLike[str]) -> Ensemble:
        """Open a directory that :meth:`Model.ensemble` has completed.

        Parameters
        ----------
        directory : path
            The directory.

        Returns
        -------
        Ensemble
            The same as the one that was returned then.

        Raises
        ------
        RequestError
            A directory without an ensemble, or with one that is not complete.
        EnsembleError
            A part that was altered since.
        """
        from ._parts import Directory

        opened = Directory(directory)
        opened.manifest()
        opened.read()
        return cls(opened)

    @property
    def directory(self) -> Path:
        """The directory. Without one that was given it is removed with this object."""
        return self._directory.path

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(self._kinds)

    @property
    def _kinds(self) -> dict[str, str]:
        return dict(self._manifest["columns"])

    @property
    def outcomes(self) -> dict[str, int]:
        """Numbers of members by outcome."""
        return dict(self._summary["outcomes"])

    @property
    def not_reached(self) -> list[tuple[int, str, str]]:
        """The first members that did not reach their end: index, outcome, reason."""
        return [(member, outcome, reason) for member, outcome, reason in self._summary["first_not_reached"]]

    @property
    def statistics(self) -> dict[str, Statistics]:
        """Statistics of the columns with numbers."""
        return {name: Statistics(**_numbers(told)) for name, told in self._summary["statistics"].items()}

    @property
    def density(self) -> Density | None:
        """The density; None where none was asked for."""
        import numpy as np

        told = self._summary["density"]
        if told is None:
            return None
        names = [name for name, _, _ in told["axes"]]
        edges = [low * (1 - part) + high * part for _, (low, high), bins in told["axes"] for part in [np.arange(bins + 1) / bins]]
        counts = np.array(told["counts"], dtype=np.uint64).reshape(len(edges[1]) - 1, len(edges[0]) - 1)
        return Density((names[0], names[1]), (edges[0], edges[1]), counts, told["outside"], tuple(map(_numbers, told["convergence"])))

    def __len__(self) -> int:
        return self._summary["members"]

    def __getitem__(self, name: str) -> np.ndarray:
        import numpy as np

        if name not in self.columns:
            raise KeyError(f"`{name}` is no column; accepted: {', '.join(self.columns)}")
        place = self.columns.index(name)
        values = (row[place] for row in self._directory.rows())
        read, kind = {"integer": (int, np.int64), "number": (float, np.float64), "text": (str, object)}[self._kinds[name]]
        return np.fromiter(map(read, values), dtype=kind, count=len(self))

    def to_pandas(self) -> pandas.DataFrame:
        """All columns as a table of pandas.

        Returns
        -------
        pandas.DataFrame
            A row for each member.
        """
        import pandas as pd

        texts = [name for name, kind in self._kinds.items() if kind == "text"]
        missing = {name: ["NaN"] for name in self.columns if name not in texts}
        # Numbers are read back to the bit by default from pandas 3 on.
        precision = {} if int(pd.__version__.split(".")[0]) >= 3 else {"float_precision": "round_trip"}
        arguments = {"keep_default_na": False, "na_values": missing, "dtype": dict.fromkeys(texts, object), **precision}
        return pd.concat([pd.read_csv(path, **arguments) for path in self._directory.files()], ignore_index=True)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write all rows: the bytes of ``dalembert ensemble --csv`` for the same members.

        Parameters
        ----------
        path : path
            The file.
        """
        with open(path, "wb") as file:
            for number, part in enumerate(self._directory.files()):
                with open(part, "rb") as rows:
                    header = rows.readline()
                    if number == 0:
                        file.write(header)
                    while block := rows.read(1 << 20):
                        file.write(block)

    def __repr__(self) -> str:
        outcomes = ", ".join(f"{kind} {count}" for kind, count in self.outcomes.items())
        return f"<{len(self)} members of {self._manifest['model']}: {outcomes}>"


class Swept:
    """Model that an ensemble runs many times."""

    def ensemble(
        self,
        vary: Mapping[str, Any] | None = None,
        *,
        members: int | None = None,
        seed: int | None = None,
        table: Mapping[str, Sequence[float]] | None = None,
        executor: Executor | Callable[[], Executor] | None = None,
        directory: str | os.PathLike[str] | None = None,
        density: Sequence[str] | Mapping[str, tuple[float, float] | None] | None = None,
        bins: int | tuple[int, int] = 100,
        every: float = 1.0,
        discard: float = 0.0,
        unit: float = 10.0,
        retries: int = 3,
        workers: int | None = None,
        progress: bool = False,
        **course: Any,
    ) -> Ensemble:
        """Run the model many times, each time with another start or other parameters, on any executor.

        Rows and sums are the same, to the bit, for any executor, any number of workers and any sizes of units, after any losses and
        interruptions; rows are those of the command ``ensemble``.

        Parameters
        ----------
        vary : mapping of str to object, optional
            Values of coordinates and velocities at the start and of parameters, by name. ``(low, high, count)`` are equally spaced
            values, both ends included; ``(low, high)`` as many as `members`; a list is its values. Several names make all
            combinations, the last one changing fastest. With `seed`, ``(low, high)`` is uniform and ``Normal(mean, deviation)``
            normal.
        members : int, optional
            Number of members.
        seed : int, optional
            Draw the values at random. A member depends on the seed and on its index alone.
        table : mapping of str to sequence of float, optional
            Columns with a row for each member in place of `vary`; a table of pandas is one.
        executor : executor or callable, optional
            Anything with the `submit` of :mod:`concurrent.futures`: a pool of processes, ``client.get_executor()`` of Dask,
            ``MPIPoolExecutor``, an executor of loky or submitit. A function that makes one is asked for another after a loss. All
            processors of this machine by default.
        directory : path, optional
            Where the parts are kept. One that holds parts of the same ensemble is continued. A temporary one by default.
        density : sequence or mapping, optional
            Two quantities over which states of all members are counted: ``("x", "y")``, or with ranges ``{"x": (-1, 1), "y": None}``.
            Ranges that are not given come from short runs of a few members.
        bins : int or tuple of int, default 100
            Cells along each.
        every, discard : float, default 1 and 0
            Time between the states that are counted, and before the first.
        unit : float, default 10
            Seconds that a call in a worker should take. Numbers of members come from the measured pace; no call goes on beyond six
            times this, but for the member that it is at.
        retries : int, default 3
            Workers that one unit may lose before the ensemble is given up.
        workers : int, optional
            Number of workers, where the executor does not tell it.
        progress : bool, default False
            Show how many members are done, by tqdm.
        **course
            What members share, as for :meth:`simulate`: ``until``, ``impacts``, ``state``, ``tol``, ``integrator``, ``law`` and others.

        Returns
        -------
        Ensemble
            Columns, statistics and density. A member that does not reach its end is a row with its outcome.

        Raises
        ------
        RequestError
            Arguments that are refused; a directory of another ensemble.
        EnsembleError
            Workers that were lost too often, or failed. Parts that are done stay in the directory.

        Examples
        --------
        >>> import dalembert
        >>> drops = dalembert.models.bouncing_ball.ensemble({"x": (0.5, 2)}, members=4, until=10)
        >>> drops.statistics["end.x"].count
        4
        """
        from ._sweep import Plan, density_of, ensemble

        if not (math.isfinite(unit) and unit > 0):
            raise RequestError(f"unit: {unit} is not accepted; expected a positive number of seconds")
        for name, value, least in [("retries", retries, 0), ("workers", workers, 1)]:
            if value is not None and not (isinstance(value, int) and value >= least):
                raise RequestError(f"{name}: {value} is not accepted; expected a whole number from {least} on")
        counted = density_of(density, bins, every, discard)
        plan = Plan(unit, retries, workers)
        return ensemble(cast("Model", self), vary or {}, table, members, seed, counted, executor, directory, plan, progress, course)


def _numbers(told: Mapping[str, Any]) -> dict[str, Any]:
    """Numbers of a document, in which null stands for one that is not finite."""
    return {name: math.nan if value is None else value for name, value in told.items()}
