"""Notebooks run from the first cell to the last, stay short, and draw pictures."""

import ast
import json
import os
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))
#: Limit for the lines of code of a notebook.
LINES = 40
#: Folder for the pictures, if they are to be kept.
PICTURES = os.environ.get("NOTEBOOK_PICTURES")


def cells(path):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    assert notebook["nbformat"] == 4
    return notebook["cells"]


def run(source, names, place):
    """Executes a cell, and returns the value of its last expression, which a notebook shows."""
    tree = ast.parse(source)
    shown = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, place, "exec"), names)
    if shown is not None:
        return eval(compile(ast.Expression(shown.value), place, "eval"), names)
    return None


@pytest.mark.parametrize("path", NOTEBOOKS, ids=[path.stem for path in NOTEBOOKS])
def test_notebooks_run_and_draw(path, tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.close("all")
    names, shown, drawn = {}, [], 0
    for number, cell in enumerate(cells(path)):
        if cell["cell_type"] == "code":
            shown.append(run("".join(cell["source"]), names, f"{path.name}, cell {number}"))
        # As in a notebook, the figures of a cell are complete at its end.
        for figure in map(plt.figure, plt.get_fignums()):
            assert any(axes.lines or axes.images for axes in figure.axes), number
            figure.savefig(Path(PICTURES or tmp_path) / f"{path.stem}{number}.png", dpi=80)
            drawn += 1
        plt.close("all")
    assert drawn >= 2
    # At least one cell shows a model, a derivation or verdicts, as formulas or a table.
    assert any(hasattr(value, "_repr_html_") or isinstance(value, (list, tuple)) for value in shown)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=[path.stem for path in NOTEBOOKS])
def test_notebooks_are_short_and_have_no_outputs(path):
    code = [cell for cell in cells(path) if cell["cell_type"] == "code"]
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in code)
    lines = [line for cell in code for line in "".join(cell["source"]).splitlines() if line.strip()]
    assert len(lines) < LINES
