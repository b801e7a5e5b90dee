"""Trajectories asked for in files and on the command line: what is found, kept and refused."""

from __future__ import annotations

import json

import numpy as np
import pytest
from test_decision_files import run, written

import dalembert as da
from dalembert.cli import main
from dalembert.design.trajectory.ipopt import Programme
from dalembert.io.decisions.trajectories import make_trajectory
from dalembert.io.model_file import load_model_file

BLOCK = """
format = 1
name = "block"
gravity = [0, 0]
[parameters]
push = { value = 0.0, unit = "N", bounds = [-50, 50] }
mass = { value = 1.0, unit = "kg", bounds = [0.5, 2.0] }
[bodies]
block = { type = "Particle", mass = "mass", position = [0, 0] }
[drivers.rail]
type = "CoordinateDriver"
connect = ["block"]
direction = [0, 1]
law = 0
[forces]
F = { type = "Force", connect = ["block"], vector = ["push", 0] }
[responses]
effort = { type = "Integral", measure = "push**2" }
fastest = { type = "Maximum", measure = "block.vx" }
[trajectory]
minimize = "effort"
controls = ["push"]
duration = 1.0
end = { "block.x" = 1.0, "block.vx" = [0.0, 0.0] }
method = { type = "DirectCollocation", intervals = 10 }
"""


def test_least_force(tmp_path, capsys):
    """``u = 6 − 12 t``, cost 12: saved, read again, and drawn as by ``report``."""
    path, out = written(tmp_path, BLOCK), tmp_path / "o"
    result = run(capsys, "trajectory", path, "--output", out)
    assert result["fun"] == pytest.approx(12.0, rel=1e-9) and result["objective"] == "effort"
    control = result["controls"]["push"]
    np.testing.assert_allclose(control["values"], 6 - 12 * np.array(control["times"]), atol=1e-7)
    document = json.loads((out / "model.trajectory.json").read_text(encoding="utf-8"))
    assert document == {key: result[key] for key in document}
    again = da.load_results(out / "model.trajectory.nc")
    np.testing.assert_allclose(again.control_push, control["values"])
    assert float(again.position.sel(body="block", axis="x")[-1]) == pytest.approx(1.0)
    saved = str(out / "model.trajectory.nc"), "--output", str(tmp_path / "p.html")
    assert main(["report", *saved]) == 0
    for page in (out / "model.trajectory.report.html", tmp_path / "p.html"):
        assert "Initial position" in page.read_text(encoding="utf-8")


def test_shooting_with_strategies_of_a_run(tmp_path, capsys):
    text = BLOCK.replace("DirectCollocation", "MultipleShooting")
    text = text.replace("intervals = 10", 'intervals = 6, steps = 8, integrator = "Trapezoidal"')
    result = run(capsys, "trajectory", written(tmp_path, text))
    assert result["fun"] == pytest.approx(12.0, rel=1e-3) and result["deviation"] < 1e-9
    text = text.replace("Trapezoidal", "DormandPrince")
    assert main(["trajectory", str(written(tmp_path, text))]) == 2
    assert "trajectory.method: DormandPrince chooses its steps" in capsys.readouterr().err


def test_shortest_time_within_limits(tmp_path, capsys):
    """No faster than 2 m/s: speeding up and braking at 50 m/s² each take 0.04 s and 0.04 m."""
    text = BLOCK.replace("duration = 1.0", "duration = [0.1, 2.0]")
    text = text.replace("intervals = 10", "intervals = 50")
    limit = 'subject_to = [{ response = "fastest", upper = 2.0 }]'
    text = text.replace("[trajectory]", "[trajectory]\n" + limit)
    result = run(capsys, "trajectory", written(tmp_path, text), "--minimize", "time")
    assert result["duration"] == pytest.approx(0.08 + 0.92 / 2, rel=1e-2)
    assert result["fun"] == pytest.approx(result["duration"]) and result["unit"] == "s"


def test_dimensions_with_the_motion(tmp_path, capsys):
    """``12 m² + 3/m`` is least where ``m³ = 1/8``."""
    text = BLOCK.replace('minimize = "effort"', 'minimize = "cost"\nvary = ["mass"]')
    text += '[responses.m]\ntype = "Final"\nmeasure = "mass"\n'
    text += '[combined.cost]\nformula = "effort + 3/m"\n'
    text = text.replace("[0.5, 2.0]", "[0.2, 2.0]")
    result = run(capsys, "trajectory", written(tmp_path, text))
    assert result["x"]["mass"] == pytest.approx(0.5, rel=1e-5) and result["start"]["mass"] == 1.0


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('controls = ["push"]', 'controls = ["posh"]', "controls[0]: unknown parameter 'posh'"),
        ('controls = ["push"]', "controls = []", "trajectory.controls: is empty"),
        ('controls = ["push"]', 'controls = ["mass"]', "the control 'mass' would change masses"),
        ('minimize = "effort"', 'minimize = "efort"', "minimize: unknown response 'efort'"),
        ('"Maximum", measure = "block.vx"', '"At", time = 0.5, measure = "block.vx"', None),
        ('"block.x" = 1.0', '"blok.x" = 1.0', "trajectory.end"),
        ('"block.x" = 1.0', '"block.x" = [0.0]', "expected a number or [lower, upper]"),
        ("duration = 1.0", "duration = [2.0, 1.0]", "trajectory.duration: duration is"),
        ("duration = 1.0", 'duration = 1.0\nguess = "lin"', "did you mean 'line'"),
        ("duration = 1.0", 'duration = 1.0\nvary = ["push"]', "it cannot vary as well"),
        ("intervals = 10", "intervals = 1", "trajectory.method: intervals is 1"),
        ("DirectCollocation", "DirectColocation", "did you mean 'DirectCollocation'"),
    ],
)
def test_slips(old, new, words, tmp_path, capsys):
    text = BLOCK.replace(old, new)
    if words is None:
        text = text.replace('minimize = "effort"', 'minimize = "fastest"')
        words = "trajectory.minimize: fastest: trajectories support"
    path = written(tmp_path, text)
    for command in ("check", "trajectory"):
        assert main([command, str(path)]) == 2
        error = capsys.readouterr().err
        assert words in error and str(path) in error


def test_interrupted(tmp_path, capsys, monkeypatch):
    """Ctrl-C keeps, tells and writes the plan of the last iteration."""
    original, seen = Programme.solve, []

    def stopped(self, x0, method, report=None):
        def tell(number, objective):
            seen.append(number)
            if number == 2:
                raise KeyboardInterrupt

        return original(self, x0, method, tell)

    monkeypatch.setattr(Programme, "solve", stopped)
    path = written(tmp_path, BLOCK.replace("1.0, 0.0", "1.0"))
    code = main(["trajectory", str(path), "--output", str(tmp_path / "o")])
    output = capsys.readouterr()
    assert code == 130 and "interrupted after 2 iterations" in output.out
    assert "Traceback" not in output.err and len(list((tmp_path / "o").iterdir())) == 3


def test_a_notebook_shows_it(tmp_path):
    file = load_model_file(written(tmp_path, BLOCK))
    model = file.model()
    best = da.optimize_trajectory(model, **make_trajectory(file, model))
    assert "<iframe" in best._repr_html_() and best.to_dataframe().size
    kinds = [view["title"] for view in best.views()]
    assert kinds[:2] == ["Control push", "block.x"]
