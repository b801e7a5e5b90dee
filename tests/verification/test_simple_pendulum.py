"""IFToMM A01, simple pendulum: 1 kg on a massless rod of 1 m, released from the horizontal.

Source: IFToMM library of computational benchmark problems, problem A01. Exact motion by elliptic
functions, ``θ = 2 asin(k sn(K − t √(g/L), k))``, ``k = sin 45°``, θ from the downward vertical.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

import dalembert as da
from dalembert import planar

G = 9.81
TIMES = np.array([1.0, 2.0, 5.0, 10.0])
PRINTED = np.array(
    [  # x, y at TIMES
        (-0.9862917511, -0.1650108531),
        (0.7935661953, -0.6084839304),
        (0.9423054350, -0.3347543384),
        (0.2750874626, -0.9614192051),
    ]
)


def exact(t):
    m = np.sin(np.pi / 4) ** 2
    sn = ellipj(ellipk(m) - t * np.sqrt(G), m)[0]
    angle = 2 * np.arcsin(np.sqrt(m) * sn)
    return np.stack([np.sin(angle), -np.cos(angle)], axis=1)


def particle_on_link() -> da.System:
    system = da.System("pendulum", gravity=(0.0, -G))
    bob = system.add(planar.Particle("bob", mass=1.0, position=(1.0, 0.0)))
    system.add(planar.RigidLink("rod", system.ground.point(0, 0), bob.center, length=1.0))
    return system


def body_on_pin() -> da.System:
    system = da.System("pendulum", gravity=(0.0, -G))
    bob = system.add(planar.Body("bob", mass=1.0, inertia=0.0, position=(1.0, 0.0), angle=0.0))
    system.add(planar.Revolute("pin", system.ground.point(0, 0), bob.point(-1.0, 0.0)))
    return system


def test_elliptic_functions_give_the_printed_numbers():
    np.testing.assert_allclose(exact(TIMES), PRINTED, atol=1e-9)


@pytest.mark.parametrize("make", [particle_on_link, body_on_pin])
def test_pendulum(make):
    motion = da.solve_dynamics(
        make().build(), 10.0, integrator=da.DormandPrince(1e-12, 1e-12), outputs=TIMES
    )
    computed = motion.data.position.sel(body="bob").values
    np.testing.assert_allclose(computed, exact(TIMES), atol=1e-9)
    np.testing.assert_allclose(motion.data.energy, 0.0, atol=1e-9)


def test_tension_in_the_rod():
    """At the lowest point the rod carries 3 m g."""
    quarter = float(ellipk(0.5)) / np.sqrt(G)
    motion = da.solve_dynamics(
        particle_on_link().build(),
        quarter,
        integrator=da.DormandPrince(1e-12, 1e-12),
        outputs=[quarter],
    )
    assert motion["rod.force_norm"].values[0] == pytest.approx(3 * G, abs=1e-8)
    assert float(motion.data.multiplier[0, 0]) == pytest.approx(3 * G, abs=1e-8)
