"""A ball that breaks a rack of fifteen, beside an event-driven integration of frictionless discs.

Gaps of 1 mm separate the balls of the rack, so that all impacts are those of two balls, which the
reference locates one after the other. A step joins impacts that follow each other within it;
``separate_impacts`` divides such steps.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

RADIUS, GAP, RESTITUTION, DURATION = 0.03, 1e-3, 0.95, 0.16


def rack() -> np.ndarray:
    """(16, 2) positions; the first ball comes from the left, beside the axis of symmetry."""
    pitch = 2 * RADIUS + GAP
    places = [(-0.3, 0.004)]
    for row in range(5):
        for k in range(row + 1):
            places.append((row * pitch * np.sqrt(3) / 2, (k - row / 2) * pitch))
    return np.array(places)


def event_driven(x: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray, int]:
    """Positions and velocities at the end, and the number of impacts."""
    x, v, t, count = x.copy(), v.copy(), 0.0, 0
    while True:
        apart, speed = x[:, None] - x[None], v[:, None] - v[None]
        b, a = (apart * speed).sum(-1), (speed * speed).sum(-1)
        root = b**2 - a * ((apart * apart).sum(-1) - 4 * RADIUS**2)
        times = np.full(a.shape, np.inf)
        meets = np.triu((b < 0) & (root > 0), 1)
        times[meets] = (-b[meets] - np.sqrt(root[meets])) / a[meets]
        i, j = np.unravel_index(int(times.argmin()), times.shape)
        if t + times[i, j] > DURATION:
            return x + v * (DURATION - t), v, count
        x, t, count = x + v * times[i, j], t + times[i, j], count + 1
        normal = (x[i] - x[j]) / (2 * RADIUS)
        push = (1 + RESTITUTION) / 2 * ((v[i] - v[j]) @ normal) * normal
        v[i], v[j] = v[i] - push, v[j] + push


@pytest.mark.parametrize(
    ("scheme", "step", "place", "speed"),
    [
        (da.AnticipatedImpacts(), 1e-3, 1e-4, 1e-3),
        pytest.param(da.MoreauJean(), 1e-4, 2e-4, 2e-3, marks=pytest.mark.thorough),
    ],
)
def test_break_of_a_rack(scheme, step, place, speed):
    system, shapes, start = da.System("rack"), [], rack()
    velocities = np.zeros_like(start)
    velocities[0] = 3.0, 0.0
    for k in range(16):
        own = {"position": tuple(start[k]), "velocity": tuple(velocities[k])}
        body = planar.Body(f"b{k}", mass=0.2, inertia=0.1 * RADIUS**2, **own)
        shapes.append(planar.contact.Circle(system.add(body), RADIUS))
    system.add(planar.Collisions("hits", shapes, restitution=RESTITUTION))
    options = {"step": step, "integrator": scheme, "separate_impacts": True}
    motion = da.solve_nonsmooth(system.build(), DURATION, **options)
    assert motion.status.success
    x, v, impacts = event_driven(start, velocities)
    assert impacts == 22
    ends = [
        [motion[f"b{k}.{name}"][-1].item() for name in ("x", "y", "vx", "vy")] for k in range(16)
    ]
    np.testing.assert_allclose(np.array(ends)[:, :2], x, atol=place)
    np.testing.assert_allclose(np.array(ends)[:, 2:], v, atol=speed)
