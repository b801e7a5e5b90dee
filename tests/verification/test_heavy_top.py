"""Heavy top: a rotor of 15 kg spins at 150 rad/s about an axis that leaves its fixed point.

Sources: Z. Terze, A. Müller, D. Zlatar, *Singularity-free time integration of rotational
quaternions using non-redundant ordinary differential equations*, Multibody System Dynamics 38,
2016, after O. Brüls, A. Cardona and M. Arnold; Euler parameters at 0.2 s as printed there, to 5e-5.
All other numbers are of independent integrations of Euler's equations.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import spatial

MASS, G, SPIN = 15.0, 9.81, (0.0, 150.0, -4.61538)
CENTERS = {
    0.1: (0.42129666, 0.89457197, -0.14916470),
    0.2: (0.60555056, 0.59895768, -0.52398303),
    0.5: (-0.70246830, -0.02116518, -0.71140026),
    1.0: (0.17334396, 0.64008859, -0.74849079),
    2.0: (-0.1504168, -0.7241656, -0.6730223),
}


def top() -> da.Model:
    system = da.System("heavy top", gravity=(0.0, 0.0, -G))
    rotor = spatial.Body(
        "rotor",
        mass=MASS,
        inertia=(0.234375, 0.46875, 0.234375),
        center_of_mass=(0, 1, 0),
        position=(0, 0, 0),
        rotation=da.rotation.identity(),
        angular_velocity=SPIN,
        points={"C": (0, 1, 0)},
    )
    system.add(rotor)
    system.add(spatial.Spherical("O", system.ground.point(0, 0, 0), rotor))
    return system.build()


@pytest.fixture(scope="module")
def motion() -> da.Motion:
    run = da.solve_dynamics(
        top(), 2.0, integrator=da.DormandPrince853(1e-11, 1e-11), outputs=list(CENTERS)
    )
    assert run.status.success
    return run


def test_mass_center_within_1e_6(motion):
    computed = np.stack([motion[f"rotor.C.{axis}"].values for axis in "xyz"], axis=1)
    np.testing.assert_allclose(computed, list(CENTERS.values()), atol=1e-7)


def test_attitude(motion):
    computed = motion["rotor.euler_parameters"].values
    np.testing.assert_allclose(
        computed[1], (-0.70828, 0.43878, 0.54573, 0.0894), atol=5e-5
    )  # printed
    np.testing.assert_allclose(
        computed[1], (-0.70827915, 0.43878109, 0.54572840, 0.08939975), atol=1e-7
    )
    np.testing.assert_allclose(
        computed[4], (0.1229471, -0.4910799, 0.3504300, -0.7879869), atol=1e-7
    )
    np.testing.assert_allclose(np.linalg.norm(computed, axis=1), 1.0, atol=1e-12)


def test_spin_and_constants_of_the_motion(motion):
    """The spin about the axis of the body, the angular momentum about the vertical, the energy."""
    spin = motion["rotor.angular_velocity_local"].values
    np.testing.assert_allclose(spin[3], (-0.8220781, 150.0, -5.9232913), atol=2e-6)
    np.testing.assert_allclose(spin[:, 1], 150.0, rtol=1e-10)
    about_pivot = np.array([0.234375 + MASS, 0.46875, 0.234375 + MASS])
    axes = motion["rotor.rotation"].values.reshape(-1, 3, 3)
    momentum = np.einsum("kij,kj->ki", axes, about_pivot * spin)
    np.testing.assert_allclose(momentum[:, 2], about_pivot[2] * SPIN[2], atol=1e-7)
    np.testing.assert_allclose(motion["energy"] - motion["energy"][0], 0.0, atol=1e-6)


def test_reaction_carries_the_weight_and_accelerates_the_mass(motion):
    """Newton's equation of the mass centre."""
    acceleration = np.stack([motion[f"rotor.C.a{axis}"].values for axis in "xyz"], axis=1)
    np.testing.assert_allclose(
        motion["O.force"].values, MASS * (acceleration + np.array([0, 0, G])), rtol=1e-9, atol=1e-7
    )
