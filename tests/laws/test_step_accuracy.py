"""Runs of fixed steps that are too long say so, with a step that would do."""

from __future__ import annotations

import functools
import re

import numpy as np
import pytest
from registry import INTEGRATORS

import dalembert as da
from dalembert import planar

FIXED = [n for n, i in INTEGRATORS.items() if not i.controls_error and n != "Euler"]
END = 0.05


@functools.cache
def gear():
    """A planet on a fast arm."""
    system = da.System("planetary", gravity=(0.0, -9.81))
    arm = system.add(planar.Bar("arm", length=0.2, mass=1.0, angle=0.0, angular_velocity=500.0))
    planet = system.add(
        planar.Body("planet", mass=0.4, inertia=1e-3, position=(0.1, 0.0), angular_velocity=-300.0)
    )
    system.add(planar.Revolute("sun", system.ground.center, arm.start))
    system.add(planar.Revolute("axle", arm.end, planet.center))
    return system.build()


def run(step: float | None, integrator: da.RK4, **options):
    return da.solve_dynamics(gear(), END, step=step, integrator=integrator, **options)


@functools.cache
def exact() -> float:
    return run(None, da.DormandPrince853(1e-12, 1e-12)).values("arm.angle")[-1]


@pytest.mark.few(2)
@pytest.mark.parametrize("name", FIXED)
def test_steps_that_are_too_long_are_told_with_those_that_do(name):
    """The advice is followed until there is none; then the run is right to a few per cent."""
    integrator, step, trials = INTEGRATORS[name], 5e-3, 0
    while trials < 8:  # 2.5 rad a step at first
        motion = run(step, integrator, outputs=2)
        messages = [re.search("use steps below (.*) s, or", text) for text in motion.warnings]
        wanted = [float(match[1]) for match in messages if match]
        if motion.status.success and not wanted:
            break
        step, trials = (wanted[0] if wanted else step / 2), trials + 1
    assert 0 < trials < 8
    assert abs(motion.values("arm.angle")[-1] / exact() - 1) < 0.05


@pytest.mark.parametrize("memory", [2.0**28, 1e3])
def test_the_number_is_about_the_error(memory):
    """And the same where few states are kept."""
    motion = run(1e-3, da.Trapezoidal(), outputs=2, memory=memory)
    assert any("long for this motion" in text for text in motion.warnings)
    computed = abs(motion.values("arm.angle")[-1] - exact()) / np.ptp([0, exact()])
    assert computed / 10 < motion.error_estimate.share < 100 * computed


def test_short_steps_and_error_control_are_not_doubted():
    assert not run(2e-5, da.RK4()).warnings
    assert not run(None, da.DormandPrince()).warnings
    assert not run(1e-2, da.CVODES()).warnings


@pytest.mark.parametrize("coordinates", [da.AbsoluteCoordinates(), da.JointCoordinates()])
def test_small_motions_are_judged_by_their_own_unit(coordinates):
    """A rotor turns by 10,000 rad while a mass vibrates by a millimetre."""
    system = da.System("rotor and mass")
    rotor = system.add(planar.Body("rotor", mass=1.0, inertia=1.0, angular_velocity=1e3))
    mass = system.add(planar.Particle("mass", mass=1.0, velocity=(0.1, 0)))
    system.add(planar.Revolute("bearing", system.ground.center, rotor.center))
    system.add(planar.Force("spring", mass.center, (-1e4 * mass.x, 0)))
    motion = da.solve_dynamics(system.build(), 10.0, step=0.002, coordinates=coordinates)
    error = np.abs(motion.values("mass.vx") - 0.1 * np.cos(100 * motion.time)).max() / 0.1
    assert error > 0.01 and error / 3 < motion.error_estimate.share < 3 * error
    assert "mass.x" in motion.error_estimate.name and len(motion.warnings) == 1
