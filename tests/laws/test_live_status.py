"""A page judges its runs as Python does: the same outcome, message and time."""

from __future__ import annotations

import numpy as np
import pytest
from live_modules import Modules, Outcome
from thorough import collected

import dalembert as da
from dalembert import planar
from dalembert.results.sources import Row

GRAVITY = (0.0, -9.81)


def four_bar() -> da.Model:
    system = da.System("four-bar", gravity=GRAVITY)
    speed = system.parameter("speed", 1.0)
    crank = planar.Bar("crank", length=0.3, mass=1.5, angle=1.5, angular_velocity=speed)
    system.add(crank)
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=5.0))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=3.0, angle=1.0))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    return system.build()


def mass_on_spring() -> da.Model:
    system = da.System("oscillator", gravity=GRAVITY)
    stiffness = system.parameter("stiffness", 100.0)
    stone = system.add(planar.Particle("stone", mass=1.0, position=(1.0, 0.0)))
    spring = planar.Spring("spring", system.ground.center, stone.center, stiffness=stiffness)
    system.add(spring)
    return system.build()


FREE = da.Stabilization()
RUNS = {
    "completed": (four_bar, 2.0, {"duration": 1.0, "step": 0.004}),
    "error control": (four_bar, 2.0, {"duration": 1.0}),
    "implicit": (
        four_bar,
        2.0,
        {"duration": 0.5, "step": 0.01, "integrator": da.GeneralizedAlpha()},
    ),
    "constraints drift": (
        four_bar,
        12.0,
        {"duration": 1.0, "step": 0.02, "integrator": da.Heun(), "stabilization": FREE},
    ),
    "no projection": (
        four_bar,
        1.2,
        {"duration": 1.0, "step": 0.01, "integrator": da.Heun(), "stabilization": FREE},
    ),
    "damped by long steps": (
        mass_on_spring,
        110.0,
        {"duration": 2.0, "step": 0.1, "integrator": da.BackwardEuler()},
    ),
    "excited by long steps": (
        mass_on_spring,
        400.0,
        {"duration": 1.0, "step": 0.02, "integrator": da.Euler()},
    ),
    "unstable": (mass_on_spring, 1e12, {"duration": 2.0, "step": 0.01, "integrator": da.Heun()}),
    "steps too short": (mass_on_spring, 1e30, {"duration": 0.2}),
}
"""Model, value of its parameter, options of the run."""


QUICK = ("completed", "constraints drift", "damped by long steps", "unstable")
"""One run of each outcome."""


@pytest.fixture(scope="module")
def outcomes(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, tuple[da.Status, Outcome]]:
    """Status in Python, and outcome in the page."""
    modules = Modules(tmp_path_factory.mktemp("live"))
    expected = {}
    names = collected(request, "name") | set(QUICK)
    for name in (name for name in RUNS if name in names):
        build, value, options = RUNS[name]
        model = build()
        motion = da.solve_dynamics(model, **{"balance": 1e9} | options)
        assert motion.status.success
        motion.analysis = da.Dynamics(**options)
        body = "crank" if build is four_bar else "stone"
        row = Row(model.expression(f"{body}.x").sx)
        data = motion.analysis.live_functions(motion, [row], motion.time).page_data()
        modules.add(name, data, np.array([value]))
        expected[name] = motion.analysis.run(model, np.array([value])).status
    results, _ = modules.run()
    return {name: (status, results[name]) for name, status in expected.items()}


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[pytest.mark.thorough] * (n not in QUICK)) for n in RUNS],
)
def test_status_equals_that_of_python(name: str, outcomes) -> None:
    expected, outcome = outcomes[name]
    status = outcome.status
    assert (status["outcome"], status["message"]) == (expected.outcome.value, expected.message)
    assert status["success"] == expected.success
    assert status["time"] == pytest.approx(expected.time, rel=1e-9)
    assert status["residual"] == pytest.approx(expected.residual, rel=1e-6, abs=1e-13)


def test_outcomes_of_all_kinds_occur(outcomes) -> None:
    kinds = {status.outcome for status, _ in outcomes.values()}
    wanted = {da.Outcome.COMPLETED, da.Outcome.VIOLATED, da.Outcome.UNBALANCED, da.Outcome.DIVERGED}
    assert wanted <= kinds
