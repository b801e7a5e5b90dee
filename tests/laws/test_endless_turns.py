"""What turns in space may turn for ever: drivers, gears and screws count full turns."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import spatial, t

TURNS = 5.3 * 2 * np.pi
AXES = {"axis": (0.3, 0.2, 1.0)}


def body(system: da.System, name: str, **more) -> spatial.Body:
    arguments = {"rotation": da.rotation.identity(), "mass": 1.0, "inertia": (0.1, 0.2, 0.15)}
    return system.add(spatial.Body(name, **arguments, **more))


@pytest.mark.parametrize("solve", [da.solve_kinematics, da.solve_inverse_dynamics])
def test_a_driven_gear_goes_on_after_full_turns(solve):
    """Turns in the ratio of the radii, though poses tell them but for full ones."""
    system, ri, rj = da.System("gears"), 0.2, 0.1 * np.sqrt(2)
    a, b = body(system, "a"), body(system, "b")
    place, across = system.ground.frame((0.5, 0, 0), axis=(1, 0, 0)), b.frame(axis=(1, 0, 0))
    first = system.add(spatial.Revolute("A", system.ground.frame(**AXES), a.frame(**AXES)))
    system.add(spatial.Revolute("B", place, across))
    teeth = spatial.GearPair("G", first, system.elements["B"], radius_i=ri, radius_j=rj)
    system.add(teeth)
    system.add(spatial.RotationalDriver("D", first, TURNS * t**2))
    motion = solve(system.build(), 1.0, step=0.005)
    assert motion.status.success, motion.status
    expected = TURNS * motion.time**2
    np.testing.assert_allclose(motion["D.coordinate"], expected, atol=1e-9)
    np.testing.assert_allclose(motion["G.shared"], ri * expected, atol=1e-9)
    turned = np.unwrap(motion["B.angle"])
    np.testing.assert_allclose(turned, -ri / rj * expected, atol=1e-9)


def test_a_screw_goes_on_after_full_turns():
    """Displacement = pitch · turns, driven along its axis."""
    system, pitch = da.System("spindle"), 0.03
    nut = body(system, "nut")
    screw = spatial.Screw("S", system.ground.frame(**AXES), nut.frame(**AXES), pitch=pitch)
    system.add(screw)
    system.add(spatial.TranslationalDriver("D", screw, 0.2 * t))
    motion = da.solve_kinematics(system.build(), 1.0, step=0.01)
    assert motion.status.success, motion.status
    turned = np.unwrap(motion["S.angle"])
    np.testing.assert_allclose(turned, 2 * np.pi * 0.2 * motion.time / pitch, atol=1e-9)
