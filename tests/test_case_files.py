"""Several runs in one design, asked for in files: a mechanism that loads a structure."""

from __future__ import annotations

import pytest
from test_decision_files import DENSITY, LENGTH, ROD, json_output, run, written

from dalembert.cli import main

CASES = """
format = 1
name = "crank and post"
[parameters]
radius = { value = 0.2, unit = "m", bounds = [0.1, 0.3] }
[bodies]
crank = { type = "Bar", length = "radius", mass = 2.0, angle = 0.0 }
[joints]
O = { type = "Revolute", connect = ["ground", "crank.start"] }
[drivers]
motor = { type = "RotationalDriver", connect = ["ground", "crank"], law = "10*t" }
[analysis]
type = "InverseDynamics"
duration = 0.1
outputs = 11
[cases.post]
model = "rod.toml"
inputs = { load = "bearing" }
[cases.fast]
analysis = { type = "Kinematics", duration = 0.1, outputs = 3 }
[responses]
bearing = { type = "Maximum", measure = "O.force_norm" }
stress = { type = "Final", measure = "rod.stress", case = "post" }
mass = { type = "Final", measure = "mass", case = "post" }
reach = { type = "Final", measure = "sqrt(crank.end.x**2 + crank.end.y**2)", case = "fast" }
[combined]
cost = "mass - 60*reach"
[optimize]
minimize = "cost"
vary = ["radius", "area"]
subject_to = [{ response = "stress", upper = 4e4 }]
"""


def test_several_analyses(tmp_path, capsys):
    """The bearing's force m ω² r/2 loads a rod, whose mass is traded for the reach of the crank."""
    written(tmp_path, ROD, "rod.toml")
    path = written(tmp_path, CASES)
    result = run(capsys, "optimize", path)
    force = 2.0 * 100 * result["x"]["radius"] / 2
    assert result["active"] == ["stress"]
    assert force / result["x"]["area"] == pytest.approx(4e4, rel=1e-5)
    cost = DENSITY * LENGTH * result["x"]["area"] - 60 * result["x"]["radius"]
    assert result["fun"] == pytest.approx(cost)
    assert main(["optimize", str(path), "--vary", "area", "--minimize", "mass", "--json"]) == 0
    assert list(json_output(capsys)["x"]) == ["area"]


def test_an_event_of_a_case_is_one_of_its_own_analysis(tmp_path, capsys):
    """The case turns at 10 rad/s from rest at 0 and passes 0.5 rad after 0.05 s."""
    fast = (
        '[cases.fast]\nanalysis = { type = "Dynamics", duration = 0.1, '
        'events = { halfway = "crank.angle - 0.5" } }\n'
    )
    when = 'when = { type = "AtEvent", measure = "time", event = "halfway", case = "fast" }\n'
    text = CASES.replace("[responses]\n", "[responses]\n" + when)
    text = text.replace('minimize = "cost"', 'minimize = "when"').replace(
        'vary = ["radius", "area"]', 'vary = ["radius"]'
    )
    start = text.index("[cases.fast]")
    text = text[:start] + fast + text[text.index("[responses]") :]
    text = "\n".join(
        line for line in text.splitlines() if not line.startswith(("reach", "subject_to"))
    )
    text = text.replace("mass - 60*reach", "mass")
    result = run(capsys, "optimize", written(tmp_path, text))
    assert result["fun"] == pytest.approx(0.05, rel=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('model = "rod.toml"', 'model = "rood.toml"', "cases.post.model: "),
        (
            '"mass", case = "post" }',
            '"mass", case = "past" }',
            "responses.mass.case: unknown case 'past'",
        ),
        ('load = "bearing"', 'load = "beering"', "cases.post.inputs.load: unknown response"),
        ('load = "bearing"', 'loud = "bearing"', "unknown parameter 'loud'"),
        ('load = "bearing"', 'load = "stress"', "responses.stress: depends on itself"),
        ("mass - 60*reach", "moss + 2", "combined.cost: 'moss + 2' names no response"),
        ('model = "rod.toml"\n', "", "cases.post: give model, another file, or analysis"),
    ],
)
def test_cases_that_cannot_be(old, new, words, tmp_path, capsys):
    written(tmp_path, ROD, "rod.toml")
    path = written(tmp_path, CASES.replace(old, new))
    assert main(["optimize", str(path)]) == 2
    assert words in capsys.readouterr().err
