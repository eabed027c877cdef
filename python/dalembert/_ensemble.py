"""Ensembles that were run: columns, statistics and densities over all members."""

from __future__ import annotations

import csv
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
    """Statistics of the finite numbers in a column over all members, from exact sums.

    Attributes
    ----------
    count : int
        Number of finite numbers.
    mean : float
        Their mean, correctly rounded; NaN if there are none.
    std : float
        Their standard deviation (divisor ``count - 1``), the square root of the correctly rounded variance; NaN if there are fewer
        than two.
    least, greatest : float
        The extremes; NaN if there are none.
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
        Edges of the cells along each of them.
    counts : numpy.ndarray
        Numbers of states; rows belong to the second quantity, from its least values on.
    outside : int
        Number of states outside of the cells.
    convergence : tuple of mapping of str to float
        For 1/16, 1/8, .. 1 of the states: the total variation distances between the densities of two halves, split by time and
        split by members, and the distance expected for as many independent states.
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
    def open(cls, directory: Any) -> Ensemble:
        """Open a directory that :meth:`Model.ensemble` has completed.

        Parameters
        ----------
        directory : path, address or store
            The directory, as in :meth:`Model.ensemble`.

        Returns
        -------
        Ensemble
            The ensemble as :meth:`Model.ensemble` returned it.

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
    def directory(self) -> Path | str:
        """The path of the directory, or the address of a store. A temporary directory is removed with this object."""
        return self._directory.place

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
        """Statistics of the columns with numbers, over the members that do not end behind a surface."""
        return {name: Statistics(**_numbers(told)) for name, told in self._summary["statistics"].items()}

    @property
    def density(self) -> Density | None:
        """The density; None if none was requested."""
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
        if name not in self.columns:
            raise KeyError(f"`{name}` is no column; accepted: {', '.join(self.columns)}")
        return self._arrays([name])[name]

    def _arrays(self, names: Sequence[str]) -> dict[str, np.ndarray]:
        """Columns by name."""
        import numpy as np

        types = {"integer": np.int64, "number": np.float64, "text": object}
        arrays = {name: np.empty(len(self), dtype=types[self._kinds[name]]) for name in names}
        done = 0
        for values in self._directory.columns([self.columns.index(name) for name in names]):
            after = done + len(values[0])
            for array, part in zip(arrays.values(), values):
                array[done:after] = part
            done = after
        return arrays

    def to_pandas(self) -> pandas.DataFrame:
        """All columns as a table of pandas.

        Returns
        -------
        pandas.DataFrame
            A row for each member.
        """
        import pandas as pd

        return pd.DataFrame(self._arrays(self.columns))

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write all rows: the bytes of ``dalembert ensemble --csv`` for the same members.

        Parameters
        ----------
        path : path
            The file.
        """
        with open(path, "w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerow(self.columns)
        with open(path, "ab") as file:
            file.writelines(self._directory.lines())

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
        directory: Any = None,
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

        Rows and statistics are the same, to the bit, for every executor, every number of workers and every division of the work,
        also after lost workers and interruptions. The rows are those of the command ``ensemble``.

        Parameters
        ----------
        vary : mapping of str to object, optional
            Values of coordinates and velocities at the start and of parameters, by name. ``(low, high, count)`` are equally spaced
            values, both ends included, ``(low, high)`` the same with `members` values, a list the values themselves. Several names
            make all combinations, the last one changing fastest. With `seed`, values are drawn from the uniform distribution for
            ``(low, high)``, from the normal one for ``Normal(mean, deviation)``.
        members : int, optional
            Number of members.
        seed : int, optional
            Draw the values at random. A member depends on the seed and on its index alone.
        table : mapping of str to sequence of float, optional
            Columns by name, with one row for each member, instead of `vary`; a table of pandas, for example.
        executor : executor or callable, optional
            Anything with the `submit` of :mod:`concurrent.futures`: a pool of processes, ``client.get_executor()`` of Dask,
            ``MPIPoolExecutor``, an executor of loky or submitit, :class:`dalembert.ray.RayExecutor`. Or a function that makes an executor; it is called again if the
            executor breaks. Default: threads on all processors of this machine.
        directory : path, address or store, optional
            Directory in which results are kept in parts: Parquet files that other programs can read. If it holds parts of the same
            ensemble, the ensemble is continued. ``"s3://bucket/path"``, ``"gs://.."``, ``"az://.."`` and stores of the package obstore
            are directories too. Default: a temporary directory.
        density : sequence or mapping, optional
            Two quantities over which states of all members are counted: ``("x", "y")``, or with ranges ``{"x": (-1, 1), "y": None}``.
            Ranges that are not given come from short runs of a few members.
        bins : int or tuple of int, default 100
            Number of cells along each quantity.
        every, discard : float, default 1 and 0
            Time between counted states, and time at the start that is left out. The first state is counted at ``discard + every``.
        unit : float, default 10
            Seconds that a call in a worker should take. The number of its members follows from the measured pace. A call that takes
            six times as long ends after its current member.
        retries : int, default 3
            Number of workers that the same members may lose before the ensemble is given up.
        workers : int, optional
            Number of workers. Default: the number that the executor reports, or that of the processors.
        progress : bool, default False
            Show how many members are done, by tqdm.
        **course
            Arguments of :meth:`simulate` that all members share: ``until``, ``impacts``, ``state``, ``tol``, ``law`` and others.

        Returns
        -------
        Ensemble
            Columns, statistics and density. A member that does not reach its end is a row with its outcome.

        Raises
        ------
        RequestError
            Arguments that are refused; a directory of another ensemble.
        EnsembleError
            Workers that were lost too often, or failed. Finished parts stay in the directory.

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
