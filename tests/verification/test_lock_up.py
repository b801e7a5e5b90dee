"""Lock-up of a slider-crank whose rod is shorter than its crank.

Source: E. J. Haug, *Computer Aided Kinematics and Dynamics of Mechanical Systems*, 1989, ch. 5:
crank 2 m at π/4 + 2πt; a rod of 1.9 m locks when sin φ = 0.95, at about 0.074 s.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar


def mechanism(rod_length: float) -> da.System:
    system = da.System("slider-crank")
    crank = system.add(planar.Bar("crank", length=2.0, angle=np.pi / 4))
    rod = system.add(
        planar.Bar("rod", length=rod_length, angle=-np.arcsin(np.sqrt(2) / rod_length))
    )
    slider = system.add(planar.Body("slider", angle=0.0))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, slider.center))
    system.add(planar.Prismatic("C", system.ground.point(0, 0), slider.center))
    system.add(planar.RotationalDriver("motor", system.ground, crank, np.pi / 4 + 2 * np.pi * da.t))
    return system


def test_short_rod_locks():
    motion = da.solve_kinematics(mechanism(1.9).build(), 1.0, step=0.005)
    assert motion.status.outcome is da.Outcome.LOCKED
    expected = (np.arcsin(0.95) - np.pi / 4) / (2 * np.pi)
    assert motion.events[-1].time == pytest.approx(expected, abs=1e-6)
    message = motion.status.message
    assert "driver 'motor' at crank.angle = 1.2532 rad (71.81°)" in message  # arcsin 0.95
    assert message.endswith("joints at their limit: A, B, C")  # what the crank turns on is not


@pytest.mark.few(2)
@pytest.mark.parametrize("rod_length", [2.1, 2.2, 2.5, 3.5])
def test_longer_rods_run_through(rod_length):
    motion = da.solve_kinematics(mechanism(rod_length).build(), 1.0, step=0.005)
    assert motion.status.outcome is da.Outcome.COMPLETED
    angle = np.pi / 4 + 2 * np.pi * motion.time
    x = 2 * np.cos(angle) + np.sqrt(rod_length**2 - 4 * np.sin(angle) ** 2)
    np.testing.assert_allclose(motion["slider.x"].values, x, atol=1e-10)
