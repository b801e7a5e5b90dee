"""Eigenvalues of spinning spatial bodies in closed form, in every choice of coordinates.

Whirl of a symmetric rotor: ``I_t z̈ + (c − i Ω I_p) ż + k z = 0`` with ``z = α + iβ`` of its small
tilts in inertial axes (G. Genta, Dynamics of Rotating Systems, 2005, 2.2); a sleeping top has
``k = −m g l`` (Goldstein, Classical Mechanics, 5.7). A free body that spins about a principal axis:
Euler's equations.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from test_whipple_bicycle import EIGENVALUES, bicycle

import dalembert as da
from dalembert import spatial

ACROSS, POLAR, ARM, MASS, G = 0.02, 0.035, 0.3, 2.0, 9.81
COORDINATES = [da.AbsoluteCoordinates(), da.JointCoordinates()]


def rotor(
    spin: float,
    stiffness: tuple[float, float] = (500.0, 500.0),
    damping: float = 0.0,
    gravity: float = 0.0,
    turn: float = 0.0,
) -> da.Model:
    """A disc about a fixed point; springs and dampers in x and y hold a point of its axis."""
    system = da.System("rotor", gravity=(0, 0, -gravity))
    push = system.input("push", unit="N")
    k_x = system.parameter("k_x", stiffness[0], "N/m")
    k_y = system.parameter("k_y", stiffness[1], "N/m")
    across = system.parameter("across", ACROSS, "kg m^2")
    turning = system.parameter("spin", spin, "rad/s")
    disc = system.add(
        spatial.Body(
            "disc",
            mass=MASS,
            inertia=(across, across, POLAR),
            angular_velocity=(0, 0, turning),
            center_of_mass=(0, 0, ARM) if gravity else (0, 0, 0),
            rotation=da.rotation.axis_angle((0, 0, 1), turn),
        )
    )
    system.add(spatial.Spherical("pivot", system.ground.frame((0, 0, 0)), disc.frame((0, 0, 0))))
    tip = disc.point(0, 0, ARM)
    v = tip.velocity
    forces = (push - k_x * tip.x - damping * v[0], -k_y * tip.y - damping * v[1], 0)
    system.add(spatial.Force("bearing", tip, forces))
    system.output("x", tip.x)
    return system.build()


def compare(values: np.ndarray, expected: np.ndarray) -> None:
    """All values, in any order, relative to the largest one; multiple zeros are ill-conditioned."""
    values, size = list(values), np.abs(expected).max()
    for value in sorted(expected, key=lambda z: -abs(z)):
        nearest = min(range(len(values)), key=lambda k, value=value: abs(values[k] - value))
        assert abs(values[nearest] - value) < 1e-9 * size, (value, values)
        del values[nearest]
    assert np.abs(values).max(initial=0.0) < 1e-6 * size


def conjugates(values: np.ndarray) -> np.ndarray:
    """Eigenvalues with the conjugates of complex ones."""
    return np.concatenate([values, values[np.abs(values.imag) > 0].conj()])


def state_space_poles(modes: da.Modes) -> np.ndarray:
    return np.linalg.eigvals(modes.state_space(["push"], ["x"]).A)


def whirl(spin: float, stiffness: float, damping: float = 0.0, inertia: float = ACROSS):
    """Roots of the tilts ``z`` and of their conjugates."""
    roots = np.roots([inertia, damping - 1j * spin * POLAR, stiffness])
    return np.concatenate([roots, roots.conj()])


@pytest.mark.few(4)
@pytest.mark.parametrize("coordinates", COORDINATES)
@pytest.mark.parametrize("damping", [0.0, 0.7])
@pytest.mark.parametrize("spin", [0.0, 50.0, 300.0])
def test_forward_and_backward_whirl(spin, damping, coordinates) -> None:
    model = rotor(spin, damping=damping, turn=0.6)
    modes = da.linearize(model, equilibrium=False, coordinates=coordinates)
    values = conjugates(modes.eigenvalues)
    compare(values, whirl(spin, 500 * ARM**2, damping * ARM**2))
    assert modes.warnings == ()
    if coordinates == COORDINATES[0]:
        compare(state_space_poles(modes), whirl(spin, 500 * ARM**2, damping * ARM**2))


def test_anisotropic_bearings() -> None:
    """``I_t² s⁴ + (I_t (k_x + k_y) l² + Ω² I_p²) s² + k_x k_y l⁴ = 0``."""
    spin, k = 80.0, np.array([500.0, 900.0]) * ARM**2
    modes = da.linearize(rotor(spin, (500.0, 900.0)), equilibrium=False)
    quadratic = [ACROSS**2, ACROSS * k.sum() + (spin * POLAR) ** 2, k.prod()]
    squares = np.roots(quadratic)
    expected = np.concatenate([np.emath.sqrt(squares), -np.emath.sqrt(squares)])
    compare(conjugates(modes.eigenvalues), expected)
    compare(state_space_poles(modes), expected)
    assert modes.warnings == ()


def test_about_the_end_of_a_motion() -> None:
    motion = da.solve_dynamics(rotor(50.0), 0.37, step=1e-3)
    modes = da.linearize(motion.model, about=motion)
    compare(conjugates(modes.eigenvalues), whirl(50.0, 500 * ARM**2))
    compare(state_space_poles(modes), whirl(50.0, 500 * ARM**2))


@pytest.mark.parametrize(("share", "stable"), [(0.8, False), (1.3, True)])
def test_sleeping_top(share, stable) -> None:
    """It is stable above ``Ω = 2 √(I_t m g l)/I_p``, about its fixed point."""
    about = ACROSS + MASS * ARM**2
    spin = share * 2 * np.sqrt(about * MASS * G * ARM) / POLAR
    modes = da.linearize(rotor(spin, (0.0, 0.0), gravity=G), equilibrium=False)
    compare(conjugates(modes.eigenvalues), whirl(spin, -MASS * G * ARM, inertia=about))
    growth = np.abs(modes.eigenvalues.real).max() / np.abs(modes.eigenvalues).max()
    assert (growth < 1e-6) == stable
    assert modes.warnings == ()


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_free_body_spins_about_a_principal_axis(axis) -> None:
    """Unstable about the middle one: ``λ² = Ω² (J_a − J_b)(J_c − J_a)/(J_b J_c)``."""
    moments, spin = np.array([1.0, 2.0, 2.5]), 4.0
    system = da.System("free body", gravity=(0, 0, 0))
    push = system.input("push", unit="N")
    attitude = Rotation.from_rotvec([0.4, -0.7, 0.3])
    turning = tuple(attitude.apply(spin * np.eye(3)[axis]))
    start = {"rotation": attitude, "angular_velocity": turning}
    body = system.add(spatial.Body("body", mass=1.0, inertia=moments, **start))
    system.add(spatial.Force("push", body.center, (push, 0, 0)))
    system.output("x", body.x)
    model = system.build()
    a, b, c = moments[axis], moments[axis - 2], moments[axis - 1]
    square = spin**2 * (a - b) * (c - a) / (b * c)
    root = np.emath.sqrt(square)
    expected = np.array([root, -root, 1j * spin, -1j * spin])  # the last ones turn with the body
    for coordinates in COORDINATES:
        modes = da.linearize(model, equilibrium=False, coordinates=coordinates)
        compare(conjugates(modes.eigenvalues), expected)
        assert modes.warnings == () and modes.stable == (axis != 1)
        compare(state_space_poles(modes), expected)


@pytest.mark.few(2)
@pytest.mark.parametrize("speed", EIGENVALUES)
def test_bicycle_in_absolute_coordinates(speed) -> None:
    """Table 2 of Meijaard et al., 2007; all other eigenvalues are zero."""
    modes = da.linearize(bicycle(speed).build(), equilibrium=False)
    values = list(conjugates(modes.eigenvalues))
    for expected in EIGENVALUES[speed]:
        nearest = min(range(len(values)), key=lambda k, value=expected: abs(values[k] - value))
        assert abs(values[nearest] - expected) < 1e-6
        del values[nearest]
    assert modes.warnings == ()


def test_eccentric_rotor_is_steady_in_joint_coordinates() -> None:
    """Its mass centre goes round, so that in absolute coordinates there is a warning."""
    system = da.System("eccentric", gravity=(0, 0, 0))
    start = {"center_of_mass": (0.1, 0, 0), "angular_velocity": (0, 0, 30.0)}
    wheel = system.add(spatial.Body("wheel", mass=1.0, inertia=(0.2, 0.3, 0.4), **start))
    up = {"axis": (0, 0, 1), "x": (1, 0, 0)}
    system.add(spatial.Revolute("O", system.ground.frame(**up), wheel.frame(**up)))
    model, joints = system.build(), da.JointCoordinates()
    modes = da.linearize(model, equilibrium=False, coordinates=joints)
    assert np.abs(modes.eigenvalues).max() < 1e-6 * 30 and modes.warnings == ()
    assert any("JointCoordinates" in w for w in da.linearize(model, equilibrium=False).warnings)


def test_unsymmetric_rotor_on_unsymmetric_bearings_has_a_warning() -> None:
    """Its equations are periodic in every frame."""
    system = da.System("rotor", gravity=(0, 0, 0))
    disc = system.add(
        spatial.Body("disc", mass=2.0, inertia=(0.02, 0.025, 0.035), angular_velocity=(0, 0, 60.0))
    )
    system.add(spatial.Spherical("pivot", system.ground.frame((0, 0, 0)), disc.frame((0, 0, 0))))
    tip = disc.point(0, 0, ARM)
    system.add(spatial.Force("bearing", tip, (-500 * tip.x, -900 * tip.y, 0)))
    modes = da.linearize(system.build(), equilibrium=False)
    assert any("not steady" in warning for warning in modes.warnings)


@pytest.mark.few(1)
@pytest.mark.parametrize("spin", [0.0, 50.0])
def test_gradients_of_whirl(spin) -> None:
    """``ω = ½ (∓n + √(n² + 4 κ))`` with ``n = Ω I_p/I_t``, ``κ = k l²/I_t``, and both springs."""
    modes = da.linearize(rotor(spin, (500.0, 900.0)), equilibrium=False)
    k = np.array([500.0, 900.0])

    def squares(values: np.ndarray) -> np.ndarray:
        k_x, k_y, across, turning = values
        stiffness = np.array([k_x, k_y]) * ARM**2
        middle = across * stiffness.sum() + (turning * POLAR) ** 2
        return np.sort(-np.roots([across**2, middle, stiffness.prod()]).real)

    point = np.array([*k, ACROSS, spin])
    numbers = [int(n) for n, z in zip(modes.numbers, modes.eigenvalues, strict=True) if z.imag > 1]
    responses = [da.at(n, "angular_frequency") for n in numbers]
    np.testing.assert_allclose(
        [da.evaluate(modes, response) for response in responses],
        np.sqrt(squares(point)),
        rtol=1e-9,
    )
    expected = _differences(lambda values: np.sqrt(squares(values)), point)
    for method in ("direct", "adjoint"):
        gradient = da.sensitivity(modes, responses, method=method)
        computed = gradient.sel(parameter=["k_x", "k_y", "across", "spin"]).values
        sizes = np.array([*k, ACROSS, 50.0])
        largest = np.abs(expected * sizes).max()
        np.testing.assert_allclose(computed * sizes, expected * sizes, atol=1e-8 * largest)
    assert da.sensitivity(modes, responses, certificate=True).attrs["certificate"].passed


def _differences(function, point: np.ndarray) -> np.ndarray:
    """(rows, entries) by Richardson extrapolation of central differences."""
    columns = []
    for k, value in enumerate(point):
        step = 1e-3 * max(abs(value), 1e-2)

        def central(h: float, k: int = k) -> np.ndarray:
            shift = h * np.eye(point.size)[k]
            return (function(point + shift) - function(point - shift)) / (2 * h)

        columns.append((4 * central(step / 2) - central(step)) / 3)
    return np.array(columns).T
