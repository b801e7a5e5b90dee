"""A body without torque: Jacobi's solution of three moments of inertia; the symmetric gyroscope.

Sources: L. D. Landau, E. M. Lifshitz, *Mechanics*, § 37 (elliptic functions) and § 33 (regular
precession); the latter as ``multibody/benchmarks/free_body`` of Drake. Tolerance 1e-9.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.special import ellipj

import dalembert as da
from dalembert import spatial

TIMES = np.linspace(0, 10, 41)


def free(inertia, spin, rotation=None, center=(0, 0, 0)) -> da.Motion:
    """``spin`` in body axes; the centre of mass at rest in the origin."""
    rotation = Rotation.identity() if rotation is None else rotation
    center = np.array(center, float)
    system = da.System("free body")
    system.add(
        spatial.Body(
            "body",
            mass=1.7,
            inertia=inertia,
            center_of_mass=tuple(center),
            position=tuple(-rotation.apply(center)),
            rotation=rotation,
            velocity=tuple(-rotation.apply(np.cross(spin, center))),
            angular_velocity=tuple(rotation.apply(spin)),
        )
    )
    motion = da.solve_dynamics(
        system.build(), 10.0, integrator=da.DormandPrince853(1e-12, 1e-12), outputs=TIMES
    )
    assert motion.status.success
    return motion


def jacobi(inertia, first, third, times) -> np.ndarray:
    """(K, 3) ω in body axes with ω2 = 0 at first, ``I1 > I2 > I3`` and ``L² > 2 T I2``."""
    i1, i2, i3 = inertia
    twice, square = i1 * first**2 + i3 * third**2, (i1 * first) ** 2 + (i3 * third) ** 2
    assert square > twice * i2
    rate = np.sqrt((i1 - i2) * (square - twice * i3) / (i1 * i2 * i3))
    modulus = (i2 - i3) * (twice * i1 - square) / ((i1 - i2) * (square - twice * i3))
    sn, cn, dn, _ = ellipj(rate * times, modulus)
    second = -np.sign(first * third) * np.sqrt((twice * i1 - square) / (i2 * (i1 - i2)))
    return np.column_stack([first * dn, second * sn, third * cn])


@pytest.mark.parametrize(
    ("first", "third"), [(2.0, 1.0), (1.2, 2.1), (-1.5, 2.0)], ids=["about", "tumbling", "back"]
)
def test_three_moments(first, third):
    inertia = (3.0, 2.0, 1.2)
    rotation = Rotation.from_rotvec([0.4, -0.7, 0.3])
    motion = free(inertia, (first, 0.0, third), rotation, center=(0.1, -0.2, 0.3))
    spin = motion["body.angular_velocity_local"].values
    np.testing.assert_allclose(spin, jacobi(inertia, first, third, TIMES), atol=1e-9)
    axes = motion["body.rotation"].values.reshape(-1, 3, 3)
    momentum = np.einsum("kij,j,kj->ki", axes, inertia, spin)
    np.testing.assert_allclose(momentum, np.tile(momentum[0], (TIMES.size, 1)), atol=1e-9)
    center = motion["body.position"] + np.einsum("kij,j->ki", axes, (0.1, -0.2, 0.3))
    np.testing.assert_allclose(center, 0.0, atol=1e-9)


def test_symmetric_gyroscope_precesses_about_its_angular_momentum():
    """``R(t) = exp(L t / I) R(0) exp((1 − J/I) ω3 t e3)``, attitude included."""
    across, along, spin = 0.3, 0.5, np.array([0.8, -0.4, 6.0])
    start = Rotation.from_rotvec([0.2, 0.5, -0.1])
    motion = free((across, across, along), spin, start)
    momentum = start.apply(np.array([across, across, along]) * spin)
    for t, axes in zip(TIMES, motion["body.rotation"].values.reshape(-1, 3, 3), strict=True):
        precession = Rotation.from_rotvec(momentum * t / across)
        own = Rotation.from_rotvec([0, 0, (1 - along / across) * spin[2] * t])
        np.testing.assert_allclose(axes, (precession * start * own).as_matrix(), atol=1e-9)
