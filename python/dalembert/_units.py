"""Members of an ensemble on an executor: units of measured size, and lost workers."""

from __future__ import annotations

import os
import time
from collections import deque
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from typing import Any, Callable, Iterator, Protocol

from ._errors import EnsembleError

#: Number of members of the first units, whose pace is not known yet.
FIRST = 64
#: Largest number of members of a unit: its rows are in the memory of the driver until they are written.
MOST = 50_000
#: A unit ends early after this multiple of its planned time. Its remaining members then form another unit.
LONGEST = 6.0
#: Towards the end units become shorter, down to the planned time divided by this.
SHORTEST = 50
#: Number of units in flight for each worker, so that no worker waits.
AHEAD = 2
#: Number of units for each worker over which the pace is measured.
RECENT = 4
#: Names of the errors by which executors report a lost worker, in addition to errors of the standard library.
LOST = frozenset({
    "KilledWorker", "NodeDiedError", "OutOfMemoryError", "TerminatedWorkerError", "UncompletedJobError", "WorkerCrashedError",
})


class Executor(Protocol):
    """Anything that makes futures of calls: :class:`concurrent.futures.Executor` and others with its `submit`."""

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Any:
        """The future of a call."""


@dataclass(frozen=True)
class Unit:
    """Members from `first` up to, but without, `last`; `attempts` is the number of earlier attempts."""

    first: int
    last: int
    attempts: int = 0

    def __str__(self) -> str:
        return f"members {self.first} to {self.last - 1}"


@dataclass(frozen=True)
class Plan:
    """Rules for the division of members into units.

    Attributes
    ----------
    seconds : float
        Planned time of a unit.
    retries : int
        Number of workers that one unit may lose.
    workers : int or None
        Number of workers; None for the number that the executor reports.
    """

    seconds: float
    retries: int
    workers: int | None


def is_lost(error: BaseException) -> bool:
    """True if an error says that a worker was lost, not that its members are at fault."""
    if isinstance(error, (BrokenExecutor, CancelledError)):
        return True
    return any(kind.__name__ in LOST for kind in type(error).__mro__)


class Units:
    """Runs all units, and hands their results on as they come.

    Parameters
    ----------
    executor
        An executor, or a function that makes one. The function is called again if the executor breaks.
    call
        Makes the function and the arguments of a unit.
    gaps
        Ranges of members that are to be run.
    plan
        Rules for the division into units.
    """

    def __init__(
        self,
        executor: Executor | Callable[[], Executor],
        call: Callable[[Unit, float], tuple[Callable[..., Any], tuple[Any, ...]]],
        gaps: list[tuple[int, int]],
        plan: Plan,
    ) -> None:
        self._make = None if hasattr(executor, "submit") else executor
        self._executor: Any = executor if self._make is None else self._make()
        self._owned = self._make is not None
        self._call, self._plan = call, plan
        self._gaps = deque(gaps)
        self._again: deque[Unit] = deque()
        self._flying: dict[Any, tuple[Unit, Any]] = {}
        self._workers = plan.workers or workers_of(self._executor)
        self._recent: deque[tuple[int, float]] = deque(maxlen=RECENT * self._workers)

    def results(self) -> Iterator[tuple[int, dict[str, Any]]]:
        """First members of units with their results, in the order in which they end."""
        try:
            while self._fill():
                for future in self._ended():
                    yield from self._taken(*self._flying.pop(future), future)
        except BaseException:
            for future in self._flying:
                future.cancel()
            raise
        finally:
            self._close()

    def _fill(self) -> bool:
        """Submits units until every worker has enough; false once nothing is left."""
        while len(self._flying) < AHEAD * self._workers and (self._again or self._gaps):
            unit = self._again.popleft() if self._again else self._next()
            function, arguments = self._call(unit, LONGEST * self._plan.seconds)
            try:
                future = self._executor.submit(function, *arguments)
            except BrokenExecutor as error:
                self._lost(unit, self._executor, error)
                continue
            self._flying[future] = unit, self._executor
        return bool(self._flying)

    def _next(self) -> Unit:
        """The next members, as many as the measured pace makes in the time of a unit, and fewer towards the end."""
        first, last = self._gaps.popleft()
        left = last - first + sum(b - a for a, b in self._gaps)
        share = -(-left // (AHEAD * self._workers))
        seconds = sum(seconds for _, seconds in self._recent)
        pace = sum(members for members, _ in self._recent) / seconds if seconds > 0 else None
        wanted, least = (FIRST, 1) if pace is None else (int(pace * self._plan.seconds), int(pace * self._plan.seconds / SHORTEST))
        size = max(1, min(wanted, max(share, least), MOST, last - first))
        if first + size < last:
            self._gaps.appendleft((first + size, last))
        return Unit(first, first + size)

    def _ended(self) -> list[Any]:
        """Futures that have ended, at least one."""
        if all(isinstance(future, Future) for future in self._flying):
            return list(wait(self._flying, return_when=FIRST_COMPLETED).done)
        pause = 0.005
        while not (ended := [future for future in self._flying if future.done()]):
            time.sleep(pause)
            pause = min(1.5 * pause, 1.0)
        return ended

    def _taken(self, unit: Unit, executor: Any, future: Any) -> Iterator[tuple[int, dict[str, Any]]]:
        """The result of a unit; members that are left, or lost with a worker, are run again."""
        try:
            result = future.result()
        except (Exception, CancelledError) as error:
            if not is_lost(error):
                raise EnsembleError(f"{unit}: {type(error).__name__}: {error}") from error
            self._lost(unit, executor, error)
            return
        done = unit.first + result["members"]
        if done < unit.last:
            self._gaps.appendleft((done, unit.last))
        self._recent.append((result["members"], result["seconds"]))
        yield unit.first, result

    def _lost(self, unit: Unit, executor: Any, error: BaseException) -> None:
        if unit.attempts >= self._plan.retries:
            raise EnsembleError(
                f"{unit}: {unit.attempts + 1} workers were lost with these members, the last by {type(error).__name__}: {error}"
            ) from error
        self._again.append(Unit(unit.first, unit.last, unit.attempts + 1))
        if isinstance(error, BrokenExecutor):
            self._replace(executor, error)

    def _replace(self, broken: Any, error: BrokenExecutor) -> None:
        """Replaces an executor that broke, unless an earlier unit has replaced it."""
        if broken is not self._executor:
            return
        replacement = self._make() if self._make else renewed(self._executor)
        if replacement is None:
            raise EnsembleError(
                f"the executor broke, and takes no more units: {error}; give a function that makes one, which is asked for "
                "another, as executor=lambda: MyExecutor(..)"
            ) from error
        self._close()
        self._executor, self._owned = replacement, True

    def _close(self) -> None:
        """Shuts down the executor if it was made here."""
        if self._owned and hasattr(self._executor, "shutdown"):
            self._executor.shutdown(wait=False)


def renewed(executor: Any) -> ProcessPoolExecutor | None:
    """A pool of processes like one that broke; None for other executors."""
    if type(executor) is not ProcessPoolExecutor:
        return None
    names = ("_max_workers", "_mp_context", "_initializer", "_initargs")
    if not all(hasattr(executor, name) for name in names):
        return None
    workers, context, initializer, arguments = (getattr(executor, name) for name in names)
    return ProcessPoolExecutor(workers, context, initializer, arguments)


def workers_of(executor: Any) -> int:
    """Number of workers of an executor; the number of processors of this machine if the executor does not report it."""
    client = getattr(executor, "_client", None)
    if client is not None and hasattr(client, "nthreads"):
        return max(1, sum(client.nthreads().values()))
    for name in ("_max_workers", "num_workers", "_num_workers"):
        count = getattr(executor, name, None)
        if isinstance(count, int) and count > 0:
            return count
    return os.cpu_count() or 1
