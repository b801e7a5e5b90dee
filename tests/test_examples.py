"""Every example runs with joints closed and exact gradients; every script has a number."""

from __future__ import annotations

import re
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from example_runs import FILES, OPTIMISED, SCRIPTS, SMOOTH, STRUCTURES, file, model, motion, script

import dalembert as da
from dalembert.io.analyses import make_analysis
from dalembert.io.decisions.designs import make_design
from dalembert.io.decisions.responses import make_responses
from dalembert.io.report import report_choices


@pytest.mark.parametrize("name", FILES)
def test_file_runs_and_reports(name: str, tmp_path: Path) -> None:
    run = motion(name)
    assert run.status.success
    assert not [text for level, text in run.model.diagnosis.messages if level == "warning"]
    page = run.report(tmp_path / "page.html", **report_choices(file(name), model(name)))
    assert page.stat().st_size > 50_000


@pytest.mark.parametrize("name", FILES)
def test_joints_stay_closed(name: str) -> None:
    run = motion(name)
    if isinstance(run, da.HarmonicResponse):
        joints_stay_closed_in_harmonic_motion(run)
        return
    assert float(run["position_violation"].max()) <= 1e-12
    assert float(run["velocity_violation"].max()) <= 1e-12 * (1 + np.abs(run.trajectory.v).max())


def joints_stay_closed_in_harmonic_motion(run: da.HarmonicResponse) -> None:
    """The operating point closes joints; so do small motions, ``C δ̂ + b û = 0``."""
    point, e = run.record.point, run.model.equations
    level = ca.densify(e.constraints)
    at_rest = e.t, e.y, e.p
    closed = ca.Function("level", [*at_rest], [level])(point.time, point.y, point.p)
    assert np.abs(closed.full()).max() <= 1e-12
    by_place = ca.Function("slope", [*at_rest], [ca.jacobian(level, e.y)])
    by_input = ca.Function("slope", [*at_rest], [ca.jacobian(level, e.p)])
    slope, push = (f(point.time, point.y, point.p).full() for f in (by_place, by_input))
    moved = point.kernel.basis(point.y).full() @ run.motions[:, : point.kernel.parts["state"].stop]
    change = slope @ moved + (push @ run.record.directions)
    assert run.motions.shape[0] > 100 and np.abs(moved).max() > 0
    assert np.abs(change).max() <= 1e-12 * np.abs(moved).max()


@pytest.mark.parametrize("name", STRUCTURES)
def test_structure_runs_and_reports(name: str, tmp_path: Path) -> None:
    run = motion(name)
    assert run.status.success
    assert run.status.residual <= 1e-10
    assert run.report(tmp_path / "page.html").stat().st_size > 50_000


@pytest.mark.parametrize("name", STRUCTURES)
def test_file_and_script_are_the_same_structure(name: str) -> None:
    twin = script(name).build().build()
    assert {n: p.value for n, p in twin.parameters.items()} == {
        n: p.value for n, p in model(name).parameters.items()
    }
    again = make_analysis(file(name), twin).run(twin)
    assert list(again.model.degrees) == list(motion(name).model.degrees)
    np.testing.assert_allclose(again.displacements, motion(name).displacements, atol=1e-12)


LONG = ("compass_biped", "friction_gripper", "path_optimization", "tippe_top")
"""Files whose runs of one gradient or optimum take several seconds."""


@pytest.mark.few(4)
@pytest.mark.parametrize(
    ("name", "each"),
    [(name, 5) for name in (*SMOOTH, *STRUCTURES) if name not in LONG]
    + [pytest.param(name, 1, marks=pytest.mark.thorough) for name in (*SMOOTH, *STRUCTURES)],
)
def test_gradients_agree(name: str, each: int) -> None:
    """Direct and adjoint; differences by one in ``each`` parameters."""
    responses = list(make_responses(file(name), model(name)).values())
    assert len(responses) >= 2
    assert len(model(name).parameters) >= 3
    adjoint, direct = (
        da.sensitivity(motion(name), responses, method=method).values
        for method in ("adjoint", "direct")
    )
    some = slice(None, None, each)
    chosen = list(model(name).parameters)[some]
    method = "finite-difference"
    differences = da.sensitivity(motion(name), responses, wrt=chosen, method=method).values
    p = motion(name).parameters
    scale = np.where(p == 0.0, 1.0, np.abs(p))
    largest = np.abs(adjoint * scale).max(axis=1, keepdims=True)
    assert (largest > 0).all()
    assert (np.abs(adjoint - direct) * scale / largest).max() <= 1e-9
    errors = np.abs(adjoint[:, some] - differences) * scale[some]
    assert (errors / largest).max() <= 1e-6


@pytest.mark.few(10)
@pytest.mark.parametrize("name", FILES)
def test_file_and_script_are_the_same_mechanism(name: str) -> None:
    build = getattr(script("carts"), name) if name.startswith("cart_") else script(name).build
    twin = build().build()
    assert {n: p.value for n, p in twin.parameters.items()} == {
        n: p.value for n, p in model(name).parameters.items()
    }
    again = make_analysis(file(name), twin).run(twin)
    if isinstance(again, da.HarmonicResponse):
        assert (again.inputs, list(again.outputs)) == (
            motion(name).inputs,
            list(motion(name).outputs),
        )
        np.testing.assert_allclose(again.frequencies, motion(name).frequencies, rtol=1e-12)
        size = np.abs(again.table).max(axis=0)
        assert np.all(np.abs(again.table - motion(name).table) <= 1e-11 * size)
        return
    again, trajectory = again.trajectory, motion(name).trajectory
    np.testing.assert_allclose(again.y, trajectory.y, atol=1e-9 * (1 + np.abs(trajectory.y).max()))


@pytest.mark.few(2)
@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[pytest.mark.thorough] * (n in LONG)) for n in OPTIMISED],
)
def test_files_optimise(name: str) -> None:
    design = make_design(file(name), model(name))
    best = da.optimize(model(name), analysis=make_analysis(file(name), model(name)), **design)
    assert best.success
    assert best.violation <= 1e-9
    if name == "path_optimization":
        assert best.fun < 1e-6 * best.history[0].objective
    else:
        assert best.fun < best.history[0].objective


def test_every_script_has_its_number() -> None:
    files = Path(__file__).parent.glob("test_*examples.py")
    tests = "".join(path.read_text(encoding="utf-8") for path in files)
    numbered = re.findall(r'numbers(?:\.__wrapped__)?\("(\w+)", pictures\)', tests)
    assert set(SCRIPTS) - set(numbered) == set()
