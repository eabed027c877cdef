"""The numbers are those of the command line, to the bit."""

import csv
import io

import numpy as np
import pytest

import dalembert

#: Flags of the command, and arguments in Python, of the same run.
RUNS = {
    "rolling_disk": (["--until", "40", "--initial", "theta_dot=12"], {"until": 40, "state": {"theta_dot": 12}}),
    "chaplygin_sleigh": (["--until", "20", "--integrator", "taylor"], {"until": 20, "integrator": "taylor"}),
    "double_pendulum": (
        ["--integrator", "gauss6", "--step", "0.01", "--until", "10"], {"integrator": "gauss6", "step": 0.01, "until": 10},
    ),
    "bouncing_ball": (
        ["--law", "newton:0.5", "--rest", "contact", "--until", "10"], {"law": "newton:0.5", "rest": "contact", "until": 10},
    ),
    "point_billiard": (["--impacts", "50", "--samples", "200"], {"impacts": 50, "samples": 200}),
    "two_wheels_rod": (["--form", "global", "--tol", "1e-8"], {"form": "global", "tol": 1e-8}),
    "tent_map": ([], {}),
    "dimensionless_walker": ([], {}),
    "spring_mass_walker": ([], {}),
    "rolling_ball_euler": (["--set", "k=0.5", "--integrator", "dopri5"], {"integrator": "dopri5"}),
}
PARAMETERS = {"rolling_ball_euler": {"k": 0.5}}


@pytest.mark.parametrize("name", RUNS)
def test_samples_and_impacts_have_the_same_bits(command, name):
    flags, arguments = RUNS[name]
    rows = list(csv.DictReader(io.StringIO(command("simulate", name, *flags, "--csv", "-"))))
    model = getattr(dalembert.models, name).with_parameters(**PARAMETERS.get(name, {}))
    run = model.simulate(**arguments)
    samples = [row for row in rows if not row["event"]]
    events = [row for row in rows if row["event"]]
    columns = run.columns()
    assert list(columns) == [column for column in rows[0] if column != "event"]
    assert len(samples) == len(run.t) > 100
    for column, values in columns.items():
        if column == "mode":
            assert [row["mode"] for row in samples] == list(values)
            continue
        told = np.array([float(row[column] or "nan") for row in samples])
        np.testing.assert_array_equal(told.view(np.int64), canonical(values).view(np.int64), column)
    assert [row["event"] for row in events] == list(run.events["surface"])
    for column in [*model.coordinates, *model.velocities]:
        told = np.array([float(row[column] or "nan") for row in events])
        values = canonical(run.events["after"][column])
        np.testing.assert_array_equal(told.view(np.int64), values.view(np.int64), column)


def canonical(values):
    """The values with the same bits for every NaN: a table does not keep the bits of a NaN."""
    return np.where(np.isnan(values), np.nan, values)


def test_derivations_are_those_of_the_command(command):
    for name in ["rolling_disk", "double_pendulum", "dimensionless_walker", "tent_map"]:
        derivation = getattr(dalembert.models, name).derive()
        assert command("derive", name).strip() == derivation.text.strip()
        assert command("derive", name, "--format", "latex").strip() == derivation.latex.strip()
