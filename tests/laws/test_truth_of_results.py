"""Whatever is analysed: what is called completed satisfies the model's own equations."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from registry import CASES, PLANAR, Builder, Observer, model_of
from scipy.linalg import null_space, qr
from spatial_twins import rotation

import dalembert as da
from dalembert import planar, sin, spatial, t
from dalembert.analysis.equilibrium import mechanism_equilibrium
from dalembert.analysis.kinematics.run import KinematicsRun
from dalembert.analysis.model_residuals import ModelResiduals
from dalembert.formulations.base import Level
from dalembert.results.status import Outcome

EVERY = tuple(Level)


def built(name: str) -> da.System:
    builder = Builder(name.replace(" ", "-"), True, Observer(), CASES[name].dimension)
    CASES[name].build(builder)
    return builder.system


def driven(name: str) -> da.Model:
    """The case with drivers on as many coordinates as it leaves free, the best conditioned ones."""
    free, system = model_of(name), built(name)
    names = {body.name for body in free.bodies}
    e, y = free.equations, free.start.y
    jacobian = ca.Function("c", [e.t, e.y, e.p], [e.jacobian])(0.0, y, free.nominal).full()
    ways = null_space(jacobian) if jacobian.size else np.eye(free.start.v.size)
    ways[[owner not in names for owner in free.guesses.owners]] = 0.0
    for k in qr(ways.T, pivoting=True)[2][: free.diagnosis.free]:
        owner, _, letter = free.guesses.names[k].partition(".")
        body, law = system.elements[owner], float(y[k]) + 0.03 * sin(5 * t)
        if letter == "angle":
            driver = planar.RotationalDriver(f"D{k}", system.ground, body, law)
        else:
            direction = (1.0, 0.0) if letter == "x" else (0.0, 1.0)
            driver = planar.CoordinateDriver(f"D{k}", body.center, law, direction=direction)
        system.add(driver)
    return system.build()


def tied(name: str) -> da.Model:
    """The case with every body on a bushing, so that it comes to rest."""
    system, start = built(name), model_of(name).start.y
    names = model_of(name).guesses.names
    for body in (system.elements[each.name] for each in model_of(name).bodies):
        if body.dimension == 3:
            system.add(_held_in_space(model_of(name), system.ground, body))
            continue
        x, y = (float(start[names.index(f"{body.name}.{letter}")]) for letter in "xy")
        turned = {"rotational_stiffness": 50.0} if f"{body.name}.angle" in names else {}
        place = system.ground.point(x, y)
        tie = planar.Bushing(f"T{body.name}", place, body.center, stiffness=(200, 300), **turned)
        system.add(tie)
    return system.build()


def _held_in_space(model: da.Model, ground, body):
    """A bushing where a body in space starts, a spring of a particle."""
    names = model.guesses.names
    pose = model.start.y[[k for k, n in enumerate(names) if n.startswith(f"{body.name}.")]]
    if not body.rotates:
        return spatial.Spring(f"T{body.name}", ground.point(*pose), body.center, stiffness=200)
    ends = ground.frame(pose[:3], axes=rotation(pose[3:])), body.frame(body.center_of_mass)
    stiffness, turned = (200, 300, 250), (50, 40, 60)
    return spatial.Bushing(f"T{body.name}", *ends, stiffness=stiffness, rotational_stiffness=turned)


def open_by(motion: da.Motion, levels=EVERY, forces: bool = True) -> float:
    residuals = ModelResiduals(motion.model, motion.trajectory, motion.parameters)
    shares = [residuals.of_level(level).share for level in levels]
    return max([*shares, residuals.of_motion.share] if forces else shares)


@pytest.mark.few(14)
@pytest.mark.parametrize("name", PLANAR)
def test_driven_motions_are_true(name):
    """Kinematics and inverse dynamics, at the outputs and between them."""
    model = driven(name)
    kinematics = da.solve_kinematics(model, 0.1, step=0.01)
    inverse = da.solve_inverse_dynamics(model, 0.1, step=0.01)
    for motion, forces in ((kinematics, False), (inverse, True)):
        assert motion.status.success, motion.status
        assert open_by(motion, forces=forces) < 1e-9
        assert open_by(motion.at(np.array([0.033, 0.087])), forces=forces) < 1e-9


@pytest.mark.few(7)
@pytest.mark.parametrize("name", CASES)
def test_equilibria_are_true(name):
    rest = da.solve_equilibrium(tied(name))
    assert rest.status.success, rest.status
    assert open_by(rest, (Level.POSITION,)) < 1e-8


# a solver that errs ---------------------------------------------------------------------------


@pytest.mark.few(3)
@pytest.mark.parametrize(
    ("part", "message"),
    [(0, "m at t"), (1, "m/s at t"), (2, "m/s² at t"), (3, "equation of motion")],
)
@pytest.mark.parametrize("solve", [da.solve_kinematics, da.solve_inverse_dynamics])
def test_a_wrong_driven_motion_is_a_status(monkeypatch, solve, part, message):
    """Positions, speeds, accelerations or forces that a march gets wrong at one instant."""
    model, march = driven("revolute"), KinematicsRun.march

    def spoilt(run, first, report):
        times, table = march(run, first, report)
        table[part * run.n, 7] += (1e-3, 1e-3, 1.0, 1.0)[part]
        return times, table

    monkeypatch.setattr(KinematicsRun, "march", spoilt)
    motion = solve(model, 0.1, step=0.01)
    if part == 3 and solve is da.solve_kinematics:
        assert motion.status.success  # it has no forces
        return
    assert motion.status.outcome is Outcome.VIOLATED and message in motion.status.message
    assert "at t = 0.07 s" in motion.status.message and motion.time.size == 11


@pytest.mark.parametrize(
    ("moved", "message"),
    [((0.0, 1e-3), "is violated by"), ((1e-3, 0.0), "the equation of motion of")],
)
def test_a_wrong_equilibrium_is_a_status(monkeypatch, moved, message):
    """Off its constraint, or along it out of balance."""
    system = da.System("hanging", gravity=(0.0, -9.81))
    ball = system.add(planar.Particle("ball", mass=2.0, position=(0.1, 1.0)))
    system.add(planar.CoordinateDriver("rail", ball.center, 1.0, direction=(0.0, 1.0)))
    place = system.ground.point(0.0, 1.0)
    system.add(planar.Bushing("tie", place, ball.center, stiffness=(300.0, 200.0)))
    model, solve = system.build(), mechanism_equilibrium.solve

    def spoilt(*arguments):
        root = solve(*arguments)
        return replace(root, x=root.x + moved)

    assert da.solve_equilibrium(model).status.success
    monkeypatch.setattr(mechanism_equilibrium, "solve", spoilt)
    rest = da.solve_equilibrium(model)
    assert rest.status.outcome is Outcome.VIOLATED and message in rest.status.message
    with pytest.raises(da.AnalysisError, match="no equilibrium"):
        da.linearize(model)


def test_forces_without_bound_are_a_status():
    """A loaded parallelogram driven through its flat position: it moves, but no force holds it."""
    system = da.System("flat", gravity=(0.0, -9.81))
    crank = system.add(planar.Bar("crank", length=0.3, mass=1.0, angle=1.0))
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=1.0))
    rocker = system.add(planar.Bar("rocker", length=0.3, mass=1.0, angle=1.0))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("P", system.ground.point(1, 0), rocker.start))
    system.add(planar.RotationalDriver("motor", system.ground, crank, np.pi / 2 + 2 * np.pi * t))
    model = system.build()
    assert da.solve_kinematics(model, 1.0, step=0.05).status.success
    lost = da.solve_inverse_dynamics(model, 1.0, step=0.05)
    assert lost.status.outcome is Outcome.VIOLATED
    assert "the equation of motion of rocker.angle is open" in lost.status.message
    assert da.solve_inverse_dynamics(model, 1.0, step=0.037).status.success  # beside it
