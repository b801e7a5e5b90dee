"""Coordinates as a manifold: displacements, their inverse, and what integration leaves of norms."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import spatial


@pytest.fixture(scope="module")
def model() -> da.Model:
    """Two bodies on ball joints, the second with its mass centre off its origin."""
    system = da.System("two", gravity=(0, 0, -9.81))
    turn = da.rotation.bryant(0.3, -0.2, 0.5)
    first = system.add(
        spatial.Body("a", mass=2.0, inertia=(0.3, 0.4, 0.2), position=(0, 0, -1), rotation=turn)
    )
    second = system.add(
        spatial.Body(
            "b",
            mass=1.0,
            inertia=(0.1, 0.2, 0.15, 0.01, 0.02, -0.01),
            center_of_mass=(0.1, 0.0, 0.2),
            angular_velocity=(1.0, 2.0, 3.0),
        )
    )
    system.add(spatial.Spherical("A", system.ground.point(0, 0, 0), first.point(0, 0, 1)))
    system.add(spatial.Spherical("B", first.point(0, 0, -1), second.point(0, 0.5, 0)))
    return system.build()


def random_state(model: da.Model, seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    poses = [np.r_[rng.normal(size=3), Rotation.random(random_state=rng).as_quat()] for _ in "ab"]
    return np.concatenate(poses), rng.normal(size=12)


@pytest.mark.parametrize("seed", range(3))
def test_a_displacement_leads_back(model, seed):
    m, (y, delta) = model.equations.manifold, random_state(model, seed)
    there = m.go(y, delta)
    np.testing.assert_allclose(m.lead(y, there), delta, atol=1e-12)
    np.testing.assert_allclose([there[3:7] @ there[3:7], there[10:] @ there[10:]], 1, atol=1e-14)


@pytest.mark.parametrize("seed", range(3))
def test_short_displacements_are_speeds(model, seed):
    """``y ⊕ h v = y + h A v + O(h²)``, and the turn agrees with SciPy's to second order."""
    e, (y, v) = model.equations, random_state(model, seed)
    rate = np.array(ca.Function("rate", [e.y, e.v], [e.pose_rate])(y, v)).ravel()
    h = 1e-5
    slope = (e.manifold.go(y, h * v) - e.manifold.go(y, -h * v)) / (2 * h)
    np.testing.assert_allclose(slope, rate, atol=1e-9)
    turned = Rotation.from_quat(np.roll(y[3:7], -1)) * Rotation.from_rotvec(1e-3 * v[3:6])
    there = Rotation.from_quat(np.roll(e.manifold.go(y, 1e-3 * v)[3:7], -1))
    assert (turned.inv() * there).magnitude() < 1e-9 * (1 + np.linalg.norm(v[3:6]) ** 3)


def test_the_tangent_of_a_length_is_read_off(model):
    """``reading`` turns small differences of positions into displacements."""
    e, y = model.equations, random_state(model, 5)[0]
    both = ca.Function("both", [e.y], [e.manifold.reading, e.lift])
    reading, lift = (np.array(part) for part in both(y))
    np.testing.assert_allclose(reading @ lift, np.eye(12), atol=1e-14)


INTEGRATORS = {
    "RK4": da.RK4(),
    "DormandPrince": da.DormandPrince(1e-6, 1e-6),
    "BackwardEuler": da.BackwardEuler(),
    "GeneralizedAlpha": da.GeneralizedAlpha(),
    "Radau": da.Radau(),
    "BDF": da.BDF(),
}


@pytest.mark.few(2)
@pytest.mark.parametrize("stabilization", [da.Stabilization(), da.Projection()], ids=str)
@pytest.mark.parametrize("name", INTEGRATORS)
def test_norms_are_kept(model, name, stabilization):
    motion = da.solve_dynamics(
        model, 0.3, step=0.01, integrator=INTEGRATORS[name], stabilization=stabilization
    )
    e = motion.data.euler_parameters.values
    np.testing.assert_allclose((e**2).sum(axis=2), 1.0, atol=1e-13)


def test_speeds_are_given_where_the_body_comes_to_stand():
    """Angular velocity in inertial axes, of a body that assembly turns."""
    system = da.System("turned")
    body = system.add(
        spatial.Body(
            "b", mass=1.0, inertia=(1, 1, 1), position=(0, 0, 0), angular_velocity=(0, 0, 2.0)
        )
    )
    frame = system.ground.frame((0, 0, 0), axis=(0, 0, 1))
    system.add(spatial.Revolute("pin", frame, body.frame((0, 0, 0), axis=(0, 0.6, 0.8))))
    model = system.build()
    motion = da.solve_dynamics(model, 0.01, step=0.01)
    np.testing.assert_allclose(motion["b.angular_velocity"].values[0], [0, 0, 2.0], atol=1e-12)


def test_speeds_have_names_of_their_own(model):
    motion = da.solve_dynamics(model, 0.02, step=0.01)
    assert motion.data.coordinates.dims == ("time", "coordinate")
    assert motion.data.speeds.dims == ("time", "speed")
    assert "a.e0" in motion.data.coordinate.values
    assert "a.turn_x" in motion.data.speed.values


def test_derivatives_of_constraints_by_either_way(model):
    """What bodies' axes give as coordinates of their own is what Euler parameters give."""
    from dataclasses import replace

    e = model.all_equations
    assert e.kinematics is not None
    plain = replace(e, kinematics=None)
    inputs = [e.t, e.y, e.v, e.p]
    y, v = random_state(model, 7)
    values = [
        ca.Function("f", inputs, [q.jacobian, q.velocity_constraints, q.constraint_acceleration])(
            0, y, v, model.nominal
        )
        for q in (e, plain)
    ]
    for one, other in zip(*values, strict=True):
        np.testing.assert_allclose(np.array(one), np.array(other), atol=1e-12)


def spinning(carried: bool) -> da.Model:
    """A wheel on a frame that slides; either may carry the other."""
    system = da.System("wheel")
    still = da.rotation.identity()
    frame = spatial.Body("frame", mass=2.0, inertia=(1, 2, 2), position=(0, 0, 0), rotation=still)
    wheel = spatial.Body(
        "wheel",
        mass=1.0,
        inertia=(0.3, 0.5, 0.3),
        position=(0, 0, 0),
        rotation=still,
        angular_velocity=(0, 4.0, 0),
    )
    for body in (frame, wheel) if carried else (wheel, frame):
        system.add(body)
    axle = {"axis": (0, 1, 0)}
    system.add(
        spatial.Revolute("axle", frame.frame((0, 0, 0), **axle), wheel.frame((0, 0, 0), **axle))
    )
    return system.build()


def test_modes_of_a_spinning_wheel_do_not_depend_on_what_carries_it():
    """The motion is steady by the joint, and in body axes where the wheel carries the frame."""
    frequencies = []
    for carried in (True, False):
        coordinates = da.JointCoordinates()
        modes = da.linearize(spinning(carried), equilibrium=False, coordinates=coordinates)
        assert not modes.warnings
        frequencies.append(np.abs(np.imag(modes.eigenvalues)).max())
    assert frequencies[0] > 1
    assert frequencies[1] == pytest.approx(frequencies[0], rel=1e-9)
