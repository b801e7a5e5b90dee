"""Gradients through stiff contact and friction: those of whole runs, by every adaptive integrator.

At the limit of stability of an explicit method the states are accurate, and products of the step
tangents grow without bound: they reached 1e57 here.
"""

from __future__ import annotations

import functools

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.elements.registry import CONTACT_LAWS, FRICTIONS
from dalembert.integrators.registry import INTEGRATORS
from dalembert.sensitivity.marching.stable_steps import growth_of

kit = planar.contact
END = 0.025
CASES = {
    "Hertz": (kit.Hertz(stiffness=3e6), kit.Coulomb(0.2)),
    "HuntCrossley": (kit.HuntCrossley(stiffness=1e5, damping=0.3), kit.Coulomb(0.2)),
    "LankaraniNikravesh": (
        kit.LankaraniNikravesh(stiffness=1e5, restitution=0.9, impact_speed=2.4),
        kit.Stribeck(0.2, 0.3),
    ),
    "Flores": (
        kit.Flores(stiffness=1e5, restitution=0.6, impact_speed=2.4),
        kit.LuGre(0.2, 0.3, stiffness=1e4),
    ),
    "KelvinVoigt": (kit.KelvinVoigt(stiffness=1e5, damping=50.0), kit.Coulomb(0.2)),
    "JointFriction": None,
}
ADAPTIVE = {name: kind for name, kind in INTEGRATORS.items() if kind().adaptive}
RESPONSE = da.final("body.x")


@functools.cache
def model(name: str) -> da.Model:
    """A ball that hits the floor and begins to roll, or a slider that friction stops."""
    system = da.System("stiff", gravity=(0.0, -9.81))
    speed = system.parameter("speed", 0.1, unit="m/s")
    start = {"position": (0, 0.105), "velocity": (speed, -2.4)}
    if CASES[name] is None:
        start = {"velocity": (speed, 0)}
    body = system.add(planar.Body("body", mass=1.0, inertia=4e-3, **start))
    if CASES[name] is None:
        guide = planar.Prismatic("guide", system.ground.center, body.center, axis=(1, 0))
        system.add(planar.JointFriction("rub", system.add(guide), coulomb=40.0))
        return system.build()
    law, friction = CASES[name]
    floor = kit.HalfPlane(system.ground.center, normal=(0, 1))
    system.add(
        planar.Contact("touch", floor, kit.Circle(body.center, 0.1), law=law, friction=friction)
    )
    return system.build()


def solve(name: str, integrator, speed: float = 0.1) -> da.Motion:
    motion = da.solve_dynamics(
        model(name), END, integrator=integrator, parameters={"speed": speed}, backend="vm"
    )
    assert motion.status.success
    return motion


def whole_runs(name: str, h: float = 1e-4) -> float:
    """Differences of fourth order of runs of their own."""
    exact = da.Radau(rtol=1e-10, atol=1e-12)
    values = {k: da.evaluate(solve(name, exact, 0.1 + k * h), RESPONSE) for k in (-2, -1, 1, 2)}
    return (8 * (values[1] - values[-1]) - (values[2] - values[-2])) / (12 * h)


def test_every_law_and_friction_is_here():
    used = [type(part).__name__ for case in CASES.values() if case for part in case]
    assert {*CONTACT_LAWS, *FRICTIONS} - {"Restitution"} == {*used}


TOLERANCES = {1e-6: 5e-2, 1e-7: 3e-2, 1e-9: 1e-2}
"""Of the run → of the gradient."""


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("name", "each"),
    [(name, 3) for name in CASES]
    + [pytest.param(name, 1, marks=pytest.mark.thorough) for name in CASES],
)
def test_gradients_are_those_of_whole_runs(name, each):
    """Every integrator with each tolerance, or with one of ``each`` in turn."""
    wanted, divided = whole_runs(name), 0
    for i, kind in enumerate(ADAPTIVE.values()):
        for j, (rtol, allowed) in enumerate(TOLERANCES.items()):
            if (i + j) % each:
                continue
            motion = solve(name, kind(rtol=rtol))
            text = f"{kind.__name__}({rtol})"
            gradient = da.sensitivity(motion, RESPONSE, method="direct")
            np.testing.assert_allclose(gradient.item(), wanted, rtol=allowed, err_msg=text)
            warned = any("limit of stability" in note for note in gradient.attrs["notes"])
            assert warned is not growth_of(motion).harmless
            divided += warned
        adjoint = da.sensitivity(motion, RESPONSE, method="adjoint")
        np.testing.assert_allclose(adjoint.item(), gradient.item(), rtol=1e-8, err_msg=text)
    assert divided >= (2 if each == 1 else 1) or name == "Flores"  # the others do reach the limit
