"""Optimisation with a reliability, and robust aims, asked for in files and on the command line."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from test_decision_files import ROD, run, written

import dalembert as da
from dalembert.cli import main

RELIABLE = """
[optimize]
minimize = "mass"
subject_to = [{ response = "stress", upper = 1.5e8 }]
beta = 3.0
[[random]]
parameter = "load"
type = "Lognormal"
mean = 1e5
std = 1e4
"""
ROBUST = """
[robust.worst]
response = "stress"
deviations = 2.0
[optimize]
minimize = "mass"
subject_to = [{ response = "worst", upper = 1.5e8 }]
[[random]]
parameter = "load"
type = "Normal"
mean = 1e5
std = 1e4
"""


@pytest.mark.thorough
def test_an_optimum_with_a_reliability(tmp_path, capsys):
    """``A = exp(μ + βσ)/s``, and twice as far with ``--beta 6``."""
    path, out = written(tmp_path, ROD + RELIABLE), tmp_path / "o"
    spread = math.log1p(0.1**2)

    def needed(beta: float) -> float:
        return math.exp(math.log(1e5) - spread / 2 + beta * math.sqrt(spread)) / 1.5e8

    result = run(capsys, "optimize", path, "--output", out)
    assert result["x"]["area"] == pytest.approx(needed(3.0), rel=1e-6)
    assert result["reliability"][0]["beta"] == pytest.approx(3.0, rel=1e-6) and result["beta"] == 3
    document = json.loads((out / "model.optimum.json").read_text(encoding="utf-8"))
    assert document == {key: result[key] for key in document}
    assert da.load_results(out / "model.optimum.nc").limit_beta.item() == pytest.approx(3.0)
    page = (out / "model.optimum.report.html").read_text(encoding="utf-8")
    assert "Limits and their worst points" in page
    again = run(capsys, "optimize", path, "--beta", "6")
    assert again["x"]["area"] == pytest.approx(needed(6.0), rel=1e-6)
    assert main(["optimize", str(path)]) == 0
    output = capsys.readouterr().out
    assert "limits at β = 3" in output and "stress < 1.5e+08: β 3, worst at load = " in output


def test_robust_aims(tmp_path, capsys):
    """Mean and two deviations of the load: as a limit, and between two aims."""
    path = written(tmp_path, ROD + ROBUST)
    result = run(capsys, "optimize", path)
    assert result["x"]["area"] == pytest.approx(1.2e5 / 1.5e8, rel=1e-6)
    text = ROBUST[: ROBUST.index("[optimize]")] + ROBUST[ROBUST.index("[[random]]") :]
    text += '[pareto]\nminimize = ["mass", "worst"]\npoints = 3\n'
    front = run(capsys, "pareto", written(tmp_path, ROD + text))
    for point in front["points"]:
        area = point["parameters"]["area"]
        assert point["aims"]["worst"] == pytest.approx(1.2e5 / area, rel=1e-6)


@pytest.mark.parametrize(
    ("text", "old", "new", "words"),
    [
        (RELIABLE, "beta = 3.0", "beta = 0", "optimize.beta: is 0; it must be above zero"),
        (RELIABLE, "subject_to =", "#", "optimize.subject_to: is empty"),
        (RELIABLE, '"load"', '"lod"', "random[0].parameter: unknown parameter 'lod'"),
        (RELIABLE, RELIABLE[RELIABLE.index("[[random]]") :], "", "random: is missing"),
        (ROBUST, 'response = "stress"\n', 'response = "stres"\n', "robust.worst.response: unknown"),
        (ROBUST, '"worst", upper', '"wurst", upper', "unknown response 'wurst'"),
        (ROBUST, ROBUST[ROBUST.index("[[random]]") :], "", "random: is missing"),
    ],
)
def test_slips(text, old, new, words, tmp_path, capsys):
    changed = text.replace(old, new, 1)
    assert changed != text
    path = written(tmp_path, ROD + changed)
    for command in ("check", "optimize"):
        assert main([command, str(path)]) == 2
        error = capsys.readouterr().err
        assert words in error and str(path) in error


def stop_at(monkeypatch, number: int) -> list:
    """Ctrl-C at a run of the model; the runs made by then, and after."""
    from dalembert.design.optimize.problem import DesignProblem

    honest, calls = DesignProblem._run, []

    def stopped(self, x):
        calls.append(1)
        if len(calls) == number:
            raise KeyboardInterrupt
        return honest(self, x)

    monkeypatch.setattr(DesignProblem, "_run", stopped)
    return calls


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("number", "rounds"), [(3, "0 complete rounds"), (9, "0"), (14, "1 complete")]
)
def test_goes_on_from_its_history(number, rounds, tmp_path, capsys, monkeypatch):
    """Ctrl-C in the first search of a design, and while a worst point is looked for."""
    path, history = written(tmp_path, ROD + RELIABLE), tmp_path / "h.jsonl"
    whole = run(capsys, "optimize", path)
    calls = stop_at(monkeypatch, number)
    arguments = ["optimize", str(path), "--history", str(history), "--output", str(tmp_path / "o")]
    assert main(arguments) == 130 and len(calls) <= number + 2
    assert f"interrupted after {rounds}" in capsys.readouterr().out
    assert len(list((tmp_path / "o").iterdir())) == 3
    assert "NaN" not in (tmp_path / "o" / "model.optimum.json").read_text(encoding="utf-8")
    again = run(capsys, *arguments)
    assert again["x"] == whole["x"] and again["rounds"][-1]["x"] == whole["rounds"][-1]["x"]
    assert again["runs"] < whole["runs"] and again["start"] == whole["start"]
    for changes in (["--vary", "load"], ["--set", "load=2e5"]):
        assert main([*arguments, *changes]) == 2 and "another problem" in capsys.readouterr().err


def test_beta_is_seen_in_numbers(tmp_path, capsys):
    """A hundred thousand loads: as many break the rod as β says, within four deviations."""
    path = written(tmp_path, ROD + RELIABLE.replace("beta = 3.0", "beta = 2.0"))
    area = run(capsys, "optimize", path)["x"]["area"]
    rng, spread = np.random.default_rng(0), math.sqrt(math.log1p(0.1**2))
    loads = np.exp(math.log(1e5) - spread**2 / 2 + spread * rng.normal(size=100_000))
    share = float(np.mean(loads / area > 1.5e8))
    assert share == pytest.approx(0.02275, abs=4 * math.sqrt(0.02275 / 1e5))
