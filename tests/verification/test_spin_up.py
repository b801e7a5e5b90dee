"""A beam spun up about its root (Simo and Vu-Quoc 1986; Kane, Ryan and Banerjee 1987).

Tip in the axes of the hub: nine digits of these by spectral elements with Gauss steps of fourth
order, independently of this code. A beam that does not stiffen as it turns would diverge, for
6 rad/s is above its first bending frequency.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

TIP = {  # along, across, turn of the section
    2.5: (-0.001322677, -0.151283559, -0.020621126),
    5.0: (-0.012654636, -0.468476183, -0.063716733),
    7.5: (-0.017741864, -0.559083459, -0.074778631),
    10.0: (-0.007072336, -0.362814516, -0.047237005),
    15.0: (0.000513990, 0.001303626, 0.000167747),
    20.0: (0.000514532, 0.000726581, 0.000093406),
}


def test_tip_in_the_axes_of_the_hub():
    system = da.System("spin-up")
    hub = system.add(planar.Body("hub", mass=1.0, inertia=1.0, position=(0, 0), angle=0.0))
    system.add(planar.Revolute("O", system.ground.center, hub.center))
    swing = (15 / (2 * math.pi)) ** 2 * (da.cos(2 * math.pi / 15 * da.t) - 1)
    angle = da.where(da.t < 15, 0.4 * (da.t**2 / 2 + swing), 6 * da.t - 45)
    system.add(planar.RotationalDriver("motor", system.ground, hub, angle))
    system.add(
        planar.Beam(
            "arm",
            hub.center,
            length=10.0,
            axial_rigidity=2.8e7,
            shear_rigidity=1e7,
            bending_rigidity=1.4e4,
            mass_per_length=1.2,
            rotary_inertia=6e-4,
            elements=3,
        )
    )
    motion = da.solve_dynamics(
        system.build(), 20.0, step=2.5e-3, integrator=da.HHT(), outputs=list(TIP)
    )
    x, y, turn, turned = (
        motion[m].values for m in ("arm.end.x", "arm.end.y", "arm.end.angle", "hub.angle")
    )
    c, s = np.cos(turned), np.sin(turned)
    computed = np.c_[c * x + s * y - 10, c * y - s * x, turn - turned]
    np.testing.assert_allclose(computed, list(TIP.values()), atol=1e-4)
    extension = 36 * 1.2 * 10**3 / (3 * 2.8e7)  # ω² ρA L³/(3 EA), linear theory
    assert computed[-1, 0] == pytest.approx(extension, rel=1e-2)
