"""Tables and pictures."""

import numpy as np
import pytest

import dalembert


@pytest.fixture(scope="module")
def run():
    return dalembert.models.rolling_disk.simulate(until=20)


def test_tables_of_pandas(run):
    pytest.importorskip("pandas")
    table = run.to_pandas()
    assert list(table) == ["t", "x", "y", "theta", "phi", "x_dot", "y_dot", "theta_dot", "phi_dot", "energy"]
    np.testing.assert_array_equal(table["theta"], run["theta"])


@pytest.mark.parametrize(("module", "method"), [("polars", "to_polars"), ("pyarrow", "to_arrow"), ("xarray", "to_xarray")])
def test_other_tables(run, module, method):
    pytest.importorskip(module)
    table = getattr(run, method)()
    np.testing.assert_array_equal(np.asarray(table["theta"]), run["theta"])
    np.testing.assert_array_equal(np.asarray(table["t"]), run.t)


def test_names_that_are_none(run):
    with pytest.raises(KeyError, match="`psi` is no quantity of rolling_disk; accepted: t, x, y"):
        run["psi"]


def test_pictures(run):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (view, curves, phase) = plt.subplots(1, 3)
    assert run.plot(ax=view) is view
    assert view.get_aspect() == 1.0
    path = view.lines[0].get_xydata()
    assert len(path) == len(run.t) + 2 * len(run.events)
    # The border of the table is drawn.
    [border] = view.collections
    [outline] = border.get_paths()
    x, y = outline.vertices.T
    np.testing.assert_allclose((x / 0.15) ** 2 + (y / 0.20) ** 2, 1, atol=1e-3)
    run.plot("t", "theta_dot", ax=curves)
    drawn = curves.lines[0].get_xydata()
    assert np.all(np.diff(drawn[:, 0]) >= 0)
    assert curves.get_xlabel() == "t" and curves.get_ylabel() == "theta_dot"
    run.plot("theta", "theta_dot", "phi_dot", ax=phase)
    assert len(phase.lines) == 2
    figure.canvas.draw()
    plt.close(figure)
