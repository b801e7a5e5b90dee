"""A free beam thrown and turned, the flying spaghetti in the plane (Simo and Vu-Quoc 1986).

Displacements of both ends by spectral elements with Gauss steps of fourth order, independently of
this code and confirmed by 80 linear elements of Exudyn.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

ENDS = {  # lower x, y, upper x, y
    2.5: (-1.0370, 4.4760, 3.5832, -1.8881),
    5.0: (3.7834, 8.2042, 8.0742, -6.2414),
    7.5: (10.2680, -0.2834, 17.2394, 0.2533),
    10.0: (16.9712, 6.4122, 21.3246, -4.3904),
}


@pytest.fixture(scope="module")
def motion() -> da.Motion:
    system = da.System("spaghetti")
    pulled = da.where(da.t < 2.5, 1.0, 0.0)
    rod = system.add(
        planar.Beam(
            "rod",
            length=10.0,
            axial_rigidity=1e4,
            shear_rigidity=1e4,
            bending_rigidity=100.0,
            mass_per_length=1.0,
            rotary_inertia=10.0,
            elements=8,
            position=(6, -8),
            angle=math.atan2(8, -6),
        )
    )
    system.add(planar.Force("F", rod.start.center, (8 * pulled, 0)))
    system.add(planar.Torque("M", rod.start, -80 * pulled))
    return da.solve_dynamics(system.build(), 10.0, step=1e-3, outputs=list(ENDS))


def test_ends(motion):
    computed = np.c_[
        motion["rod.start.x"].values - 6,
        motion["rod.start.y"].values + 8,
        motion["rod.end.x"].values,
        motion["rod.end.y"].values,
    ]
    expected = np.array(list(ENDS.values()))
    np.testing.assert_allclose(computed[0], expected[0], atol=5e-3)
    np.testing.assert_allclose(computed, expected, atol=2e-2)


def test_nothing_is_lost_in_flight(motion):
    total = motion["kinetic_energy"].values + motion["potential_energy"].values
    assert np.ptp(total) < 1e-5 * total[0]  # over 7.5 s, by Runge and Kutta's fourth order
