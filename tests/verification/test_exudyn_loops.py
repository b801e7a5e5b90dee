"""Closed loops in space against Exudyn, as its steps shrink.

Source: Exudyn 1 (J. Gerstmayr, Multibody System Dynamics 60, 2024), a code of its own: redundant
coordinates with Euler parameters, constraints solved for by steps of generalised α. It starts from
the same positions and speeds. Its answer comes nearer to ours with the square of its step, so that
without any step it is ours.
"""

from __future__ import annotations

import functools
import itertools

import numpy as np
import pytest

import dalembert as da
from dalembert import spatial

exu = pytest.importorskip("exudyn", exc_type=ImportError)
from exudyn.rigidBodyUtilities import RigidBodyInertia  # noqa: E402

GRAVITY = (0.0, 0.0, -9.81)
DURATION, STEPS = 0.4, (4e-3, 2e-3, 1e-3)
PLACES = np.array([(0, 0, 0), (0.3, 0.05, 0.1), (1.0, 0.4, 0.5), (0.9, 0.7, 0.0)])
"""Joint of the crank on the ground, two balls, joint of the last body on the ground."""
AXES = np.array([(0.1, 0.2, 1.0), (1.0, 0.3, 0.2)])
"""Of the joints on the ground."""
MIDDLES = (PLACES[1:] + PLACES[:-1]) / 2
NAMES, MASSES = ("crank", "rod", "last"), (1.2, 0.7, 1.5)
MOMENTS = np.array([0.03, 0.05, 0.04])
"""For a mass of one."""
SPIN = 5.0
"""Of the crank about its axis at the start."""
FREE = {spatial.Revolute: 5, spatial.Prismatic: 2}
"""Kind of joint → the one motion of its axes, three slides and three turns, that it leaves free."""


FIRST, LAST = 0, -1


def axes_about(z: np.ndarray) -> np.ndarray:
    """Axes as columns, of which z is the last."""
    across = np.linalg.svd(z[None])[2][1]
    return np.column_stack([across, np.cross(z / np.linalg.norm(z), across), z / np.linalg.norm(z)])


@functools.cache
def loop(kind: type) -> da.Motion:
    """A crank on a hinge, a rod on two balls and a body on a hinge or slide."""
    system = da.System("loop", gravity=GRAVITY)
    bodies = [
        system.add(
            spatial.Body(
                name,
                mass=mass,
                inertia=tuple(MOMENTS * mass),
                position=tuple(middle),
                rotation=da.rotation.identity(),
            )
        )
        for name, mass, middle in zip(NAMES, MASSES, MIDDLES, strict=True)
    ]

    def ball(name: str, k: int) -> None:
        ends = (bodies[n].point(*(PLACES[k] - MIDDLES[n])) for n in (k - 1, k))
        system.add(spatial.Spherical(name, *ends))

    def on_ground(kind: type, name: str, k: int) -> None:
        axes = {"axes": axes_about(AXES[k])}
        hold = system.ground.frame(tuple(PLACES[k]), **axes)
        system.add(kind(name, hold, bodies[k].frame(tuple(PLACES[k] - MIDDLES[k]), **axes)))

    on_ground(spatial.Revolute, "A", FIRST)
    ball("B", 1)
    ball("C", 2)
    on_ground(kind, "D", LAST)
    system.initial(system.formula("A.angle_rate"), SPIN)
    return da.solve_dynamics(
        system.build(), DURATION, integrator=da.DormandPrince853(1e-12, 1e-12), outputs=2
    )


def theirs(run: da.Motion, kind: type, step: float) -> np.ndarray:
    """(3, 3) mass centres at the end."""
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    ground = mbs.CreateGround()
    bodies = [
        mbs.CreateRigidBody(
            referencePosition=list(middle),
            initialVelocity=run[f"{name}.velocity"].values[0].tolist(),
            initialAngularVelocity=run[f"{name}.angular_velocity"].values[0].tolist(),
            inertia=RigidBodyInertia(mass, np.diag(MOMENTS * mass)),
            gravity=list(GRAVITY),
        )
        for name, mass, middle in zip(NAMES, MASSES, MIDDLES, strict=True)
    ]
    for k in (1, 2):
        mbs.CreateSphericalJoint("", bodies[k - 1 : k + 1], list(PLACES[k]))
    for k, joint in ((FIRST, spatial.Revolute), (LAST, kind)):
        mbs.CreateGenericJoint(
            "",
            [ground, bodies[k]],
            list(PLACES[k]),
            rotationMatrixAxes=axes_about(AXES[k]),
            constrainedAxes=[int(motion != FREE[joint]) for motion in range(6)],
        )
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.endTime = DURATION
    settings.timeIntegration.numberOfSteps = round(DURATION / step)
    settings.timeIntegration.newton.relativeTolerance = 1e-11
    settings.solution.file.write = False
    settings.timeIntegration.verboseMode = 0
    assert mbs.SolveDynamic(settings)
    place = exu.OutputVariableType.Position
    return np.array([mbs.GetObjectOutputBody(b, place, [0.0, 0.0, 0.0]) for b in bodies])


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", FREE)
def test_exudyn_converges_to_the_same_motion(kind):
    motion = loop(kind)
    assert motion.status.success
    ours = np.array([motion[f"{name}.position"].values[-1] for name in NAMES])
    assert np.linalg.norm(ours - MIDDLES, axis=1).min() > 0.05  # it has gone somewhere
    computed = [theirs(motion, kind, step) for step in STEPS]
    errors = [np.abs(one - ours).max() for one in computed]
    for coarse, fine in itertools.pairwise(errors):
        assert 3.6 < coarse / fine < 4.4
    extrapolated = (4 * computed[-1] - computed[-2]) / 3
    assert np.abs(extrapolated - ours).max() < 1e-2 * errors[-1]
