"""Runs of ensembles: members as data, units in workers, sums of all parts."""

from __future__ import annotations

import hashlib
import math
import os
import pickle
import shutil
import tempfile
import weakref
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any, Callable, Iterator, Mapping, Sequence

from . import _native
from ._ensemble import Ensemble, Normal, Statistics
from ._errors import EnsembleError, RequestError
from ._parts import Directory
from ._request import inputs as input_functions, laws, pairs, start
from ._units import Executor, Plan, Unit, Units

if TYPE_CHECKING:
    import numpy as np

    from ._model import Model

#: Arguments of :meth:`Model.simulate` that all members share, with their defaults.
COURSE: dict[str, Any] = {
    "until": None, "impacts": None, "state": None, "q": None, "qdot": None, "p": None, "off_constraint": "error", "tol": 1e-10,
    "integrator": "auto", "step": None, "max_step": None, "steps": None, "law": None, "form": None, "projection": None,
    "rest": "stop", "penetration": "stop", "corner": "stop", "split": "first", "inputs": None, "mode": None,
}
#: Arguments of a run that ensembles do without.
WITHOUT: dict[str, Any] = {
    "times": None, "samples": 0, "events": [], "watched": None, "on_step": None, "on_event": None, "on_progress": None,
    "control": None, "period": None,
}
#: Longest planned time of a unit in this process, in seconds. Short units cost nothing there, and end soon after Ctrl-C.
INSIDE = 1.0
#: Maximum number of members that did not reach the requested end in the list of a summary.
TOLD = 5


def ensemble(
    model: Model,
    vary: Mapping[str, Any],
    table: Mapping[str, Sequence[float]] | None,
    members: int | None,
    seed: int | None,
    density: dict[str, Any] | None,
    executor: Executor | Callable[[], Executor] | None,
    directory: Any,
    plan: Plan,
    progress: bool,
    course: dict[str, Any],
) -> Ensemble:
    """The ensemble of :meth:`Model.ensemble`."""
    request = _request(model, course)
    varied, rows = _members(model, vary, table, members, seed)
    spec = request | {"varied": varied, "density": density}
    native = _built(model, spec, rows, 0)
    if density is not None:
        spec["density"] = density | {"axes": native.axes()}
    kept = Directory(tempfile.mkdtemp(prefix="dalembert-") if directory is None else directory)
    # A temporary directory is removed with its object, or at once after an error.
    removal = weakref.finalize(kept, shutil.rmtree, kept.place, ignore_errors=True) if directory is None else None
    try:
        kept.begin(_identity(model, spec, native, rows))
        _complete(kept, model, spec, native, rows, executor, plan, progress)
    except BaseException:
        if removal is not None:
            removal()
        raise
    finally:
        kept.close()
    return Ensemble(kept)


def _complete(
    kept: Directory,
    model: Model,
    spec: dict[str, Any],
    native: _native.NativeEnsemble,
    rows: np.ndarray | None,
    executor: Executor | Callable[[], Executor] | None,
    plan: Plan,
    progress: bool,
) -> None:
    """Runs the members that are in no part, and writes the summary."""
    count = spec["varied"]["count"]
    inside = executor is None or isinstance(executor, ThreadPoolExecutor)
    if inside:
        plan = Plan(min(plan.seconds, INSIDE), plan.retries, plan.workers)
        made = executor or partial(ThreadPoolExecutor, plan.workers or os.cpu_count() or 1)
        units = Units(made, lambda unit, longest: (native.run, (unit.first, unit.last, longest)), kept.gaps(count), plan)
    else:
        work = pickle.dumps((model, spec))

        def call(unit: Unit, longest: float) -> tuple[Callable[..., Any], tuple[Any, ...]]:
            part = None if rows is None else rows[unit.first:unit.last]
            return run_unit, (work, unit.first, unit.last, longest, part, unit.attempts, _native.version())

        units = Units(executor, call, kept.gaps(count), plan)
    try:
        with _shown(progress, count, model.name, sum(part["members"] for part in kept.parts.values())) as tell:
            for first, unit in units.results():
                kept.add(first, unit)
                tell(unit["members"])
    except BaseException:
        native.stop()
        raise
    kept.finish(_summary(kept, spec, native))


def run_unit(
    work: bytes, first: int, last: int, longest: float, rows: np.ndarray | None, attempt: int, version: str,
) -> dict[str, Any]:
    """Rows and sums of a unit, in a worker. `attempt` makes a call after a loss differ from the lost call."""
    if version != _native.version():
        raise EnsembleError(f"the worker has dalembert {_native.version()}, and the driver {version}; install the same")
    model, spec = _taken(work)
    return _built(model, spec, rows, first).run(first, last, longest)


@lru_cache(maxsize=4)
def _taken(work: bytes) -> tuple[Model, dict[str, Any]]:
    """The model of an ensemble; a worker loads it once."""
    return pickle.loads(work)


def _built(model: Model, spec: dict[str, Any], rows: np.ndarray | None, first: int) -> _native.NativeEnsemble:
    native = model._native
    if spec["inputs"]:
        native = native.with_inputs(spec["inputs"])
    if spec["mode"] is not None:
        native = native.with_mode(spec["mode"])
    varied = spec["varied"] | {"rows": None if rows is None else rows.ravel(), "first": first}
    return _native.NativeEnsemble(native, spec["request"] | WITHOUT, varied, spec["density"])


def _request(model: Model, course: dict[str, Any]) -> dict[str, Any]:
    """Arguments that all members share, as data."""
    for name in course:
        if name not in COURSE:
            raise TypeError(f"ensemble() has no argument `{name}`; accepted for all members: {', '.join(COURSE)}")
    given = COURSE | course
    numbers, functions = input_functions(model.inputs, given.pop("inputs") or {})
    if functions is not None:
        raise RequestError("inputs: members take numbers alone; functions go with simulate")
    mode = given.pop("mode")
    request = {"start": start(*(given.pop(name) for name in ("state", "q", "qdot", "p"))), "laws": laws(given.pop("law"))}
    return {"request": request | given, "inputs": numbers, "mode": mode}


def _members(
    model: Model, vary: Mapping[str, Any], table: Mapping[str, Sequence[float]] | None, members: int | None, seed: int | None,
) -> tuple[dict[str, Any], np.ndarray | None]:
    """The members in the form that the extension module accepts, and the rows of a table."""
    if members is not None and not (isinstance(members, int) and members > 0):
        raise RequestError(f"members: {members} is not accepted; expected a positive whole number")
    if seed is not None and not (isinstance(seed, int) and 0 <= seed < 1 << 64):
        raise RequestError(f"seed: {seed} is not accepted; expected a whole number from 0 to 2^64 - 1")
    rows = None
    if table is not None:
        if vary or members is not None or seed is not None:
            raise RequestError("table: its rows are the members; leave out vary, members and seed")
        rows = _rows(table)
        values = [(str(name), "list", []) for name in table]
        count = len(rows)
    else:
        values = [(name, *_values(name, given, members, seed is not None)) for name, given in vary.items()]
        count = _count(values, members, seed is not None)
    named = {name for name, _, _ in values}
    for name, value in model.parameters.items():
        if math.isnan(value) and name not in named:
            raise RequestError(f"parameter `{name}` has no default; give it by with_parameters({name}=..), or vary it")
    return {"values": values, "seed": seed, "count": count}, rows


def _rows(table: Mapping[str, Sequence[float]]) -> np.ndarray:
    import numpy as np

    columns = [np.asarray(table[name], dtype=np.float64) for name in table]
    if not columns or any(column.ndim != 1 or len(column) != len(columns[0]) for column in columns) or not len(columns[0]):
        raise RequestError("table: expected columns of one length, with a row for each member")
    rows = np.ascontiguousarray(np.stack(columns, axis=1))
    if not np.isfinite(rows).all():
        raise RequestError("table: expected finite numbers")
    return rows


def _values(name: str, given: Any, members: int | None, drawn: bool) -> tuple[str, list[float]]:
    """Kind and numbers of the values of a quantity."""
    def refuse(expected: str) -> RequestError:
        return RequestError(f"vary {name}: {given!r} is not accepted; expected {expected}")

    if isinstance(given, Normal):
        if not drawn:
            raise refuse("a range or a list, or a seed= to draw with")
        if not (math.isfinite(given.mean) and 0 <= given.deviation < math.inf):
            raise refuse("a finite mean and a deviation that is not negative")
        return "normal", [float(given.mean), float(given.deviation)]
    try:
        numbers = [float(number) for number in given]
    except (TypeError, ValueError):
        raise refuse("(low, high), (low, high, count), a list of values, or Normal(mean, deviation)") from None
    if not numbers or not all(math.isfinite(number) for number in numbers):
        raise refuse("finite numbers")
    if not isinstance(given, tuple):
        if drawn:
            raise refuse("(low, high) or Normal(mean, deviation), as members are drawn")
        return "list", numbers
    if drawn:
        if len(numbers) != 2:
            raise refuse("(low, high): with seed= the number of members is members=")
        return "uniform", numbers
    if len(numbers) == 2 and members is not None:
        return "spaced", [*numbers, float(members)]
    if len(numbers) == 3 and numbers[2] == int(numbers[2]) > 0:
        return "spaced", numbers
    raise refuse("(low, high, count) with a positive whole number, or (low, high) and members=")


def _count(values: list[tuple[str, str, list[float]]], members: int | None, drawn: bool) -> int:
    """Number of members."""
    if drawn:
        if members is None or not values:
            raise RequestError("seed: it needs members= and vary=, which name what is drawn")
        return members
    if not values and (members or 1) > 1:
        raise RequestError("members: all members are equal; name what varies by vary= or table=")
    count = math.prod(int(numbers[2]) if kind == "spaced" else len(numbers) for _, kind, numbers in values)
    if members is not None and members != count:
        raise RequestError(f"members: {members} is not accepted; expected {count}, the product of the counts in vary")
    return count


def density_of(
    quantities: Sequence[str] | Mapping[str, tuple[float, float] | None] | None, bins: int | tuple[int, int], every: float, discard: float,
) -> dict[str, Any] | None:
    """A density in the form that the extension module accepts."""
    if quantities is None:
        return None
    ranges = quantities if isinstance(quantities, Mapping) else dict.fromkeys(quantities)
    if isinstance(quantities, str) or len(ranges) != 2:
        raise RequestError("density: expected two quantities, as (\"x\", \"y\") or {\"x\": (-1, 1), \"y\": None}")
    for name, ends in ranges.items():
        if ends is not None and not (len(ends) == 2 and all(map(math.isfinite, ends)) and ends[0] < ends[1]):
            raise RequestError(f"density {name}: {ends!r} is not accepted; expected (low, high) with low below high")
    if not (math.isfinite(every) and every > 0):
        raise RequestError(f"every: {every} is not accepted; expected a positive number")
    if not (math.isfinite(discard) and discard >= 0):
        raise RequestError(f"discard: {discard} is not accepted; expected a number that is not negative")
    numbers = (bins, bins) if isinstance(bins, int) else tuple(bins)
    if len(numbers) != 2 or not all(isinstance(number, int) and number > 0 for number in numbers):
        raise RequestError(f"bins: {bins!r} is not accepted; expected a positive whole number, or two")
    axes = [(name, ends and [float(end) for end in ends], number) for (name, ends), number in zip(ranges.items(), numbers)]
    return {"axes": axes, "every": float(every), "discard": float(discard)}


def _identity(model: Model, spec: dict[str, Any], native: _native.NativeEnsemble, rows: np.ndarray | None) -> dict[str, Any]:
    """All data that rows and sums depend on, and the names of the columns."""
    varied = spec["varied"] | {"table": None if rows is None else hashlib.sha256(rows.tobytes()).hexdigest()}
    return {
        "version": _native.version(), "model": model.name, "scene": model._scene, "source": model.source,
        "parameters": dict(model.parameters), **spec, "varied": varied, "columns": native.columns(), "rows": "parquet",
    }


def _summary(kept: Directory, spec: dict[str, Any], native: _native.NativeEnsemble) -> dict[str, Any]:
    """Sums over all parts: whole numbers, exact sums and extremes, which do not depend on how members are divided."""
    parts = [kept.parts[first] for first in sorted(kept.parts)]
    outcomes: dict[str, int] = {}
    for part in parts:
        for kind, number in part["outcomes"].items():
            outcomes[kind] = outcomes.get(kind, 0) + number
    names = [name for name, kind in native.columns() if kind != "text"]
    statistics = {name: vars(_statistics([part["sums"][place] for part in parts])) for place, name in enumerate(names)}
    return {
        "members": sum(part["members"] for part in parts),
        "outcomes": dict(sorted(outcomes.items())),
        "not_reached": sum(part["not_reached"] for part in parts),
        "first_not_reached": [told for part in parts for told in part["first_not_reached"]][:TOLD],
        "energy_change": max(part["energy_change"] for part in parts),
        "energy_change_relative": max(part["energy_change_relative"] for part in parts),
        "statistics": statistics,
        "density": _density(kept, spec, native),
    }


def _statistics(sums: list[list[Any]]) -> Statistics:
    """Statistics from exact sums of numbers in units of 2^-1074 and of their squares in units of 2^-2148."""
    def whole(digits: str) -> int:
        return int.from_bytes(bytes.fromhex(digits), "little", signed=True)

    sums = [item for item in sums if item[0] > 0]
    count = sum(item[0] for item in sums)
    if count == 0:
        return Statistics(0, math.nan, math.nan, math.nan, math.nan)
    total, squares = sum(whole(item[3]) for item in sums), sum(whole(item[4]) for item in sums)
    std = math.nan
    if count > 1:
        try:
            # A quotient of whole numbers is rounded once.
            std = math.sqrt((count * squares - total * total) / (count * (count - 1) << 2148))
        except OverflowError:
            std = math.inf
    extremes = min(item[1] for item in sums), max(item[2] for item in sums)
    return Statistics(count, total / (count << 1074), std, *extremes)


def _density(kept: Directory, spec: dict[str, Any], native: _native.NativeEnsemble) -> dict[str, Any] | None:
    import numpy as np

    if spec["density"] is None:
        return None
    counts = sum(np.frombuffer(part, dtype="<u8") for part in kept.counts())
    states, outside = native.states(counts.tobytes())
    keys = ("part", "states", "halves_of_time", "halves_of_members", "independent")
    convergence = [dict(zip(keys, row)) for row in native.convergence(counts.tobytes())]
    return {**spec["density"], "counts": states, "outside": outside, "convergence": convergence}


@contextmanager
def _shown(shows: bool, count: int, name: str, done: int) -> Iterator[Callable[[int], Any]]:
    """A function that shows the number of finished members, by tqdm; without tqdm, an error."""
    if not shows:
        yield lambda members: None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        raise RequestError("progress: it needs tqdm; install it, or leave progress out") from None
    with tqdm(total=count, initial=done, desc=name, unit="members") as bar:
        yield bar.update
