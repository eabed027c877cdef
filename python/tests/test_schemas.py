"""JSON documents of the command line satisfy the schemas in docs/reference/schemas."""

import json
from pathlib import Path

import jsonschema
import pytest

SCHEMAS = Path(__file__).parents[2] / "docs" / "reference" / "schemas"
#: A model with an input, and a parameter without default: no shipped model has both.
DRIVEN = """
Ball {
    coordinates { x; }
    parameters { g > 0 = 1; k >= 0; }
    lagrangian = dot(x)^2/2 - g*x;
    inputs { push; }
    forces { pull: k*push*d(x); }
    impacts { floor: x >= 0 => newton(1/2); }
    initial { x = 1; until = 1; }
}
"""
#: Schemas with the command lines whose output they describe.
OUTPUTS = {
    "list": [["list"], ["list", "--format", "json"]],
    "derive": [
        *(["derive", name, "--format", "json"] for name in ("rolling_disk", "tent_map", "dimensionless_walker")),
        ["derive", "rolling_disk", "--bracket", "x,momentum(theta)", "--format", "json"],
        ["derive", "rolling_disk", "--group", "partial(x),partial(y)", "--format", "json"],
    ],
    "check": [
        ["check", name, "--format", "json"]
        for name in ("rolling_disk", "tent_map", "chaplygin_sleigh", "rolling_ball_euler", "spring_mass_walker")
    ],
    "bendixson": [
        ["check", name, "--bendixson", "--format", "json"] for name in ("rimless_wheel_five", "rolling_disk", "bouncing_ball")
    ],
    "simulate": [
        ["simulate", "rolling_disk", "--law", "leading_edge=stop"],
        ["simulate", "bouncing_ball", "--output", "S = integral(lagrangian)"],
        ["simulate", "rolling_disk", "--verify"],
        ["simulate", "rolling_disk", "--until", "100", "--verify"],
        ["simulate", "bouncing_ball", "--law", "newton:0.5", "--until", "10"],
        ["simulate", "bouncing_ball", "--law", "newton:0.5", "--until", "10", "--rest", "contact"],
        ["simulate", "rolling_disk", "--law", "totally_plastic"],
        ["simulate", "double_pendulum", "--integrator", "gauss4", "--step", "0.01", "--steps", "5"],
        ["simulate", "double_pendulum", "--max-step", "0.1"],
        ["simulate", "bouncing_ball", "--q", "-1", "--qdot", "0"],
        ["simulate", "tent_map"],
        ["simulate", "spring_mass_walker"],
        ["simulate", "ball_on_switching_table"],
    ],
    "certify": [
        ["simulate", "point_billiard", "--set", "ta=1", "--certify", "--impacts", "2"],
        ["simulate", "bouncing_ball", "--certify", "--until", "9", "--certify-within", "x=0.5..1.5"],
    ],
    "orbit": [
        ["orbit", "dimensionless_walker", "--surface", "step"],
        ["orbit", "bouncing_ball", "--surface", "floor", "--until", "0.1"],
        ["orbit", "rolling_disk", "--surface", "leading_edge", "--until", "5"],
    ],
    "branch": [
        ["orbit", "compass_walker", "--surface", "heel", "--continue", "gamma=0.012..0.016"],
        ["orbit", "dimensionless_walker", "--surface", "step", "--continue", "alpha=0.1..0.2", "--set", "alpha=0.2"],
        ["orbit", "bouncing_ball", "--surface", "floor", "--until", "0.1", "--continue", "g=1..2"],
    ],
    "connect": [
        ["connect", "bouncing_ball", "--from", "x=0", "--to", "x=0.2", "--time", "5", "--impacts", "0..3", "--envelope", "5"],
        ["connect", "point_billiard", "--to", "x=0.5,y=0", "--time", "1", "--impacts", "1"],
        ["connect", "rolling_disk", "--to", "x=0.05,y=0.02", "--time", "1", "--energy", "1e-5"],
    ],
    "linearise": [
        ["linearise", "dimensionless_walker", "--trim"],
        ["linearise", "rolling_disk", "--trim=turn", "--moving", "x,y,theta"],
        ["linearise", "bouncing_ball", "--trim"],
        ["linearise", "bouncing_ball", "--every", "0.5", "--samples", "2"],
    ],
    "control": [
        ["control", "controlled_ball", "--impacts", "0..1", "--starts", "24"],
        ["control", "controlled_ball", "--initial", "x=1", "--end", "x=1,y=0", "--impacts", "1", "--starts", "48"],
        ["control", "controlled_ball", "--impacts", "0", "--starts", "24", "--vary", "x=-1,1"],
        ["control", "controlled_ball", "--impacts", "0..1", "--starts", "24", "--vary", "e=0.8,1"],
    ],
    "control_grid": [
        ["control", "controlled_ball", "--dp", "x=0..3:5,y=-6..6:5,u=-4..4:5", "--steps", "10", "--path", "x=0.5", "--path", "x=4"],
        ["control", "controlled_ball", "--dp", "x=0..1.5:5,y=-6..0:5,u=-1..1:3", "--steps", "4", "--impacts", "0", "--starts", "24",
         "--at", "2.5"],
    ],
    "accuracy": [
        ["accuracy", "bouncing_ball", "--until", "2", "--rounds", "1", "--wanted", "1e-6"],
        ["accuracy", "bouncing_ball", "--until", "2", "--rounds", "1", "--integrator", "dopri5", "--wanted", "1e-30"],
    ],
    "errata": [["errata"]],
    "map": [
        ["map", "dimensionless_walker", "--vary", "eta=-2..2:4", "--vary", "xi=-3..1:4", "--returns", "5", "--fail", "theta > pi/2",
         "--contour", "xi = eta"],
        ["map", "double_pendulum", "--vary", "theta1=0..1:3", "--until", "1", "--class", "theta2"],
    ],
    "ensemble": [
        ["ensemble", "bouncing_ball", "--vary", "x=0.5..2:4", "--vary", "g=1,2", "--law", "floor=newton:0.5"],
        ["ensemble", "double_pendulum", "--random", "7", "--members", "5", "--vary", "theta1=1+-0.01", "--vary", "theta2=0..1", "--until", "2",
         "--density", "theta1,theta2:8"],
    ],
}
LINES = [(name, line) for name, lines in OUTPUTS.items() for line in lines]
STATES = [
    ("bouncing_ball", [{"q": [1], "qdot": [-2]}, {"q": [1], "p": [0.5]}]),
    ("rolling_disk", [{"q": [0.1, 0, 0.2, 0.3], "qdot": [0, 0, 10, 1]}]),
    ("tent_map", None),
    ("walker_foot_slip", [{"q": [0, 0.25], "qdot": [0.75, -1.5]}]),
    ("appell_hamel", [{"q": [0, 0, 0], "qdot": [0, 0, 0]}]),
]


def validator(name):
    schema = json.loads((SCHEMAS / f"{name}.json").read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def check(name, text):
    document = json.loads(text)
    validator(name).validate(document)
    return document


def printed(line):
    """The command line, with its document on the standard output."""
    return line if "--format" in line else [*line, "--json", "-"]


@pytest.mark.parametrize(("name", "line"), LINES, ids=[" ".join(line) for _, line in LINES])
def test_documents_satisfy_their_schemas(command, name, line):
    check(name, command(*printed(line)))


@pytest.mark.parametrize(("model", "states"), STATES, ids=[model for model, _ in STATES])
def test_evaluations_satisfy_their_schema(command, tmp_path, model, states):
    if states is None:
        states = [{"q": [0.5] * len(next(it for it in json.loads(command("list", "--format", "json")) if it["name"] == model)["coordinates"])}]
    path = tmp_path / "states.json"
    path.write_text(json.dumps(states))
    document = check("eval", command("eval", model, "--newton", "0.5", "--input", path))
    assert len(document) == len(states)


def test_metadata_of_ensembles_satisfy_their_schema(command, tmp_path):
    listed = tmp_path / "members.csv"
    listed.write_text("x,g\n1,1\n2,1\n")
    for number, flags in enumerate([["--from", listed], ["--vary", "x=1..2:3"], ["--vary", "x=1,2", "--density", "x,x_dot:5"]]):
        rows = tmp_path / f"{number}.csv"
        command("ensemble", "bouncing_ball", *flags, "--csv", rows)
        check("ensemble_metadata", rows.with_name(f"{number}.csv.meta.json").read_text())


def test_models_of_files_satisfy_the_schemas(command, tmp_path):
    path = tmp_path / "ball.dal"
    path.write_text(DRIVEN)
    document = check("check", command("check", path, "--format", "json"))
    assert document["parameters"][1]["default"] is None
    document = check("simulate", command("simulate", path, "--set", "k=1", "--input", "push=2", "--json", "-"))
    assert document["inputs"] == {"push": 2.0}


def test_every_schema_refuses_other_documents(command):
    """A schema that accepts everything would prove nothing."""
    for name, lines in OUTPUTS.items():
        document = json.loads(command(*printed(lines[0])))
        whole = document[0] if isinstance(document, list) else document
        whole["unknown"] = 1
        with pytest.raises(jsonschema.ValidationError):
            validator(name).validate(document)
        del whole["unknown"]
        del whole[next(iter(whole))]
        with pytest.raises(jsonschema.ValidationError):
            validator(name).validate(document)


def test_the_page_names_every_schema():
    page = (SCHEMAS.parent / "json.md").read_text()
    for path in SCHEMAS.glob("*.json"):
        assert f"schemas/{path.name}" in page, path.name
        assert path.stem in OUTPUTS or path.stem in ("eval", "ensemble_metadata"), path.name
