"""Pictures of runs, by matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Sequence

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ._run import Run

#: Points of the grid on which the border of a region is looked for, along each axis.
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
    times, path = _with_corners(run, "view")
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
    shown = run._native.samples.view
    low, high = shown.min(axis=0), shown.max(axis=0)
    margin = 0.25 * (high - low).max()
    x, y = (np.linspace(low[k] - margin, high[k] + margin, GRID) for k in range(2))
    q = np.tile(run.q[-1], (GRID * GRID, 1))
    q[:, plane[0]], q[:, plane[1]] = (grid.ravel() for grid in np.meshgrid(x, y))
    values = run.model._native.region(run.outcome.t, q).reshape(GRID, GRID)
    if np.nanmin(values) < 0 < np.nanmax(values):
        ax.contour(x, y, values, levels=[0], colors="0.4", linewidths=1)


def _curves(run: Run, ax: Axes, across: str, names: Sequence[str]) -> None:
    _, x = _with_corners(run, across)
    for name in names:
        _, y = _with_corners(run, name)
        ax.plot(x, y, label=name, linewidth=1)
    ax.set_xlabel(across)
    ax.set_ylabel(names[0] if len(names) == 1 else "")
    if len(names) > 1:
        ax.legend()


def _with_corners(run: Run, name: str) -> tuple[np.ndarray, np.ndarray]:
    """A quantity at the times of the samples and at both sides of every impact, so that corners and jumps are drawn."""
    from ._run import _column

    samples, impacts = run._native.samples, run._native.impacts
    tables = [samples, impacts.before, impacts.after]
    values = [table.view if name == "view" else _column(run.model, table, name) for table in tables]
    times = np.concatenate([table.t for table in tables])
    # A sample at the time of an impact shows the state after it: before, after, sample.
    rank = np.concatenate([np.full(len(table.t), place) for table, place in zip(tables, (2, 0, 1))])
    count = len(impacts.before.t)
    number = np.concatenate([np.full(len(samples.t), count), np.arange(count), np.arange(count)])
    order = np.lexsort((rank, number, times))
    return times[order], np.concatenate(values)[order]
