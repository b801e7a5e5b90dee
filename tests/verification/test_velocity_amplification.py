"""Superballs: a light ball on a heavy one flies higher than it fell (Harter 1971).

Elastic balls of masses ``M`` and ``m`` fall with speed ``v`` (Am. J. Phys. 39, 656). The heavy
one bounces first, and the light one leaves with ``(3 M − m)/(M + m) v``, at most ``3 v``. For
``M = 3 m`` it is ``2 v``, and the heavy ball stops.
"""

from __future__ import annotations

import pytest

import dalembert as da
from dalembert import planar

G, FALL, GAP, SIZE = 10.0, 0.8, 0.02, 0.1


def after(ratio: float) -> tuple[float, float, float]:
    """Time of the impact of the balls, and the velocities after it, with the gap between them."""
    speed = (2 * G * FALL) ** 0.5
    time = GAP / (2 * speed)
    up, down = speed - G * time, -speed - G * time
    mean = (ratio * up + down) / (ratio + 1)
    return speed / G + time, 2 * mean - up, 2 * mean - down


@pytest.mark.few(1)
@pytest.mark.parametrize("ratio", [3.0, 50.0])
@pytest.mark.parametrize(
    "scheme", [da.AnticipatedImpacts(), da.MoreauJean()], ids=lambda s: type(s).__name__
)
def test_speed_of_the_upper_ball(
    ratio: float, scheme: da.AnticipatedImpacts | da.MoreauJean
) -> None:
    system = da.System("balls", gravity=(0, -G))
    heights = {"heavy": (ratio, SIZE + FALL), "light": (1.0, 3 * SIZE + FALL + GAP)}
    shapes = [planar.contact.HalfPlane(system.ground)]
    for name, (mass, height) in heights.items():
        ball = system.add(planar.Particle(name, mass=mass, position=(0, height)))
        shapes.append(planar.contact.Circle(ball.center, SIZE))
    system.add(planar.Collisions("hits", shapes, restitution=1.0))
    end, step = 0.41, 1e-3
    motion = da.solve_nonsmooth(system.build(), end, step=step, integrator=scheme)
    time, heavy, light = after(ratio)
    near = 3 * G * step  # an impact occurs within a step
    fallen = G * (end - time)
    assert motion.values("light.vy")[-1] == pytest.approx(light - fallen, abs=near)
    assert motion.values("heavy.vy")[-1] == pytest.approx(heavy - fallen, abs=near)
    speed = G * (time - GAP / 8)
    assert light == pytest.approx((3 * ratio - 1) / (ratio + 1) * speed, rel=0.02)
