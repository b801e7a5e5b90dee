"""Reactions of structures at rest, by hand.

A joint's reaction is the force and moment it exerts on its second body, at the joint, in
inertial axes. Source: statics of the rigid body.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar


def at_rest(system: da.System):
    motion = da.solve_dynamics(system.build(), 0.01, step=0.005)
    assert motion.status.success
    np.testing.assert_allclose(motion.data.speeds, 0.0, atol=1e-12)
    return motion.data.isel(time=-1)


def test_bracket():
    """A welded bracket of 2 m with its weight and a tip force carries both, and their moment."""
    system = da.System("bracket", gravity=(0.0, -10.0))
    beam = system.add(planar.Bar("beam", length=2.0, mass=3.0, angle=0.0, position=(1.0, 0.0)))
    system.add(planar.Weld("wall", system.ground.point(0, 0), beam.start))
    system.add(planar.Force("tip", beam.end, (40.0, -5.0)))
    data = at_rest(system).sel(joint="wall")
    np.testing.assert_allclose(data.reaction_force, [-40.0, 30.0 + 5.0], atol=1e-12)
    assert float(data.reaction_moment) == pytest.approx(30.0 * 1.0 + 5.0 * 2.0)


def test_simply_supported_beam():
    """A beam of 4 m with 100 N at 1 m: 75 N at the near pin, 25 N at the far roller."""
    system = da.System("beam")
    beam = system.add(planar.Body("beam", mass=1.0, inertia=1.0, position=(2.0, 0.0), angle=0.0))
    system.add(planar.Revolute("pin", system.ground.point(0, 0), beam.point(-2.0, 0.0)))
    system.add(planar.PinInSlot("roller", system.ground.point(4, 0), beam.point(2.0, 0.0)))
    system.add(planar.Force("load", beam.point(-1.0, 0.0), (12.0, -100.0)))
    data = at_rest(system)
    np.testing.assert_allclose(data.reaction_force.sel(joint="pin"), [-12.0, 75.0], atol=1e-12)
    np.testing.assert_allclose(data.reaction_force.sel(joint="roller"), [0.0, 25.0], atol=1e-12)
    np.testing.assert_allclose(data.reaction_moment, 0.0, atol=1e-12)


def test_reaction_turns_its_sign_with_the_order_of_the_bodies():
    """With the ground as second body, the joint reports what the ground feels."""
    system = da.System("bracket", gravity=(0.0, -10.0))
    beam = system.add(planar.Bar("beam", length=2.0, mass=3.0, angle=0.0, position=(1.0, 0.0)))
    system.add(planar.Weld("wall", beam.start, system.ground.point(0, 0)))
    data = at_rest(system).sel(joint="wall")
    np.testing.assert_allclose(data.reaction_force, [0.0, -30.0], atol=1e-12)
    assert float(data.reaction_moment) == pytest.approx(-30.0)


def test_crank_held_by_its_motor():
    """A crank of 0.5 m at 30° with 8 N down at its end: the motor holds 8 · 0.5 · cos 30°."""
    system = da.System("crank")
    crank = system.add(planar.Bar("crank", length=0.5, mass=1.0, angle=np.pi / 6))
    system.add(planar.Revolute("bearing", system.ground.point(0, 0), crank.start))
    system.add(planar.RotationalDriver("motor", system.ground, crank, np.pi / 6))
    system.add(planar.Force("load", crank.end, (0.0, -8.0)))
    data = at_rest(system)
    assert float(data.effort[0]) == pytest.approx(8 * 0.5 * np.cos(np.pi / 6))
    assert float(data.reaction_moment.sel(joint="motor")) == pytest.approx(
        8 * 0.5 * np.cos(np.pi / 6)
    )
    np.testing.assert_allclose(data.reaction_force.sel(joint="bearing"), [0.0, 8.0], atol=1e-12)
    assert float(data.reaction_moment.sel(joint="bearing")) == pytest.approx(0.0, abs=1e-12)


def test_gear_tooth_force_loads_the_bearings():
    """A torque on one gear, the other held: tooth force M/r, carried by both bearings."""
    system = da.System("gears")
    small = system.add(planar.Body("small", mass=1.0, inertia=1.0, position=(0, 0), angle=0.0))
    large = system.add(planar.Body("large", mass=1.0, inertia=1.0, position=(0.6, 0), angle=0.0))
    system.add(planar.Revolute("a", system.ground.point(0, 0), small.center))
    system.add(planar.Revolute("b", system.ground.point(0.6, 0), large.center))
    system.add(planar.GearPair("mesh", small.center, large.center, radius_i=0.2, radius_j=0.4))
    system.add(planar.RotationalDriver("brake", system.ground, large, 0.0))
    system.add(planar.Torque("torque", small, 3.0))
    data = at_rest(system)
    # the small gear, turned anticlockwise, pushes the large one up at the pitch point
    np.testing.assert_allclose(data.reaction_force.sel(joint="mesh"), [0.0, 15.0], atol=1e-12)
    np.testing.assert_allclose(data.reaction_force.sel(joint="b"), [0.0, -15.0], atol=1e-12)
    np.testing.assert_allclose(data.reaction_force.sel(joint="a"), [0.0, 15.0], atol=1e-12)
    assert float(data.effort[0]) == pytest.approx(6.0)
