"""Error estimates of coordinates that clearances of gaps move alone."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

G, PERIOD, BETA = 9.81, 0.04, np.radians(25)


@pytest.mark.thorough
@pytest.mark.parametrize("step", [5e-4, 2.5e-4])
def test_a_part_on_a_vibrating_trough_does_not_turn(step):
    """The box slides without turning; its angle changes by clearances, which depend on the step."""
    system, omega = da.System("feeder", gravity=(0, -G)), 2 * np.pi / PERIOD
    trough = system.add(planar.Body("trough", mass=5.0, inertia=0.1, position=(0, 0)))
    amplitude = 0.8 * G / (omega**2 * np.sin(BETA))
    shake = amplitude * da.sin(omega * da.t)
    system.add(planar.UserConstraint("along", trough.x - np.cos(BETA) * shake))
    system.add(planar.UserConstraint("up", trough.y - np.sin(BETA) * shake))
    system.add(planar.UserConstraint("level", trough.angle))
    start = tuple(amplitude * omega * np.array([np.cos(BETA), np.sin(BETA)]))
    box = planar.Body("box", mass=0.1, inertia=1e-5, position=(0, 5e-3), velocity=start)
    shapes = [planar.contact.Rectangle(system.add(box), (0.03, 0.01))]
    shapes.append(planar.contact.HalfPlane(trough))
    system.add(planar.Collisions("surface", shapes, friction=0.3))
    motion = da.solve_nonsmooth(system.build(), 4 * PERIOD, step=step)
    assert not motion.warnings and motion.error_estimate.share < 0.05
    assert np.ptp(motion["box.angle"].values) < 1e-5
