"""A block that rocks on its corners (Housner 1963, Bull. Seismol. Soc. Am. 53).

From a tilt θ0 of a slender block the quarter period is ``acosh(1/(1 − θ0/α))/p``,
``p² = 3g/4R``, for small angles; at the impact of a corner the rate falls by ``1 − 1.5 sin²α``.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

G, HEIGHT = 9.81, 1.0


def rocks(alpha: float, share: float):
    width = HEIGHT * np.tan(alpha)
    inertia = (width**2 + HEIGHT**2) / 12
    c, s = np.cos(share * alpha), np.sin(share * alpha)
    place = (-c * width / 2 + s * HEIGHT / 2, s * width / 2 + c * HEIGHT / 2)
    system = da.System("block", gravity=(0, -G))
    angle = -share * alpha
    block = system.add(planar.Body("block", mass=1.0, inertia=inertia, position=place, angle=angle))
    for name, x in (("left", -width / 2), ("right", width / 2)):
        corner = block.point(x, -HEIGHT / 2)
        system.add(
            planar.UnilateralConstraint(
                name, corner.y, corner.velocity[0], restitution=0.0, friction=1.0
            )
        )
    radius = np.hypot(width, HEIGHT) / 2
    quarter = np.arccosh(1 / (1 - share)) / np.sqrt(3 * G / 4 / radius)
    motion = da.solve_dynamics(system.build(), 4 * quarter, integrator=da.DormandPrince(rtol=1e-10))
    return motion, quarter


def test_quarter_period():
    """The formula is that of small angles: what is left falls with α²."""
    errors = []
    for alpha in (0.04, 0.02):
        motion, quarter = rocks(alpha, 0.5)
        assert [impact.name for impact in motion.impacts[:2]] == ["left", "right"]
        errors.append(motion.impacts[0].time / quarter - 1)
    assert abs(errors[1]) < 1e-4
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.02)


def test_rate_after_impact():
    alpha = 0.3
    motion, _ = rocks(alpha, 0.6)
    time = motion.impacts[0].time
    before, after = motion.at(time + np.array([-1e-9, 1e-9])).values("block.angular_velocity")
    assert after / before == pytest.approx(1 - 1.5 * np.sin(alpha) ** 2, rel=1e-7)
    assert np.abs(motion.data["balance_error"]).max() < 1e-8
    assert motion.values("left.normal_force").min() > -1e-9
