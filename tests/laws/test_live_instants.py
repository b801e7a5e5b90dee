"""Driven motions, equilibria and modes in a page equal those of Python, with gradients."""

from __future__ import annotations

import re
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from live_modules import Modules
from thorough import collected

import dalembert as da
from dalembert import planar, spatial
from dalembert.results.mechanism_modes import MEASURES
from dalembert.results.sources import Row
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


def hanging_linkage() -> da.Model:
    system = da.System("hanging linkage", gravity=(0, -9.81))
    length, stiffness = system.parameter("l", 0.4), system.parameter("k", 60.0)
    mass = system.parameter("m", 3.0)
    crank = system.add(planar.Bar("crank", length=length, mass=1.0, angle=-1.0))
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=mass))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=3.0, angle=-1.6))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.start))
    system.add(planar.Revolute("C", rocker.end, system.ground.point(1.0, 0.1)))
    top = system.ground.point(0.5, 0.5)
    system.add(planar.Spring("spring", top, coupler.center, stiffness=stiffness, damping=2.0))
    return system.build()


def hanging_body() -> da.Model:
    system = da.System("hanging body", gravity=(0, 0, -9.81))
    reach, stiffness, mass = (
        system.parameter(n, x) for n, x in (("l", 0.3), ("k", 200.0), ("m", 2.0))
    )
    body = spatial.Body("body", mass=mass, inertia=(0.02, 0.03, 0.01), position=(0.1, 0, -0.5))
    system.add(body)
    hook, corner = body.point(0.0, 0.05, 0.2), body.point(reach, 0.1, -0.1)
    system.add(spatial.Spherical("hook", system.ground.point(0, 0, -0.2), hook))
    posts = (0.5, 0.3, 0.2), (-0.4, 0.5, 0.0), (0.1, -0.6, -0.3)
    for k, post in enumerate(posts):
        spring = spatial.Spring(
            f"s{k}", system.ground.point(*post), corner, stiffness=stiffness, damping=0.5
        )
        system.add(spring)
    return system.build()


def controlled_arm() -> da.Model:
    """An arm under gravity, held by a PID controller whose actuator has a time constant."""
    system = da.System("controlled arm", gravity=(0, -9.81))
    gain, target, mass = (
        system.parameter(n, x) for n, x in (("gain", 150.0), ("target", 0.4), ("m", 2.0))
    )
    arm = system.add(planar.Bar("arm", length=0.6, mass=mass, angle=0.3))
    system.add(planar.Revolute("O", system.ground.center, arm.start))
    control = da.blocks.PID(
        "control",
        target,
        arm.angle,
        proportional=gain,
        integral=60.0,
        derivative=30.0,
        filter_time=0.02,
    )
    system.add(control)
    lag = system.add(da.blocks.LowPass("lag", control.output, cutoff=200.0))
    system.add(planar.Torque("motor", arm, lag.output))
    return system.build()


def sampled_lift() -> da.Model:
    """A cabin on a spring with a sampled PID controller and a delayed, slower sensor."""
    system = da.System("sampled lift", gravity=(0, -9.81))
    gain, target, mass = (
        system.parameter(n, x) for n, x in (("gain", 80.0), ("target", 0.3), ("m", 2.0))
    )
    cabin = system.add(planar.Particle("cabin", mass=mass, position=(0, 0.2)))
    system.add(planar.PinInSlot("rail", system.ground.center, cabin.center, axis=(0, 1)))
    ends = system.ground.point(0, 1.0), cabin.center
    system.add(planar.Spring("spring", *ends, stiffness=30.0, damping=8.0, free_length=0.4))
    hold = system.add(da.blocks.ZeroOrderHold("hold", cabin.y, sample_time=0.05))
    gains = {"proportional": gain, "integral": 40.0, "derivative": 5.0, "filter_time": 0.05}
    control = da.blocks.SampledPID("control", target, hold.output, sample_time=0.02, **gains)
    system.add(control)
    system.add(planar.Force("drive", cabin.center, (0, control.output)))
    return system.build()


MODELS = {slider_crank: [0.13, 2.5, 2.0], robot: [0.45, 1.8, 2.5]}
"""Models, and other values of their parameters."""
RUNS = {
    "kinematics": (da.solve_kinematics, {"step": 0.02}, "kinetic_energy"),
    "long steps": (da.solve_kinematics, {"step": 0.25}, "kinetic_energy"),
    "some outputs": (da.solve_kinematics, {"outputs": 37}, "potential_energy"),
    "inverse dynamics": (da.solve_inverse_dynamics, {"step": 0.02}, "input_power"),
}
RESTING = {hanging_linkage: [0.45, 80.0, 2.0], hanging_body: [0.35, 260.0, 2.5]}
WITH_STATES = {controlled_arm: [180.0, 0.9, 2.5], sampled_lift: [70.0, 0.45, 3.0]}
UNSTABLE = {
    controlled_arm: [[180.0, 0.9, 2.5], [4000.0, 0.9, 2.5]],
    sampled_lift: [[70.0, 0.45, 3.0], [900.0, 0.45, 3.0]],
}
"""Parameters with and without a stable equilibrium."""
CASES = [(build, name) for build in MODELS for name in RUNS]
CASES += [(build, "equilibrium") for build in RESTING | WITH_STATES]


def solve(build, name: str) -> tuple[da.Motion, str, np.ndarray]:
    """The result of a model, a measure, and other parameter values."""
    if name == "equilibrium":
        return (
            da.solve_equilibrium(build()),
            "potential_energy",
            np.array((RESTING | WITH_STATES)[build]),
        )
    run, options, subject = RUNS[name]
    return run(build(), 1.0, **options), subject, np.array(MODELS[build])


def names_of(motion: da.Motion) -> list[str]:
    model = motion.model
    return [name for name in model.measure_names if model.expression(name).sx.numel() == 1]


@pytest.fixture(scope="module")
def outcomes(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict:
    """The motion in Python, gradients of weighted sums of a measure, and the outcome in a page."""
    modules, expected = Modules(tmp_path_factory.mktemp("live")), {}
    for build, name in collected(request, "build", "name"):
        motion, subject, values = solve(build, name)
        model = motion.model
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


@pytest.mark.few(1)
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


@pytest.mark.few(1)
@pytest.mark.parametrize(("build", "name"), CASES)
def test_status_equals_that_of_python(build, name: str, outcomes) -> None:
    other, _, outcome = outcomes[build, name]
    wanted = {"outcome": other.status.outcome.value, "message": other.status.message}
    values = {key: outcome.status[key] for key in wanted}
    assert without_numbers(values) == without_numbers(wanted)


@pytest.mark.few(1)
@pytest.mark.parametrize("build", UNSTABLE)
def test_growing_motions_about_equilibria_with_states(build, tmp_path: Path) -> None:
    """Eigenvalues of states and of a period of samples decide as in Python."""
    motion, modules, expected = da.solve_equilibrium(build()), Modules(tmp_path), {}
    row = [Row(motion.model.expression("potential_energy").sx)]
    data = motion.analysis.live_functions(motion, row, motion.time).page_data()
    for k, values in enumerate(UNSTABLE[build]):
        expected[str(k)] = motion.analysis.run(motion.model, np.array(values)).status.message
        modules.add(str(k), data, np.array(values))
    outcomes, _ = modules.run()
    ends = [expected[key].rpartition(", ")[2] for key in outcomes]
    assert ends == ["stable", "not a stable position"]
    assert [outcome.status["message"].rpartition(", ")[2] for outcome in outcomes.values()] == ends


def test_states_that_parameters_start_are_no_equilibrium_of_a_page() -> None:
    """Bristles keep their values at the start, from which a page could not follow them."""
    system = da.System("block", gravity=(0, -9.81))
    start = system.parameter("start", 1e-4)
    block = system.add(planar.Particle("block", mass=1.0))
    system.add(planar.PinInSlot("rail", system.ground.center, block.center))
    ends = system.ground.point(-1, 0), block.center
    system.add(planar.Spring("spring", *ends, stiffness=50.0, free_length=1.0))
    bristle = system.add(da.blocks.State("bristle", start=start, unit="m"))
    bristle.rate = block.vx * (1 - bristle.value**2)
    rest = da.solve_equilibrium(system.build())
    assert "bristle" in rest.analysis.live_obstacle(rest)


def without_numbers(texts: dict[str, str]) -> dict[str, str]:
    """Texts without residuals and numbers of iterations, which rounding changes."""
    return {key: re.sub(r"residual \S+ N after \d+ iterations?", "", texts[key]) for key in texts}


def test_locked_mechanism_has_the_same_outcome(tmp_path: Path) -> None:
    """A crank longer than its rod locks."""
    model, values = slider_crank(), np.array([0.35, 2.5, 2.0])
    motion = da.solve_kinematics(model, 2.0, step=0.02)
    row = [Row(model.expression("rod.x").sx)]
    modules = Modules(tmp_path)
    data = motion.analysis.live_functions(motion, row, motion.time).page_data()
    modules.add("locked", data, values)
    outcome, expected = modules.run()[0]["locked"], motion.analysis.run(model, values).status
    assert outcome.table is None
    assert outcome.status["outcome"] == expected.outcome.value == da.Outcome.LOCKED.value


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("build", "equilibrium"),
    [*((build, rest) for build in RESTING for rest in (True, False)), (controlled_arm, True)],
)
def test_modes_equal_those_of_python(build, equilibrium: bool, tmp_path: Path) -> None:
    """Frequencies, damping and eigenvalues about an equilibrium and an assembled position."""
    analysis, model = da.Modal(equilibrium=equilibrium), build()
    values = np.array((RESTING | WITH_STATES)[build])
    modes = analysis.run(model)
    assert analysis.live_obstacle(modes) == ""
    rows = [Row(measure.sx) for measure in MEASURES.values()]
    data = analysis.live_functions(modes, rows, modes.numbers).page_data()
    other, modules = analysis.run(model, values), Modules(tmp_path)
    first, last = np.eye(modes.numbers.size)[[0, -1]]
    modules.add("modes", data, values, [{0: first}, {2: last}])
    outcome = modules.run()[0]["modes"]
    responses = [da.at(1, "frequency"), da.at(int(modes.numbers[-1]), "damping_ratio")]
    slopes = da.sensitivity(other, responses, method="adjoint").values
    size = np.abs(other.values("angular_frequency")).max()
    expected = [other.values(name) for name in MEASURES]
    np.testing.assert_allclose(outcome.table, expected, rtol=0, atol=VALUES * size)
    for values, wanted in zip(outcome.gradients, slopes, strict=True):
        np.testing.assert_allclose(values, wanted, rtol=0, atol=GRADIENTS * np.abs(wanted).max())
    assert outcome.status["message"] == other.status.message


@pytest.mark.thorough
def test_energies_of_inverse_dynamics(tmp_path: Path) -> None:
    """Dissipated energy and input along the path, with the gradient of their sum."""
    model, values, step = slider_crank(), np.array(MODELS[slider_crank]), 1e-4
    motion = da.solve_inverse_dynamics(model, 1.0, step=0.02, outputs=7)
    rows = [Row(ca.SX(0), (1.0, 0.0), True), Row(ca.SX(0), (0.0, 1.0), True)]
    functions = motion.analysis.live_functions(motion, rows, motion.time)
    modules, weights = Modules(tmp_path), np.linspace(-1, 2, motion.time.size)
    modules.add("energies", functions.page_data(), values, [{0: weights, 1: weights}])
    outcome = modules.run()[0]["energies"]

    def work(p: np.ndarray) -> np.ndarray:
        return motion.analysis.run(model, p).trajectory.work

    expected = work(values)
    size = np.abs(expected).max()
    np.testing.assert_allclose(outcome.table, expected, rtol=0, atol=VALUES * size)
    for k, slope in enumerate(outcome.gradients[0]):
        change = step * values[k] * np.eye(values.size)[k]
        by_two = (work(values + change) - work(values - change)) / (2 * step * values[k])
        by_four = (work(values + 2 * change) - work(values - 2 * change)) / (4 * step * values[k])
        difference = weights @ ((4 * by_two - by_four) / 3).sum(axis=0)
        assert abs(slope - difference) <= 1e-8 * np.abs(outcome.gradients[0]).max()
