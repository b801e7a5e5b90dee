"""Drift mode of a dimer on a vibrating plate (Dorbolo et al. 2005, Phys. Rev. Lett. 95, 044101).

Two spheres, joined by a rigid rod, bounce on a plate that vibrates vertically. In the drift mode
one end stays on the plate during most of the cycle, the other one bounces with the period of the
plate, and the dimer moves horizontally. Located impacts and steps agree on the height and drift.
The equations are those in the frame of the plate; aspect ratio 5.7, 25 Hz, maximum acceleration of
the plate 0.8 g, restitution 0.7 and friction 0.3 are chosen.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

G, FREQUENCY, DIAMETER, ASPECT = 9.81, 25.0, 0.00645, 5.7
REACH, RADIUS = (ASPECT - 1) * DIAMETER / 2, DIAMETER / 2
LAW = {"restitution": 0.7, "friction": 0.3}
START = {"position": (0.0, 0.0037526), "angle": 0.034812, "velocity": (0.023264, -0.093854)}
SPIN, PERIODS, STEPS = -6.1957, 3, 400
"""Angular velocity at the start, in the mode [rad/s]; length of the run, steps of a period."""


def dimer() -> tuple[da.System, planar.Body]:
    """Mass 1 kg, of which the rod has none."""
    system = da.System("dimer", gravity=(0, -G))
    inertia = REACH**2 + 2 / 5 * RADIUS**2
    start = START | {"angular_velocity": SPIN}
    body = system.add(planar.Body("dimer", mass=1.0, inertia=inertia, **start))
    shaken = 0.8 * G * da.sin(2 * math.pi * FREQUENCY * da.t)
    system.add(planar.Force("plate", body.center, (0.0, shaken)))
    return system, body


def located() -> da.Motion:
    system, body = dimer()
    for name, side in (("A", -1), ("B", 1)):
        end = body.point(side * REACH, 0.0)
        slip = end.velocity[0] + body.angular_velocity * RADIUS
        system.add(planar.UnilateralConstraint(name, end.y - RADIUS, slip, **LAW))
    accurate = da.DormandPrince(1e-9, 1e-12)
    outputs = PERIODS * STEPS + 1
    return da.solve_dynamics(
        system.build(), PERIODS / FREQUENCY, integrator=accurate, outputs=outputs
    )


def stepped() -> da.Motion:
    system, body = dimer()
    ends = [planar.contact.Circle(body.point(side * REACH, 0.0), RADIUS) for side in (-1, 1)]
    plate = planar.contact.HalfPlane(system.ground)
    system.add(planar.Collisions("plate_contacts", [*ends, plate], **LAW))
    step = 1 / (FREQUENCY * STEPS)
    return da.solve_nonsmooth(system.build(), PERIODS / FREQUENCY, step=step)


def gaps(motion: da.Motion) -> np.ndarray:
    """(2, outputs) heights of the two ends above the plate."""
    lift = REACH * np.sin(motion.values("dimer.angle"))
    return motion.values("dimer.y") - RADIUS + np.array([-lift, lift])


def test_drift_mode() -> None:
    drifts, heights = [], []
    for motion in (located(), stepped()):
        assert motion.status.success
        stays, bounces = gaps(motion)
        assert (stays < 2e-6).mean() > 0.65
        periods = bounces[1:].reshape(PERIODS, STEPS)
        assert periods.max(axis=1) == pytest.approx(periods.max(), rel=0.01)  # once in a period
        landings = np.diff((bounces < 5e-5).astype(int)) == 1
        assert landings.sum() == PERIODS
        heights.append(periods.max())
        drifts.append(np.ptp(motion.values("dimer.x")[[0, -1]]) / PERIODS)
    assert heights[1] == pytest.approx(heights[0], rel=0.01)
    assert drifts[0] > 1e-5
    assert drifts[1] == pytest.approx(drifts[0], rel=0.05)
