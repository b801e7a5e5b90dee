"""A driven involute pinion moves a loaded rack by its teeth, two outlines with clearance.

The rack moves with ``r ω`` on the pitch circle, late by half the clearance, but for the chords of
the flanks; the power of the motor is that of the load and of friction in the contacts.
"""

import math

import numpy as np
import pytest
from involute_gears import gear_corners
from thorough import sampled

import dalembert as da
from dalembert import planar

TEETH, MODULE, PRESSURE, CLEARANCE = 18, 4e-3, math.radians(20), 2e-4
RADIUS, SPEED, LOAD = MODULE * TEETH / 2, 8.0, 20.0


def rack(teeth: int) -> list[tuple[float, float]]:
    """Its pitch line is the x axis; the teeth point upwards."""
    pitch, low, lean = math.pi * MODULE, -1.25 * MODULE, math.tan(PRESSURE)
    half, corners = pitch / 4 - CLEARANCE / 4, []
    for k in range(teeth):
        middle = (k - (teeth - 1) / 2) * pitch
        for side in (-1, 1):
            foot, tip = half - low * lean, half - MODULE * lean
            pair = [(middle + side * foot, low), (middle + side * tip, MODULE)]
            corners += pair[::-side]
    left, right = corners[0][0] - half, corners[-1][0] + half
    below = low - 2 * MODULE
    return [(left, below), (right, below), (right, low), *corners[::-1], (left, low)]


@pytest.mark.thorough
@pytest.mark.parametrize("integrator", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_rack_and_pinion(integrator):
    system, angle = da.System("rack and pinion"), math.pi / TEETH - math.pi / 2
    turning = {"position": (0, 0), "angle": angle, "angular_velocity": SPEED}
    wheel = system.add(planar.Body("pinion", mass=0.5, inertia=3e-4, **turning))
    system.add(planar.Revolute("axle", system.ground.center, wheel.center))
    law = angle + SPEED * da.t
    system.add(planar.RotationalDriver("motor", system.ground, wheel, law))
    moving = {"position": (0, -RADIUS), "velocity": (SPEED * RADIUS, 0)}
    bar = system.add(planar.Body("rack", mass=1.0, inertia=1e-2, **moving))
    rail = system.ground.point(0, -RADIUS)
    system.add(planar.Prismatic("guide", rail, bar.center, axis=(1, 0)))
    system.add(planar.Force("load", bar, (-LOAD, 0)))
    pinion = gear_corners(TEETH, 5, MODULE, PRESSURE, CLEARANCE)
    outlines = [planar.contact.Outline(wheel, pinion), planar.contact.Outline(bar, rack(7))]
    system.add(planar.Collisions("teeth", outlines, friction=0.1))
    motion = da.solve_nonsmooth(system.build(), 0.08, step=5e-4, integrator=integrator)
    assert motion.status.success
    late = RADIUS * SPEED * motion.time - motion["rack.x"].values
    pressed = motion.time > 0.01
    assert late[pressed] == pytest.approx(CLEARANCE / 2, abs=4e-5)
    done = motion.statistics["energy dissipated in contacts [J]"]
    done += LOAD * motion["rack.x"].values[-1] + 0.5 * motion["rack.vx"].values[-1] ** 2
    done -= 0.5 * (SPEED * RADIUS) ** 2
    moments = motion["motor.moment"].values[1:] * np.diff(motion.record.t)
    assert SPEED * moments.sum() == pytest.approx(done, rel=1e-3)
    assert motion.statistics["energy dissipated in contacts [J]"] < 0.1 * done


@pytest.mark.parametrize("step", sampled([1e-3, 5e-4, 2e-4], 3))
@pytest.mark.parametrize("integrator", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_a_torque_accelerates_a_rack_from_rest(integrator, step: float):
    """``a = (T/r − F)/(m + J/r²)`` without friction, but for 1 % of the energy in impacts of the
    chords of the flanks. In the first step forces move the pinion by more than the clearance, and
    the backs of the teeth must not jam it. A tooth that enters the mesh moves past the tip of
    another one within micrometres, and must not stop at it."""
    system, torque, inertia = da.System("rack and pinion"), 3.0, 3e-4
    angle = math.pi / TEETH - math.pi / 2
    start = {"position": (0, 0), "angle": angle}
    wheel = system.add(planar.Body("pinion", mass=0.5, inertia=inertia, **start))
    system.add(planar.Revolute("axle", system.ground.center, wheel.center))
    system.add(planar.Torque("motor", wheel, torque))
    bar = planar.Body("rack", mass=1.0, inertia=1e-2, position=(0, -RADIUS))
    rail = system.ground.point(0, -RADIUS)
    system.add(planar.Prismatic("guide", rail, system.add(bar).center, axis=(1, 0)))
    system.add(planar.Force("load", bar, (-LOAD, 0)))
    pinion = gear_corners(TEETH, 3, MODULE, PRESSURE, CLEARANCE)
    outlines = [planar.contact.Outline(wheel, pinion), planar.contact.Outline(bar, rack(7))]
    system.add(planar.Collisions("teeth", outlines))
    motion = da.solve_nonsmooth(system.build(), 0.03, step=step, integrator=integrator)
    acceleration = (torque / RADIUS - LOAD) / (1.0 + inertia / RADIUS**2)
    assert motion.status.success
    assert motion["rack.x"].values[-1] == pytest.approx(acceleration * 0.03**2 / 2, rel=0.05)
