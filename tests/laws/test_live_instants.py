"""Driven motions in a page are those of Python: outputs, gradients, status."""

from __future__ import annotations

import numpy as np
import pytest
from live_modules import Modules

import dalembert as da
from dalembert import planar, spatial
from dalembert.results.live import Row
from dalembert.sensitivity.gradient import history_gradients

VALUES, GRADIENTS = 1e-9, 1e-8
"""Largest differences, relative to the size of a measure and to the largest derivative."""


def slider_crank() -> da.Model:
    system = da.System("slider-crank", gravity=(0, -9.81))
    length, speed, mass = (system.parameter(n, x) for n, x in (("l", 0.1), ("w", 2.0), ("m", 3.0)))
    crank = system.add(planar.Bar("crank", length=length, mass=1.0, angle=0.3))
    rod = system.add(planar.Bar("rod", length=0.3, mass=mass))
    system.add(planar.Revolute("O", system.ground.center, crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.PinInSlot("rail", system.ground.center, rod.end))
    drive = planar.RotationalDriver("motor", system.ground, crank, speed * da.t + 0.3)
    system.add(drive)
    return system.build()


def robot() -> da.Model:
    system = da.System("robot", gravity=(0, 0, -9.81))
    reach, speed, mass = (system.parameter(n, x) for n, x in (("l", 0.4), ("w", 1.5), ("m", 2.0)))
    inertia = (0.02, 0.03, 0.01)
    column = spatial.Body("column", mass=3.0, inertia=inertia)
    arm = spatial.Body("arm", mass=mass, inertia=inertia, position=(0.2, 0, 0.5))
    system.add(column)
    system.add(arm)
    base = system.ground.frame((0, 0, 0), axis=(0, 0, 1))
    turn = system.add(spatial.Revolute("turn", base, column.frame((0, 0, 0), axis=(0, 0, 1))))
    shoulder, end = (
        column.frame((0, 0, 0.5), axis=(0, 1, 0)),
        arm.frame((-reach / 2, 0, 0), axis=(0, 1, 0)),
    )
    lift = system.add(spatial.Revolute("lift", shoulder, end))
    system.add(spatial.RotationalDriver("a", turn, speed * da.t))
    system.add(spatial.RotationalDriver("b", lift, 0.3 * da.sin(2 * speed * da.t)))
    return system.build()


MODELS = {slider_crank: [0.13, 2.5, 2.0], robot: [0.45, 1.8, 2.5]}
"""Models, and other values of their parameters."""
RUNS = {
    "kinematics": (da.solve_kinematics, {"step": 0.02}, "kinetic_energy"),
    "some outputs": (da.solve_kinematics, {"outputs": 37}, "potential_energy"),
    "inverse dynamics": (da.solve_inverse_dynamics, {"step": 0.02}, "input_power"),
}
CASES = [(build, name) for build in MODELS for name in RUNS]


def names_of(motion: da.Motion) -> list[str]:
    model = motion.model
    return [name for name in model.measure_names if model.expression(name).sx.numel() == 1]


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory: pytest.TempPathFactory) -> dict:
    """The motion in Python, gradients of weighted sums of a measure, and the outcome in a page."""
    modules, expected = Modules(tmp_path_factory.mktemp("live")), {}
    for build, name in CASES:
        solve, options, subject = RUNS[name]
        model, values = build(), np.array(MODELS[build])
        motion = solve(model, 1.0, **options)
        assert motion.analysis.live_obstacle(motion) == ""
        names, weights = names_of(motion), np.linspace(-1, 2, motion.time.size)
        rows = [Row(model.expression(n).sx) for n in names]
        data = motion.analysis.live_functions(motion, rows, motion.time).page_data()
        label = f"{build.__name__}, {name}"
        modules.add(label, data, values, [{names.index(subject): weights}])
        other = motion.analysis.run(model, values)
        (slopes,) = history_gradients(other, [subject], list(model.parameters))
        expected[build, name] = label, other, weights @ slopes
    results, _ = modules.run()
    return {key: (other, slope, results[n]) for key, (n, other, slope) in expected.items()}


@pytest.mark.parametrize(("build", "name"), CASES)
def test_motion_equals_that_of_python(build, name: str, outcomes) -> None:
    other, slope, outcome = outcomes[build, name]
    assert outcome.same
    for measure, values in zip(names_of(other), outcome.table, strict=True):
        expected = other.values(measure)
        size = np.fmax(1.0, np.abs(expected).max())
        np.testing.assert_allclose(values, expected, rtol=0, atol=VALUES * size, err_msg=measure)
    np.testing.assert_allclose(
        outcome.gradients[0], slope, rtol=0, atol=GRADIENTS * np.abs(slope).max()
    )


@pytest.mark.parametrize(("build", "name"), CASES)
def test_status_equals_that_of_python(build, name: str, outcomes) -> None:
    other, _, outcome = outcomes[build, name]
    wanted = {"outcome": other.status.outcome.value, "message": other.status.message}
    assert {key: outcome.status[key] for key in wanted} == wanted
