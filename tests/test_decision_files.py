"""Decisions asked for in files and on the command line: what is found, written and refused."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

import dalembert as da
from dalembert.cli import main
from dalembert.cli.app import EXAMPLES
from dalembert.cli.pareto import _show as show_front
from dalembert.design.identification.misfit import Misfit
from dalembert.design.optimize.problem import DesignProblem
from dalembert.design.pareto.pareto_result import ParetoResult
from dalembert.design.synthesis.linkage_fit import LinkageFit
from dalembert.io.decisions.designs import make_design
from dalembert.io.model_file import load_model_file

LOAD, MODULUS, LENGTH, DENSITY = 1e5, 2e11, 2.0, 7850.0
ROD = f"""
format = 1
kind = "structure"
name = "tie rod"
[parameters]
load = {{ value = {LOAD}, unit = "N" }}
area = {{ value = 1e-3, unit = "m^2", bounds = [2e-4, 5e-3] }}
[nodes]
left = [0, 0]
right = [{LENGTH}, 0]
[elements.rod]
type = "Truss"
connect = ["left", "right"]
area = "area"
modulus = {MODULUS}
density = {DENSITY}
[[supports]]
nodes = ["left"]
ux = 0
uy = 0
[[supports]]
nodes = ["right"]
uy = 0
[[loads]]
nodes = ["right"]
fx = "load"
[responses]
stress = {{ measure = "rod.stress" }}
mass = {{ measure = "mass" }}
"""
TASKS = {
    "pareto": """
[pareto]
minimize = ["stress", "mass"]
points = 4
""",
    "reliability": """
[reliability]
limits = [{ response = "stress", upper = 1.5e8 }]
correlation = [{ between = ["load", "area"], value = 0.0 }]
samples = 40
[[random]]
parameter = "load"
type = "Lognormal"
mean = 1e5
std = 1e4
[[random]]
parameter = "area"
type = "Lognormal"
mean = 1e-3
std = 5e-5
""",
    "tolerance": """
[tolerance]
response = "stress"
tolerances = { load = 3e3, area = 3e-5 }
samples = 30
allocate = { limit = 3e6, costs = { load = 1.0, area = 1e-8 } }
""",
}
SYNTHESIS = """
format = 1
name = "path"
[synthesis]
type = "path"
closed = true
starts = 3
points = [[0, 0], [1, 0.2], [2, 1], [1.5, 2], [0.2, 1.5]]
"""
KNOTS = np.linspace(0, 1, 9)
PUSH = """
format = 1
gravity = [0, 0]
[histories.push]
knots = { end = 1.0, count = 9 }
unit = "N"
[bodies]
mass = { type = "Particle", mass = 2.0, position = [0, 0] }
[drivers.guide]
type = "CoordinateDriver"
connect = ["mass"]
direction = [0, 1]
law = 0
[forces]
F = { type = "Force", connect = ["mass"], vector = ["push", 0] }
[analysis]
type = "Dynamics"
duration = 1.0
step = 0.02
[invert]
data = "push.csv"
measures = { sensor = "mass.x" }
smoothing = 1e-9
"""


def json_output(capsys) -> dict:
    return json.loads(capsys.readouterr().out)


def written(tmp_path: Path, text: str, name: str = "model.toml") -> Path:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def run(capsys, *arguments) -> dict:
    assert main([*map(str, arguments), "--json"]) == 0
    return json_output(capsys)


# what is found -------------------------------------------------------------------------
def test_front(tmp_path, capsys):
    """Stress times mass is the same at every design of a rod: F ρ L."""
    result = run(capsys, "pareto", written(tmp_path, ROD + TASKS["pareto"]))
    products = [p["aims"]["stress"] * p["aims"]["mass"] for p in result["points"]]
    assert products == pytest.approx([LOAD * DENSITY * LENGTH] * len(products))
    areas = [p["parameters"]["area"] for p in result["points"]]
    assert min(areas) == pytest.approx(2e-4) and max(areas) == pytest.approx(5e-3)


def test_reliability(tmp_path, capsys):
    """Load over area is lognormal: β = (ln s − μ)/σ."""
    result = run(capsys, "reliability", written(tmp_path, ROD + TASKS["reliability"]))
    load, area = np.log1p(0.1**2), np.log1p(0.05**2)
    mean = np.log(1e5) - load / 2 - np.log(1e-3) + area / 2
    beta = (np.log(1.5e8) - mean) / np.sqrt(load + area)
    assert result["beta"] == pytest.approx(beta, rel=1e-7)
    assert result["importance"]["load"] == pytest.approx(load / (load + area), rel=1e-6)
    assert result["sampled"]["samples"] == 40


def test_tolerance(tmp_path, capsys):
    result = run(capsys, "tolerance", written(tmp_path, ROD + TASKS["tolerance"]))
    assert result["effects"] == pytest.approx({"load": 3e6, "area": -3e6})
    least, most = (LOAD - 3e3) / 1.03e-3, (LOAD + 3e3) / 0.97e-3
    assert result["worst_case"] == pytest.approx([least, most])
    spread = np.hypot(result["allocated"]["load"] / 1e-3, result["allocated"]["area"] * 1e11)
    assert spread == pytest.approx(3e6)


@pytest.mark.thorough
def test_linkages(tmp_path, capsys):
    path = written(tmp_path, SYNTHESIS)
    result = run(capsys, "synthesize", path, "--output", tmp_path)
    assert result["solutions"][0]["error"] < 1e-3
    assert "a FourBar for a path of 5 entries" in _text(capsys, "check", path)
    page = (tmp_path / "model.synthesis.report.html").read_text(encoding="utf-8")
    assert page.count('"disc"') >= 5


def _text(capsys, *arguments) -> str:
    assert main([str(a) for a in arguments]) == 0
    return capsys.readouterr().out


def test_histories(tmp_path, capsys):
    path = written(tmp_path, PUSH)
    truth = 8 * np.sin(5 * KNOTS)
    file = load_model_file(path)
    values = {f"push_{k}": v for k, v in enumerate(truth)}
    motion = da.Dynamics(1.0, step=0.02).run(file.model(), values)
    rows = zip(motion.time, motion.values("mass.x"), strict=True)
    text = "time,sensor\n" + "".join(f"{t},{x}\n" for t, x in rows)
    written(tmp_path, text, "push.csv")
    result = run(capsys, "invert", path, "--output", tmp_path)
    assert result["histories"]["push"]["values"][1:-2] == pytest.approx(truth[1:-2], abs=0.3)
    data = da.load_results(tmp_path / "model.inversion.nc")
    assert data["push"].values == pytest.approx(result["histories"]["push"]["values"])


# what is refused -----------------------------------------------------------------------
@pytest.mark.parametrize(
    ("task", "old", "new", "words"),
    [
        ("pareto", '"mass"]', '"moss"]', "pareto.minimize[1]: unknown response 'moss'"),
        ("pareto", '"stress", "mass"', '"stress"', "give two or more objectives"),
        ("pareto", "points = 4", "points = 1", "pareto.points: is 1; give two or more"),
        ("pareto", "points = 4", 'method = "nsga"', "did you mean 'nsga"),
        ("reliability", '"load"\ntype', '"lod"\ntype', "random[0].parameter: unknown parameter"),
        ("reliability", '"area"\ntype', '"load"\ntype', "'load' is random twice"),
        ("reliability", "std = 1e4", "std = -1", "random[0]: mean and std must be above zero"),
        ("reliability", "value = 0.0", "value = 2.0", "reliability.correlation: "),
        ("reliability", '"Lognormal"', '"Lognorml"', "did you mean 'Lognormal'"),
        ("reliability", ", upper = 1.5e8", "", "give lower or upper"),
        ("tolerance", "load = 3e3", "lod = 3e3", "tolerance.tolerances.lod: unknown parameter"),
        ("tolerance", "load = 3e3", "load = 0", "is 0; a half width is above zero"),
        ("tolerance", "costs = { load = 1.0, ", "costs = { ", "has no cost of load"),
        ("tolerance", "limit = 3e6", "limit = -1", "tolerance.allocate.limit: is -1; it must"),
    ],
)
def test_slips(task, old, new, words, tmp_path, capsys):
    text = TASKS[task].replace(old, new, 1)
    assert text != TASKS[task]
    path = written(tmp_path, ROD + text)
    assert main([task, str(path), "--output", str(tmp_path / "o")]) == 2
    error = capsys.readouterr().err
    assert words in error and str(path) in error
    assert not list((tmp_path / "o").glob("*"))


@pytest.mark.parametrize("task", ["pareto", "reliability", "tolerance", "invert", "synthesize"])
def test_no_table(task, tmp_path, capsys):
    assert main([task, str(written(tmp_path, ROD))]) == 2
    assert re.search(r"model\.toml: (\w+): is missing; add \[", capsys.readouterr().err)


# what is kept --------------------------------------------------------------------------
@pytest.mark.few(2)
@pytest.mark.parametrize("task", TASKS)
def test_saved_and_read_again(task, tmp_path, capsys):
    not_live = "\n[report]\nlive = false\n"  # the stored page never is
    path, out = written(tmp_path, ROD + TASKS[task] + not_live), tmp_path / "o"
    result = run(capsys, task, path, "--output", out)
    base = f"model.{task}"
    assert sorted(f.name for f in out.iterdir()) == [
        f"{base}.{end}" for end in ("json", "nc", "report.html")
    ]
    document = json.loads((out / f"{base}.json").read_text(encoding="utf-8"))
    assert document == {key: result[key] for key in document}
    assert da.load_results(out / f"{base}.nc").sizes
    page = (out / f"{base}.report.html").read_bytes()
    assert main(["report", str(out / f"{base}.nc"), "--output", str(tmp_path / "p.html")]) == 0
    is_same = (tmp_path / "p.html").read_bytes() == page  # a difference would be long
    assert is_same


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("task", "owner", "name", "call"),
    [
        ("pareto", DesignProblem, "_run", 6),
        ("tolerance", DesignProblem, "_run", 9),
        ("reliability", DesignProblem, "_run", 40),
        ("synthesize", LinkageFit, "__call__", 2),
    ],
)
def test_interrupted(task, owner, name, call, tmp_path, capsys, monkeypatch):
    """Ctrl-C keeps, tells and writes what there is."""
    honest, calls = getattr(owner, name), [0]

    def stopped(*arguments, **named):
        calls[0] += 1
        if calls[0] == call:
            raise KeyboardInterrupt
        return honest(*arguments, **named)

    monkeypatch.setattr(owner, name, stopped)
    path = written(tmp_path, SYNTHESIS if task == "synthesize" else ROD + TASKS[task])
    assert main([task, str(path), "--output", str(tmp_path / "o")]) == 130
    output = capsys.readouterr()
    assert "interrupted" in output.out and "Traceback" not in output.err
    assert len(list((tmp_path / "o").iterdir())) == 3


def test_overrides_of_a_file_without_a_table(tmp_path, capsys):
    path = written(tmp_path, ROD)
    arguments = ["optimize", path, "--minimize", "mass", "--vary", "area", "--max-iterations", "9"]
    result = run(capsys, *arguments)
    assert result["objective"] == "mass" and result["unit"] == "kg"
    assert main(["optimize", str(path), "--minimize", "moss"]) == 2
    assert "did you mean 'mass'" in capsys.readouterr().err
    assert main(["optimize", str(path), "--minimize", "mass", "--method", "slqp"]) == 2
    assert "did you mean 'slsqp'" in capsys.readouterr().err
    file = load_model_file(path)
    with pytest.raises(da.ModelError, match="is missing"):
        make_design(file, file.model())


@pytest.mark.parametrize("task", ["pareto", "reliability", "tolerance", "synthesize", "invert"])
def test_help_has_an_example(task, capsys):
    assert main([task, "--help"]) == 0
    assert f"Example: dalembert {task} " in capsys.readouterr().out


def test_files_of_examples_are_there():
    expected = {path.name for path in (Path(__file__).parents[1] / "examples").glob("*.toml")}
    assert {text.split()[0] for text in EXAMPLES.values()} <= expected | {
        "model.toml",
        "robot.urdf",
    }


def test_a_front_without_points_is_told(capsys):
    """As where Ctrl-C comes before the first: it is no success, and it can be shown."""
    nothing = np.zeros((0, 2))
    front = ParetoResult(
        ["a", "b"], ["", ""], ["x"], nothing, nothing[:, :1], [1.0, 1.0], "none found"
    )
    assert not front.success and front.summary()["points"] == []
    assert "<iframe" in front._repr_html_() and front.data.sizes["point"] == 0
    show_front(front.summary())
    assert "0 designs" in capsys.readouterr().out


@pytest.mark.few(1)
@pytest.mark.parametrize("task", ["identify", "invert"])
def test_interrupted_searches(task, tmp_path, capsys, monkeypatch):
    """Ctrl-C in the fourth run: the unknowns of the best so far are told and written."""
    text = PUSH.replace("smoothing = 1e-9", "smoothing = 1e-4")
    if task == "identify":
        text = text.replace("[parameters]", "").replace("mass = 2.0", 'mass = "m"')
        text = text.replace(
            "[histories.push]", "[parameters]\nm = 3.0\n[histories.push]\nvalue = 1"
        )
        text = text.replace("[invert]", '[identify]\nvary = ["m"]').replace("smoothing = 1e-4", "")
    path = written(tmp_path, text)
    rows = "".join(f"{t},{0.5 * t**2 / 2 + 0.01 * np.sin(9 * t)}\n" for t in np.linspace(0, 1, 21))
    written(tmp_path, "time,sensor\n" + rows, "push.csv")
    honest, calls = Misfit._run, [0]

    def stopped(self, x):
        calls[0] += 1
        if calls[0] == 4:
            raise KeyboardInterrupt
        return honest(self, x)

    monkeypatch.setattr(Misfit, "_run", stopped)
    assert main([task, str(path), "--output", str(tmp_path / "o")]) == 130
    output = capsys.readouterr()
    assert "interrupted after" in output.out and "Traceback" not in output.err
    assert len(list((tmp_path / "o").glob("*.report.html"))) == 1
