"""Synthesis asked for in files: six-bars, geared five-bars, the mechanism of the file itself."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from test_decision_files import run, written

import dalembert as da
from dalembert.cli import main
from dalembert.design.synthesis.mechanism_task import MechanismTask
from dalembert.design.synthesis.synthesize_mechanism import MechanismSearch

SIX = """
format = 1
name = "six-bar"
[synthesis]
type = "path"
linkage = "watt II"
marks = { upper = { P = [9, 3] } }
reach = 0.3
point = "upper.P"
points = POINTS
crank_angles = ANGLES
starts = 1
[synthesis.joints]
A = [4, 0]
B = [0, 0]
C = [8, 0]
D = [4.5, 3]
E = [6.5, 2.2]
F = [1, 0.5]
G = [9, 3]
"""
FIVE = """
format = 1
name = "gears"
[synthesis]
type = "function"
linkage = "geared five-bar"
joints = { O1 = [0, 0], O2 = [3, 0], A = [0.5, 0.5], B = [3.6, 0.8], C = [2, 3.5] }
ratio = -2.0
reach = 0.3
output = "left.angle"
outputs = OUTPUTS
crank_angles = ANGLES
starts = 1
"""
OWN = """
format = 1
name = "slider-crank"
[parameters]
crank = { value = 0.11, unit = "m", bounds = [0.05, 0.15] }
rod = { value = 0.42, unit = "m", bounds = [0.3, 0.6] }
[bodies]
disc = { type = "Bar", length = "crank", mass = 1.0, angle = 0.0 }
link = { type = "Bar", length = "rod", mass = 1.0, angle = 0.0 }
block = { mass = 1.0, inertia = 1.0, position = [0.5, 0] }
[joints]
O = { type = "Revolute", connect = ["ground", "disc.start"] }
A = { type = "Revolute", connect = ["disc.end", "link.start"] }
B = { type = "Revolute", connect = ["link.end", "block"] }
rail = { type = "Prismatic", connect = ["ground", "block"] }
[drivers]
motor = { type = "RotationalDriver", connect = ["ground", "disc"], law = "3*t" }
[analysis]
type = "Kinematics"
duration = 1.0
[synthesis]
type = "function"
linkage = "own"
output = "block.x"
speed = 3.0
crank_angles = ANGLES
outputs = OUTPUTS
starts = 1
"""
ANGLES = np.linspace(0.2, 2.6, 7)


def filled(text: str, **columns) -> str:
    """A file with a target."""
    for name, values in columns.items():
        text = text.replace(name.upper(), json.dumps(np.asarray(values).tolist()))
    return text


def far_from(model: da.Model, *measures: str) -> np.ndarray:
    """(n, m) measures of a mechanism near by, at the angles: what is to be met exactly."""
    rng = np.random.default_rng(3)
    other = {n: p.value + 0.05 * rng.uniform(-1, 1) for n, p in model.parameters.items()}
    motion = da.solve_kinematics(model, 2 * math.pi, outputs=721, parameters=other)
    return np.column_stack([motion.at(ANGLES).values(m) for m in measures])


@pytest.mark.thorough
def test_a_six_bar_by_name(tmp_path, capsys):
    joints = {"A": (4, 0), "B": (0, 0), "C": (8, 0), "D": (4.5, 3)}
    joints |= {"E": (6.5, 2.2), "F": (1, 0.5), "G": (9, 3)}
    model = da.six_bar("watt II", joints, {"upper": {"P": (9, 3)}}).build()
    xy = far_from(model, "upper.P.x", "upper.P.y")
    path, out = written(tmp_path, filled(SIX, points=xy, angles=ANGLES)), tmp_path / "o"
    result = run(capsys, "synthesize", path, "--output", out)
    assert result["linkage"] == "watt II" and result["solutions"][0]["error"] < 1e-8
    assert set(result["solutions"][0]["dimensions"]) >= {"A_x", "G_y", "P_x"}
    page = (out / "model.synthesis.report.html").read_text(encoding="utf-8")
    assert page.count('"disc"') >= 7 and "Target and path" in page
    again = da.load_results(out / "model.synthesis.nc")
    assert again.attrs["linkage"] == "watt II" and again.sizes["entry"] == 7
    assert main(["check", str(path)]) == 0
    assert "a watt II for a path of 7 entries" in capsys.readouterr().out


def test_a_geared_five_bar(tmp_path, capsys):
    joints = {"O1": (0, 0), "O2": (3, 0), "A": (0.5, 0.5), "B": (3.6, 0.8), "C": (2, 3.5)}
    angle = far_from(da.geared_five_bar(joints, -2.0).build(), "left.angle")[:, 0]
    path = written(tmp_path, filled(FIVE, outputs=angle, angles=ANGLES))
    result = run(capsys, "synthesize", path)
    assert result["solutions"][0]["error"] < 1e-8


def test_the_mechanism_of_the_file(tmp_path, capsys):
    """``x = r cos θ + √(l² − r² sin² θ)`` of r = 0.1 m, l = 0.4 m is met by these lengths alone."""
    x = 0.1 * np.cos(ANGLES) + np.sqrt(0.4**2 - (0.1 * np.sin(ANGLES)) ** 2)
    path = written(tmp_path, filled(OWN, angles=ANGLES, outputs=x - x[0]))
    assert main(["check", str(path)]) == 0
    capsys.readouterr()
    result = run(capsys, "synthesize", path, "--output", tmp_path / "o")
    sizes = result["solutions"][0]["dimensions"]
    assert sizes == pytest.approx({"crank": 0.1, "rod": 0.4}, rel=1e-4)
    assert len(list((tmp_path / "o").iterdir())) == 3
    again = run(capsys, "synthesize", path, "--set", "crank=0.14")
    assert again["solutions"][0]["dimensions"] == pytest.approx(sizes, rel=1e-4)


@pytest.mark.parametrize(
    ("text", "old", "new", "words"),
    [
        (SIX, '"watt II"', '"wat II"', "did you mean 'watt II'"),
        (SIX, "G = [9, 3]", "H = [9, 3]", "synthesis: the joint 'G' has no position"),
        (SIX, '"upper.P"', '"upper.Q"', "upper.Q"),
        (SIX, 'point = "upper.P"\n', "", "the target needs point="),
        (SIX, "reach = 0.3\n", "", "nothing to vary"),
        (SIX, "starts = 1", "transmission = 0.5", "synthesis.transmission: is for FourBar"),
        (SIX, '"watt II"', '"own"', "the file has no bodies"),
        (SIX, "starts = 1", "starts = 0", "synthesis.starts: expected a whole number of at"),
        (OWN, "starts = 1", "starts = -3", "at least 1, got -3"),
        (FIVE, "ratio = -2.0\n", "", "the gears have no ratio"),
        (OWN, "starts = 1", 'vary = ["crnk"]', "unknown parameter 'crnk'"),
        (OWN, 'output = "block.x"', 'output = "blok.x"', "nearest: block.x"),
    ],
)
def test_slips(text, old, new, words, tmp_path, capsys):
    changed = text.replace(old, new, 1)
    assert changed != text
    pairs = np.column_stack([ANGLES, ANGLES])
    path = written(tmp_path, filled(changed, points=pairs, angles=ANGLES, outputs=ANGLES))
    assert main(["synthesize", str(path)]) == 2
    error = capsys.readouterr().err
    assert words in error and str(path) in error


def test_a_motor_that_never_rotates_fully_is_reported(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(MechanismTask, "run_revolution", lambda task, q: None)
    text = filled(OWN, angles=ANGLES, outputs=ANGLES).replace("starts = 1", "starts = 2")
    assert main(["synthesize", str(written(tmp_path, text))]) == 1
    assert "no mechanism of 80 random ones has a fully rotating motor" in capsys.readouterr().err


def test_interrupted(tmp_path, capsys, monkeypatch):
    """Ctrl-C in the second start keeps what the first has found."""
    original, calls = MechanismSearch.solve, []

    def stopped(self, q, motion):
        calls.append(1)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return original(self, q, motion)

    monkeypatch.setattr(MechanismSearch, "solve", stopped)
    x = 0.1 * np.cos(ANGLES) + np.sqrt(0.4**2 - (0.1 * np.sin(ANGLES)) ** 2)
    text = filled(OWN, angles=ANGLES, outputs=x).replace("starts = 1", "starts = 4")
    path = written(tmp_path, text)
    assert main(["synthesize", str(path), "--output", str(tmp_path / "o")]) == 130
    assert "interrupted after 1 of 4 starts" in capsys.readouterr().out
    assert len(list((tmp_path / "o").iterdir())) == 3
