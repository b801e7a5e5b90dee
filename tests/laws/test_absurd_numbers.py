"""Absurd numbers end well or in a typed error: no traceback, no hang, no word of a library."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from absurd_numbers import PARTS, beam, driven

import dalembert as da
from dalembert import planar, structures
from dalembert.budget import VARIABLE, check_budget
from dalembert.errors import BudgetError

SCRIPT = Path(__file__).parents[1] / "absurd_numbers.py"
STRIDE = {"analyses": 6, "choices": 10, "tables": 40, "responses": 2, "meshes": 2}
"""Of the numbers each option takes one in so many; ``pytest -m thorough`` takes all."""


@pytest.mark.few(1)
@pytest.mark.skipif(os.name == "nt", reason="needs a limit of memory")
@pytest.mark.parametrize(
    ("part", "stride"),
    [
        *((part, STRIDE.get(part, 1)) for part in PARTS),
        *(pytest.param(part, 1, marks=pytest.mark.thorough) for part in STRIDE),
    ],
)
def test_absurd_numbers(part, stride, tmp_path):
    done = subprocess.run(
        [sys.executable, str(SCRIPT), part, str(tmp_path), str(stride)],
        env=os.environ | {VARIABLE: "0.05"},
        capture_output=True,
        text=True,
        check=False,
    )
    lines = done.stdout.splitlines()
    assert [line for line in lines if line.startswith("WRONG")] == []
    assert done.returncode == 0, f"{lines[-1:]}: {done.stderr}"
    assert done.stderr == ""
    assert sum(line.startswith("case") for line in lines) > 20


def pendulum():
    system = da.System("pendulum", gravity=(0.0, -9.81))
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0, angle=0.3))
    system.add(planar.Revolute("pin", system.ground.point(0, 0), bar.start))
    return system.build()


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda m: da.solve_dynamics(m, 1.0, outputs=10**9), "outputs = 1000000000 .*400 GB"),
        (lambda m: da.solve_dynamics(m, 1.0, step=1e-9), "1e[+]09 steps of 1e-09 s .*48 GB"),
        (lambda m: da.Projection(iterations=10**6), "iterations=1000000.* 4 TB"),
        (lambda m: da.AugmentedLagrangian(iterations=10**12), "iterations=10{12}.* 4 EB"),
        (lambda m: da.Equilibrium(steps=10**8), "steps=100000000.* 1e[+]08 rounds"),
        (lambda m: structures.box_mesh((1, 1, 1), (1000, 1000, 1000)), "1000000000 cells.* 1 TB"),
        (
            lambda m: da.solve_dynamics(
                m, 1.0, integrator=da.DormandPrince(max_step=1e-10), outputs=2
            ),
            "1e[+]10 steps",
        ),
    ],
)
def test_the_cost_is_named(ask, words):
    with pytest.raises(BudgetError, match=words + r".*DALEMBERT_BUDGET=\d"):
        ask(pendulum())


def test_runs_that_would_never_end_keep_what_they_had():
    """Steps that follow an error are not known beforehand; their pace shows where it leads."""
    motion = da.solve_dynamics(pendulum(), 1e10, integrator=da.DormandPrince())
    assert motion.status.outcome is da.Outcome.NOT_CONVERGED
    assert "steps" in str(motion.status) and VARIABLE in str(motion.status)
    assert motion.status.time > 0


def test_the_budget_can_be_raised(monkeypatch):
    with pytest.raises(BudgetError):
        check_budget("a copy of everything", memory=1e12, cure="take less")
    monkeypatch.setenv(VARIABLE, "1000")
    check_budget("a copy of everything", memory=1e12, cure="take less")
    monkeypatch.setenv(VARIABLE, "much")
    with pytest.raises(BudgetError, match=r"DALEMBERT_BUDGET is 'much'"):
        check_budget("nothing", cure="take less")


@pytest.mark.parametrize(
    ("model", "analysis"),
    [
        (pendulum, da.Dynamics(1.0, step=1e-4)),
        (driven, da.Kinematics(1.0, step=1e-4)),
        (beam, da.Dynamics(1.0, step=1e-3)),
        (beam, da.Equilibrium(steps=20)),
        (beam, da.ArcLength(first=0.01)),
    ],
    ids=lambda value: type(value).__name__,
)
def test_work_is_shown_and_interrupted_work_is_kept(model, analysis):
    messages = []

    def progress(fraction: float) -> None:
        messages.append(fraction)
        if len(messages) == 3:
            raise KeyboardInterrupt

    result = analysis.run(model(), progress=progress)
    assert result.status.outcome is da.Outcome.INTERRUPTED
    assert 0 < messages[0] < messages[1] < messages[2] < 1
    assert result.status.time > 0
