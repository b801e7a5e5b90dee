"""Contacts with MoreauJean that are open in single steps: a warning states the change of speeds."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from involute_gears import gear_corners

import dalembert as da
from dalembert import planar

TEETH, MODULE, PRESSURE, CLEARANCE, SPEED = (20, 30), 4e-3, math.radians(20), 2e-4, 10.0


def pair(inertia: float) -> da.Model:
    """A pinion with a constant speed and a gear with a load."""
    system, apart = da.System("gears"), MODULE * sum(TEETH) / 2
    ratio = TEETH[0] / TEETH[1]
    data = [
        {"position": (0, 0), "angle": 0.0, "angular_velocity": SPEED, "inertia": 3e-4},
        {"position": (apart, 0), "angle": math.pi + math.pi / TEETH[1], "inertia": inertia},
    ]
    data[1]["angular_velocity"] = -SPEED * ratio
    names = "pinion", "gear"
    wheels = [system.add(planar.Body(n, mass=1.0, **d)) for n, d in zip(names, data, strict=True)]
    for body, x in zip(wheels, (0.0, apart), strict=True):
        system.add(planar.Revolute(f"axle_{body.name}", system.ground.point(x, 0), body.center))
    system.add(planar.RotationalDriver("motor", system.ground, wheels[0], SPEED * da.t))
    system.add(planar.Torque("load", wheels[1], 5.0))
    outlines = [
        planar.contact.Outline(body, gear_corners(teeth, 6, MODULE, PRESSURE, CLEARANCE))
        for body, teeth in zip(wheels, TEETH, strict=True)
    ]
    system.add(planar.Collisions("teeth", outlines))
    return system.build()


def interruptions(motion: da.Motion) -> list[str]:
    assert motion.status.success
    return [text for text in motion.warnings if "do not touch in" in text]


def test_speeds_of_gears_that_fall_by_the_load_of_a_step():
    """Teeth press with ``T/r`` all the time, but in single steps of the run."""
    options = {"duration": 0.02, "step": 5e-4}
    motion = da.solve_nonsmooth(pair(2e-3), **options, integrator=da.MoreauJean())
    (text,) = interruptions(motion)
    stated = float(re.search(r"up to ([\d.]+) %", text).group(1))
    speeds = -motion["gear.angular_velocity"].values[10:]
    drop = 100 * 5.0 / 2e-3 * options["step"] / np.abs(speeds).max()  # h T/J
    assert stated == pytest.approx(drop, rel=0.1)
    assert 100 * np.ptp(speeds) / speeds.max() > 0.8 * drop
    assert not interruptions(da.solve_nonsmooth(pair(2e-3), **options))


def test_no_warning_about_heavy_gears_and_bounces():
    options = {"duration": 0.015, "step": 5e-4, "integrator": da.MoreauJean()}
    assert not interruptions(da.solve_nonsmooth(pair(0.1), **options))
    system = da.System("ball", gravity=(0.0, -9.81))
    ball = system.add(planar.Body("ball", mass=1.0, inertia=0.004, position=(0.0, 0.3)))
    shapes = [planar.contact.Circle(ball, 0.1), planar.contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes, restitution=0.5))
    bounced = da.solve_nonsmooth(system.build(), 1.0, step=1e-3, integrator=da.MoreauJean())
    assert not interruptions(bounced)
