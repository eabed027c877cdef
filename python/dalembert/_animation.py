"""Animations of runs, with matplotlib and on an HTML canvas."""

from __future__ import annotations

import json
import secrets
from dataclasses import dataclass
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._plot import border, with_corners

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.axes import Axes

    from ._run import Run

#: Points per side of the grid on which a moving border is computed.
COARSE = 90

#: A path on an HTML page has less than twice this number of points.
POINTS = 4000


@dataclass(frozen=True)
class Curve:
    """One line of the picture: the path with its times, the position of its head in each frame, the impacts."""

    label: str
    times: np.ndarray
    path: np.ndarray
    heads: np.ndarray
    impacts: np.ndarray


class Animation:
    """An animation of a run. In a notebook it plays on a canvas, which needs no library.

    Attributes
    ----------
    run : Run
        The run.
    times : array
        Times of the frames, equally spaced.
    fps : float
        Frames per second.
    """

    def __init__(self, run: Run, duration: float, fps: float) -> None:
        if not (duration > 0 and fps > 0):
            raise ValueError("duration and fps: expected positive numbers")
        self.run = run
        self.fps = fps
        self.times = np.linspace(0.0, run.outcome.t, max(2, round(duration * fps)))

    # Content ---------------------------------------------------------------------------------------------------------------

    @cached_property
    def curves(self) -> tuple[Curve, ...]:
        """The declared view, or each coordinate over time."""
        samples, view = self.run(self.times), self.run.model.view
        impacts = self.run._native.impacts.before
        if view is not None:
            times, path = with_corners(self.run, "view")
            return (Curve("", times, path, samples.view, np.column_stack([impacts.t, impacts.view])),)
        curves = []
        for place, name in enumerate(self.run.model.coordinates):
            times, values = with_corners(self.run, name)
            met = np.column_stack([impacts.t, impacts.t, impacts.q[:, place]])
            heads = np.column_stack([self.times, samples[name]])
            curves.append(Curve(name, times, np.column_stack([times, values]), heads, met))
        return tuple(curves)

    @cached_property
    def labels(self) -> tuple[str, str]:
        """The labels of the axes."""
        view = self.run.model.view
        if view is not None:
            return tuple(view[0])
        return "t", ", ".join(self.run.model.coordinates)

    @cached_property
    def box(self) -> tuple[float, float, float, float]:
        """The part of the plane that is shown: left, right, low, high."""
        points = np.concatenate([part for curve in self.curves for part in (curve.path, curve.heads)])
        points = points[np.isfinite(points).all(axis=1)]
        drawn = [points, *(line.reshape(-1, 2) for line in self.borders)]
        low, high = np.min([part.min(axis=0) for part in drawn if len(part)], axis=0), np.max(
            [part.max(axis=0) for part in drawn if len(part)], axis=0,
        )
        margin = 0.05 * np.where(high > low, high - low, 1.0)
        (left, low), (right, high) = low - margin, high + margin
        return float(left), float(right), float(low), float(high)

    @cached_property
    def borders(self) -> tuple[np.ndarray, ...]:
        """The border of the declared region as segments: one array, or one for each frame if the border moves."""
        view = self.run.model.view
        if view is None or view[1] is None or not view[2]:
            return ()
        first, last = (border(self.run, t, COARSE) for t in self.times[[0, -1]])
        if np.array_equal(first, last):
            return (border(self.run, self.times[-1]),)
        return tuple(border(self.run, t, COARSE) for t in self.times)

    # By matplotlib ---------------------------------------------------------------------------------------------------------

    def to_matplotlib(self, ax: Axes | None = None) -> FuncAnimation:
        """The animation with matplotlib. Keep a reference to the result while it plays.

        Parameters
        ----------
        ax : matplotlib axes, optional
            The axes to draw on. Default: those of a new figure.

        Returns
        -------
        matplotlib.animation.FuncAnimation
            The animation. Its method ``save`` writes a file.
        """
        import matplotlib.pyplot as plt
        from matplotlib.animation import FuncAnimation
        from matplotlib.collections import LineCollection

        ax = plt.subplots()[1] if ax is None else ax
        left, right, low, high = self.box
        ax.set(xlim=(left, right), ylim=(low, high), xlabel=self.labels[0], ylabel=self.labels[1])
        if self.run.model.view is not None:
            ax.set_aspect("equal", adjustable="box")
        walls = ax.add_collection(LineCollection([], colors="0.4", linewidths=1))
        lines = [ax.plot([], [], linewidth=0.8, label=curve.label or None)[0] for curve in self.curves]
        met = [ax.plot([], [], ".", color="C3")[0] for _ in self.curves]
        heads = [ax.plot([], [], "o", color=line.get_color())[0] for line in lines]
        if len(lines) > 1:
            ax.legend(loc="upper right")

        def draw(frame: int) -> list[Any]:
            t = self.times[frame]
            ax.set_title(f"{self.run.model.name}: t = {t:.6g}")
            if self.borders:
                walls.set_segments(list(self.borders[min(frame, len(self.borders) - 1)]))
            for curve, line, dots, head in zip(self.curves, lines, met, heads):
                path = curve.path[: np.searchsorted(curve.times, t, side="right")]
                line.set_data(*np.concatenate([path, curve.heads[frame : frame + 1]]).T)
                dots.set_data(*curve.impacts[curve.impacts[:, 0] <= t, 1:].T)
                head.set_data(*curve.heads[frame : frame + 1].T)
            return [walls, *lines, *met, *heads]

        return FuncAnimation(ax.figure, draw, frames=len(self.times), interval=1000 / self.fps)

    def save(self, path: str, **arguments: Any) -> None:
        """Write the animation to a file with matplotlib (``run.gif``, ``run.mp4``), or as a page (``run.html``).

        Parameters
        ----------
        path : str
            The file.
        **arguments
            Further arguments of ``FuncAnimation.save``.
        """
        if str(path).endswith(".html"):
            with open(path, "w", encoding="utf-8") as file:
                file.write(f"<!DOCTYPE html><meta charset='utf-8'><title>{escape(self.run.model.name)}</title>{self.to_html()}")
            return
        import matplotlib.pyplot as plt

        moving = self.to_matplotlib()
        moving.save(path, **{"fps": self.fps, **arguments})
        plt.close(moving._fig)

    # In a page -------------------------------------------------------------------------------------------------------------

    def data(self) -> dict[str, Any]:
        """The data that the page plays, for JSON."""
        left, right, low, high = self.box
        shown = self.run.model.view is not None
        shape = (high - low) / (right - left) if shown else 0.5
        return {
            "title": f"{self.run.model.name}: {self.run.outcome.kind}",
            "labels": self.labels,
            "box": self.box,
            "ticks": [_ticks(left, right), _ticks(low, high)],
            "equal": shown,
            "height": round(float(np.clip(572 * shape, 200, 572))) + 62,
            "fps": self.fps,
            "times": self.times.tolist(),
            "borders": [_numbers(lines) for lines in self.borders],
            "curves": [_curve(curve) for curve in self.curves],
        }

    def to_html(self) -> str:
        """The animation as HTML with its own script: a canvas, a button and a slider."""
        data = json.dumps(self.data(), allow_nan=False, separators=(",", ":"))
        return _native.player(f"dalembert-{secrets.token_hex(6)}", data)

    def _repr_html_(self) -> str:
        return self.to_html()

    def __repr__(self) -> str:
        return f"Animation of {self.run.model.name}: {len(self.times)} frames, {len(self.times) / self.fps:g} s"


def _curve(curve: Curve) -> dict[str, Any]:
    stride = max(1, len(curve.times) // POINTS)
    return {
        "label": curve.label, "times": curve.times[::stride].tolist(), "path": _numbers(curve.path[::stride]),
        "heads": _numbers(curve.heads), "impacts": _numbers(curve.impacts),
    }


def _numbers(values: np.ndarray) -> list[Any]:
    """Six digits of each number; None for a number that is not finite."""
    if values.ndim > 1:
        return [_numbers(row) for row in values]
    return [float(f"{value:.6g}") if np.isfinite(value) else None for value in values.tolist()]


def _ticks(low: float, high: float) -> list[float]:
    """Round numbers within a range."""
    size = 10.0 ** np.floor(np.log10((high - low) / 4))
    size *= next(factor for factor in (1, 2, 5, 10) if factor * size >= (high - low) / 5)
    return [float(f"{size * place:.6g}") for place in range(int(np.ceil(low / size)), int(np.floor(high / size)) + 1)]
