"""A soft pendulum of rubber, released level: tip of a geometrically exact beam.

The data are those of the example pendulumGeomExactBeam2D of Exudyn (Gerstmayr); the tip was
computed by spectral elements with Gauss steps of fourth order, independently of this code.
"""

from __future__ import annotations

import numpy as np

import dalembert as da
from dalembert import planar

LENGTH, HEIGHT, WIDTH, MODULUS, DENSITY, POISSON = 0.5, 0.002, 0.01, 1e8, 1000.0, 0.3
TIP = {
    0.1: (0.492594, -0.045941),
    0.2: (0.427042, -0.220478),
    0.3: (0.132195, -0.479664),
    0.5: (-0.420643, -0.262057),
    1.0: (-0.028524, -0.466594),
}


def test_tip():
    shear = 10 * (1 + POISSON) / (12 + 11 * POISSON) * MODULUS / (2 * (1 + POISSON))
    area, second = WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12
    system = da.System("pendulum", gravity=(0, -9.81))
    arm = system.add(
        planar.Beam(
            "arm",
            length=LENGTH,
            axial_rigidity=MODULUS * area,
            shear_rigidity=shear * area,
            bending_rigidity=MODULUS * second,
            mass_per_length=DENSITY * area,
            elements=8,
            position=(0, 0),
            angle=0.0,
        )
    )
    system.add(planar.Revolute("O", system.ground.center, arm.start))
    motion = da.solve_dynamics(
        system.build(), 1.0, step=5e-4, integrator=da.HHT(), outputs=list(TIP)
    )
    computed = np.c_[motion["arm.end.x"].values, motion["arm.end.y"].values]
    np.testing.assert_allclose(computed, list(TIP.values()), atol=1e-4)
    energy = motion["kinetic_energy"].values + motion["potential_energy"].values
    assert np.ptp(energy) < 1e-3 * motion["kinetic_energy"].values.max()
