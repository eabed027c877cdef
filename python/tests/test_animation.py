"""Animations: frames of matplotlib, and the script of the canvas."""

import json
import re
import shutil
import subprocess

import numpy as np
import pytest
from conftest import BALL

import dalembert
from dalembert import Model

#: A page for the script. Its pen records all calls. The frames are drawn one after the other.
PAGE = """
const told = [];
const pen = new Proxy({}, { get: (target, name) => (...given) => told.push([name, ...given]), set: () => true });
const listeners = {};
const part = (given) => ({ style: {}, addEventListener: (name, call) => { listeners[name] = call; }, ...given });
const parts = { canvas: part({ getContext: () => pen }), button: part({}), input: part({ value: 0 }) };
const root = { querySelector: (name) => parts[name], isConnected: true };
globalThis.window = {};
globalThis.document = { getElementById: () => root };
SCRIPT
const counts = [];
for (let frame = 0; frame <= parts.input.max; frame++) {
  told.length = 0;
  parts.input.value = frame;
  listeners.input();
  counts.push(told.filter(([name]) => name === "arc").length);
}
const heads = told.filter(([name]) => name === "arc").pop().slice(1, 3);
const lines = told.filter(([name]) => name === "lineTo").length;
console.log(JSON.stringify({ counts, heads, lines, button: parts.button.textContent }));
"""


@pytest.fixture(scope="module")
def animation():
    run = dalembert.models.rolling_disk.simulate(until=20, state={"theta_dot": 12})
    return run.animate(duration=4, fps=10)


def test_the_view_moves_in_matplotlib(animation):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    moving = animation.to_matplotlib()
    walls, path, impacts, head = moving._draw_frame(20) or moving._func(20)
    ax = moving._fig.axes[0]
    assert ax.get_aspect() == 1.0
    np.testing.assert_array_equal(head.get_xydata()[0], animation.run(animation.times[20]).view)
    met = animation.run.events["t"] <= animation.times[20]
    assert 0 < len(impacts.get_xydata()) == met.sum() < len(met)
    # The border is that of the table, an ellipse.
    x, y = np.concatenate(walls.get_segments()).T
    np.testing.assert_allclose((x / 0.15) ** 2 + (y / 0.20) ** 2, 1, atol=1e-3)
    assert len(x) > 500
    moving._draw_was_started = True
    plt.close(moving._fig)


def test_the_canvas_draws_impacts_and_heads(animation):
    node = shutil.which("node")
    if node is None:
        pytest.skip("no `node`")
    html = animation._repr_html_()
    [script] = re.findall(r"<script>(.*)</script>", html, re.DOTALL)
    shown = subprocess.run([node, "-"], input=PAGE.replace("SCRIPT", script), capture_output=True, text=True, check=True)
    drawn = json.loads(shown.stdout)
    times = animation.run.events["t"]
    assert drawn["counts"] == [1 + int((times <= t).sum()) for t in animation.times]
    assert drawn["button"] == "▶" and drawn["lines"] > 1000
    # Both axes have the same scale, and the middle of the box is the middle of the picture.
    left, right, low, high = animation.box
    x, y = animation.run(20).view
    height = animation.data()["height"]
    unit = min((640 - 68) / (right - left), (height - 62) / (high - low))
    expected = [56 + 572 / 2 + (x - (left + right) / 2) * unit, 26 + (height - 62) / 2 - (y - (low + high) / 2) * unit]
    np.testing.assert_allclose(drawn["heads"], expected, atol=1e-2)


def test_coordinates_move_over_time_without_a_view():
    animation = Model.from_text(BALL).simulate(until=1).animate(duration=1)
    assert animation.labels == ("t", "x") and animation.borders == ()
    [curve] = animation.curves
    np.testing.assert_allclose(curve.heads[:, 0], animation.times)
    assert len(curve.impacts) == len(animation.run.events)
    assert "1 s" in repr(animation)
    with pytest.raises(ValueError, match="expected positive numbers"):
        animation.run.animate(fps=0)


def test_a_border_that_moves_is_drawn_in_each_frame():
    text = """
        Balloon {
            coordinates { x; y; }
            lagrangian = dot(x)^2/2 + dot(y)^2/2;
            impacts { wall: x^2 + y^2 <= (1 + t/2)^2 => elastic; }
            view { path: (x, y); region: x^2 + y^2 <= (1 + t/2)^2; }
            initial { x = 0; y = 1/2; dot(x) = 2; dot(y) = 0; until = 2; }
        }
    """
    animation = Model.from_text(text).simulate().animate(duration=1, fps=5)
    assert len(animation.borders) == len(animation.times) == 5
    for t, border in zip(animation.times[:3], animation.borders):
        np.testing.assert_allclose(np.hypot(*border.reshape(-1, 2).T), 1 + t / 2, rtol=2e-3)


def test_animations_are_files(animation, tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    pytest.importorskip("PIL")
    matplotlib.use("Agg")
    animation.run.animate(duration=0.4, fps=5).save(tmp_path / "run.gif")
    assert (tmp_path / "run.gif").read_bytes().startswith(b"GIF8")
    animation.save(tmp_path / "run.html")
    assert "<canvas>" in (tmp_path / "run.html").read_text(encoding="utf-8")


def test_names_do_not_end_the_script(animation, monkeypatch):
    monkeypatch.setitem(vars(animation), "labels", ("</script><b>", "y"))
    assert animation.to_html().count("</script>") == 1
