"""Law: steps of AnticipatedImpacts are continuous where resting contacts begin to separate."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

RADIUS, STEP = 0.05, 1e-3
SCENES = range(8)


def row_of_discs(seed: int) -> da.Model:
    """A disc on a wall, one that falls on it, and a faster one that strikes the latter."""
    rng = np.random.default_rng(seed)
    slow = rng.uniform(0.5, 2)
    fast, gap = slow + rng.uniform(0.1, 1), rng.uniform(0, 3e-3)
    places = RADIUS + np.array([0.0, 2 * RADIUS + gap, 4 * RADIUS + gap + rng.uniform(0, 2e-3)])
    system = da.System("row of discs", gravity=(-9.81, 0))
    share = system.parameter("share", 1.0)
    shapes = []
    for name, place, speed in zip("abc", places, (0.0, slow, fast), strict=True):
        mass = rng.uniform(0.5, 2)
        motion = {"position": (place, 0), "angle": 0.0, "velocity": (-speed * share, 0)}
        body = system.add(planar.Body(name, mass=mass, inertia=1e-3, **motion))
        shapes.append(planar.contact.Circle(body, RADIUS))
    shapes.append(planar.contact.HalfPlane(system.ground.center, (1, 0)))
    system.add(planar.Collisions("contacts", shapes, restitution=0.0))
    return system.build()


@pytest.mark.few(4)
@pytest.mark.parametrize("seed", SCENES)
def test_rounding_does_not_change_the_motion_after_an_impact(seed: int) -> None:
    """Discs that stop with a gap between them are pressed in the next step: their relative speed
    is zero but for rounding, whose sign has no effect."""
    model = row_of_discs(seed)
    speeds = [
        da.solve_nonsmooth(model, 0.012, step=STEP, parameters={"share": share}).record.ends.v
        for share in 1 + 1e-15 * np.array([0, -4, -2, -1, 1, 2, 4])
    ]
    assert np.abs(np.array(speeds) - speeds[0]).max() <= 1e-9
