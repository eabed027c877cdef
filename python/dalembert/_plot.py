"""Pictures of runs, by matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Sequence

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ._run import Run

#: Number of points along each axis of the grid on which the border of a region is computed.
GRID = 300


def plot(run: Run, quantities: Sequence[str], ax: Axes | None) -> Axes:
    """The picture of a run: see :meth:`Run.plot`."""
    import matplotlib.pyplot as plt

    ax = plt.gca() if ax is None else ax
    ax.set_title(f"{run.model.name}: {run.outcome.kind} at t = {run.outcome.t:.6g}")
    if not quantities and run.model.view is not None:
        _view(run, ax)
    elif len(quantities) > 1 and quantities[0] != "t":
        _curves(run, ax, quantities[0], quantities[1:])
    else:
        _curves(run, ax, "t", [name for name in quantities if name != "t"] or run.model.coordinates)
    return ax


def _view(run: Run, ax: Axes) -> None:
    labels, plane, has_region = run.model.view
    times, path = with_corners(run, "view")
    ax.plot(*path.T, linewidth=0.8)
    ax.plot(*path[0], "o", markersize=4, color="C2")
    at = run._native.impacts.before.view
    ax.plot(*at.T, ".", color="C3", zorder=3)
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel(labels[0])
    ax.set_ylabel(labels[1])
    if has_region and plane is not None:
        _region(run, ax, plane)


def _region(run: Run, ax: Axes, plane: Sequence[int]) -> None:
    """The border of the region, in the coordinates that the view shows, at the end of the run."""
    x, y, values = _region_values(run, run.outcome.t, plane, GRID)
    if np.nanmin(values) < 0 < np.nanmax(values):
        ax.contour(x, y, values, levels=[0], colors="0.4", linewidths=1)


def _region_values(run: Run, t: float, plane: Sequence[int], count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The function of the region at a time, on a grid around the path."""
    shown = run._native.samples.view
    low, high = shown.min(axis=0), shown.max(axis=0)
    margin = 0.25 * (high - low).max()
    x, y = (np.linspace(low[k] - margin, high[k] + margin, count) for k in range(2))
    q = np.tile(run.q[-1], (count * count, 1))
    q[:, plane[0]], q[:, plane[1]] = (grid.ravel() for grid in np.meshgrid(x, y))
    return x, y, run.model._native.region(t, q).reshape(count, count)


def border(run: Run, t: float, count: int = GRID) -> np.ndarray:
    """The border of the region at a time, as segments: an array with a start and an end in each."""
    x, y, values = _region_values(run, t, run.model.view[1], count)
    # Each square of the grid is cut into two triangles, in each of which the border is one segment.
    index = np.arange(count * count).reshape(count, count)
    corners = [index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]]
    triangles = np.concatenate([np.stack([corners[k] for k in item], -1).reshape(-1, 3) for item in [(0, 1, 2), (0, 2, 3)]])
    places = np.stack(np.meshgrid(x, y), -1).reshape(-1, 2)
    level = values.ravel()
    inside = level[triangles] > 0
    triangles = triangles[np.isfinite(level[triangles]).all(1) & (inside.any(1) & ~inside.all(1))]
    # The corner that lies alone on its side of the border comes first.
    inside = level[triangles] > 0
    alone = np.argmax(inside == (inside.sum(1) == 1)[:, None], axis=1)
    first, second, third = (triangles[np.arange(len(triangles)), (alone + k) % 3] for k in range(3))

    def crossing(other: np.ndarray) -> np.ndarray:
        part = level[first] / (level[first] - level[other])
        return places[first] + part[:, None] * (places[other] - places[first])

    return np.stack([crossing(second), crossing(third)], axis=1)


def _curves(run: Run, ax: Axes, across: str, names: Sequence[str]) -> None:
    _, x = with_corners(run, across)
    for name in names:
        _, y = with_corners(run, name)
        ax.plot(x, y, label=name, linewidth=1)
    ax.set_xlabel(across)
    ax.set_ylabel(names[0] if len(names) == 1 else "")
    if len(names) > 1:
        ax.legend()


def with_corners(run: Run, name: str) -> tuple[np.ndarray, np.ndarray]:
    """A quantity at the times of the samples and at both sides of every impact, so that corners and jumps are drawn."""
    from ._run import _column

    samples, impacts = run._native.samples, run._native.impacts
    tables = [samples, impacts.before, impacts.after]
    values = [table.view if name == "view" else _column(run.model, table, name) for table in tables]
    times = np.concatenate([table.t for table in tables])
    # At equal times the order is before, after, sample: a sample at an impact shows the state after it.
    rank = np.concatenate([np.full(len(table.t), place) for table, place in zip(tables, (2, 0, 1))])
    count = len(impacts.before.t)
    number = np.concatenate([np.full(len(samples.t), count), np.arange(count), np.arange(count)])
    order = np.lexsort((rank, number, times))
    return times[order], np.concatenate(values)[order]
