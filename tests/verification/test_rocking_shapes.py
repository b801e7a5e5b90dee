"""A block that rocks on its corners (Housner 1963, Bull. Seismol. Soc. Am. 53), as a shape.

The block is a rectangle on a half-plane, on another rectangle, or a box on a half-space; contacts
are those of time stepping, so that instants are those of steps. Quarter period of a slender block
from a tilt θ0: ``acosh(1/(1 − θ0/α))/p``, ``p² = 3g/4R``; the rate falls by ``1 − 1.5 sin²α`` as
the block changes corners.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial

G, HEIGHT = 9.81, 1.0
SETTLED = 0.05
"""Time after which the impact of all steps near the change of corners is over [s]."""
SUPPORTS = {
    "half-plane": lambda g: planar.contact.HalfPlane(g),
    "rectangle": lambda g: planar.contact.Rectangle(g.point(0.1, -0.5), (4.0, 1.0)),
}


def start(alpha: float, share: float) -> tuple[float, float, np.ndarray]:
    """Width, angle and mass centre of a block tilted about its left corner at the origin."""
    width, angle = HEIGHT * np.tan(alpha), share * alpha
    c, s = np.cos(angle), np.sin(angle)
    return width, angle, np.array([-c * width / 2 + s * HEIGHT / 2, s * width / 2 + c * HEIGHT / 2])


def rocking(alpha: float, share: float, support: str) -> tuple[da.Model, float]:
    """The model, and the quarter period for small angles."""
    width, angle, place = start(alpha, share)
    inertia, radius = (width**2 + HEIGHT**2) / 12, np.hypot(width, HEIGHT) / 2
    quarter = np.arccosh(1 / (1 - share)) / np.sqrt(3 * G / 4 / radius)
    if support == "half-space":
        system = da.System("block", gravity=(0, 0, -G))
        size = (width, 2.0, HEIGHT)
        turned = da.rotation.axis_angle((0, 1, 0), angle)
        at = (place[0], 0.0, place[1])
        block = spatial.Body(
            "block", mass=1.0, inertia=(1.0, inertia, 1.0), position=at, rotation=turned
        )
        shape = spatial.contact.Box(system.add(block).center, size)
        floor = spatial.contact.HalfSpace(system.ground.frame())
        system.add(spatial.Collisions("floor", [shape, floor], friction=1.0))
        return system.build(), quarter
    system = da.System("block", gravity=(0, -G))
    block = planar.Body("block", mass=1.0, inertia=inertia, position=tuple(place), angle=-angle)
    shape = planar.contact.Rectangle(system.add(block), (width, HEIGHT))
    system.add(planar.Collisions("floor", [shape, SUPPORTS[support](system.ground)], friction=1.0))
    return system.build(), quarter


def rate(motion: da.Motion, support: str) -> np.ndarray:
    """Angular velocity in the plane of the motion."""
    if support == "half-space":
        return motion["block.angular_velocity"].values[:, 1]
    return -motion.values("block.angular_velocity")


def rates_upright(motion: da.Motion, support: str, alpha: float) -> np.ndarray:
    """Angular velocities with which the block, about a corner, passes its upright position with the
    same energy."""
    inertia = (1 + np.tan(alpha) ** 2) * HEIGHT**2 / 3
    lifted = motion.data["potential_energy"].values - G * HEIGHT / 2
    return -np.sqrt(np.maximum(rate(motion, support) ** 2 + 2 * lifted / inertia, 0.0))


@pytest.mark.few(1)
@pytest.mark.parametrize("support", [*SUPPORTS, "half-space"])
def test_quarter_period_and_rate_after_impact(support):
    """Both to the order of the step."""
    alpha, share, step = 0.1, 0.5, 2.5e-4
    model, quarter = rocking(alpha, share, support)
    motion = da.solve_nonsmooth(model, 1.5 * quarter, step=step)
    assert motion.status.success
    omega = rate(motion, support)
    fastest = int(np.argmin(omega))
    assert motion.time[fastest] == pytest.approx(quarter, abs=3 * step + 2e-3 * quarter)
    upright = rates_upright(motion, support, alpha)
    after = upright[fastest + round(SETTLED / step)] / upright[fastest - 2]
    assert after == pytest.approx(1 - 1.5 * np.sin(alpha) ** 2, abs=6e-3)
    energy = motion.data["energy"].values
    assert np.diff(energy).max() <= 1e-9 * energy[0]


def test_rate_converges_with_the_step():
    alpha, errors = 0.3, []
    for step in (2e-3, 5e-4):
        model, quarter = rocking(alpha, 0.6, "half-plane")
        motion = da.solve_nonsmooth(model, 1.2 * quarter, step=step)
        fastest = int(np.argmin(rate(motion, "half-plane")))
        upright = rates_upright(motion, "half-plane", alpha)
        ratio = upright[fastest + round(SETTLED / step)] / upright[fastest - 2]
        errors.append(abs(ratio - (1 - 1.5 * np.sin(alpha) ** 2)))
    assert errors[1] < 0.5 * errors[0] < 0.02
