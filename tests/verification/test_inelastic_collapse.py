"""Three balls on a line with restitution e: they separate, or stick after infinitely many impacts.

Inelastic collapse occurs for ``e < 7 − 4 √3`` (McNamara & Young 1992, Phys. Fluids A 4, 496): all
balls then have the velocity of their mass centre. Above, the number of impacts is finite, and the
final velocities are those of an exact sequence of impacts.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

CRITICAL, GAPS = 7 - 4 * math.sqrt(3), (0.1, 0.2)


def impacts(e: float) -> tuple[np.ndarray, int]:
    """Final velocities and number of impacts, 1000 at most."""
    gaps, v = np.array(GAPS), np.array([1.0, 0.0, 0.0])
    for count in range(1000):
        approach = v[:-1] - v[1:]
        if (approach <= 1e-15).all():
            return v, count
        times = np.where(approach > 1e-15, gaps / np.maximum(approach, 1e-15), np.inf)
        k = int(np.argmin(times))
        gaps = gaps - approach * times[k]
        mean = (v[k] + v[k + 1]) / 2
        v[k : k + 2] = mean + e * approach[k] / 2 * np.array([-1, 1])
    return v, 1000


def row(e: float) -> da.Model:
    system = da.System("row", gravity=(0, 0))
    places = np.cumsum([0.0, *(gap + 0.2 for gap in GAPS)])
    balls = [
        planar.Particle(f"ball{k}", mass=1.0, position=(x, 0), velocity=(k == 0, 0))
        for k, x in enumerate(places)
    ]
    shapes = [planar.contact.Circle(system.add(ball).center, 0.1) for ball in balls]
    system.add(planar.Collisions("hits", shapes, restitution=e))
    return system.build()


@pytest.mark.few(2)
@pytest.mark.parametrize(
    "scheme", [da.AnticipatedImpacts(), da.MoreauJean()], ids=lambda s: type(s).__name__
)
@pytest.mark.parametrize("e", [0.5 * CRITICAL, 2 * CRITICAL, 0.4])
def test_final_velocities(e: float, scheme: da.AnticipatedImpacts | da.MoreauJean) -> None:
    motion = da.solve_nonsmooth(row(e), 3.0, step=0.01, integrator=scheme)
    assert motion.status.success
    final = [motion.values(f"ball{k}.vx")[-1] for k in range(3)]
    exact, count = impacts(e)
    assert (count > 20) == (e < CRITICAL)  # the last ones are below round-off
    np.testing.assert_allclose(final, 1 / 3 if e < CRITICAL else exact, atol=1e-9)
