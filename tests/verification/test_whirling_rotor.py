"""A spinning disc on isotropic bearings: forward and backward whirl in closed form."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial

ACROSS, POLAR, STIFFNESS, ARM = 0.02, 0.035, 500.0, 0.3
FREQUENCIES = np.array([0.1, 1.0, 3.0, 8.0, 20.0, 60.0])


def rotor(spin: float, damping: float) -> da.Model:
    """A disc about a fixed point; springs and dampers hold a point of its axis."""
    system = da.System("rotor", gravity=(0, 0, 0))
    pushes = [system.input(f"push_{axis}", unit="N") for axis in "xy"]
    stiffness = system.parameter("stiffness", STIFFNESS, "N/m")
    inertia = (ACROSS, ACROSS, POLAR)
    start = {"mass": 2.0, "inertia": inertia, "angular_velocity": (0, 0, spin)}
    disc = system.add(spatial.Body("disc", **start))
    frames = system.ground.frame((0, 0, 0)), disc.frame((0, 0, 0))
    system.add(spatial.Spherical("pivot", *frames))
    tip = disc.point(0, 0, ARM)
    forces = []
    for push, place, axis in zip(pushes, (tip.x, tip.y), "xy", strict=True):
        speed = tip.velocity[0 if axis == "x" else 1]
        forces.append(push - stiffness * place - damping * speed)
        system.output(axis, place)
    system.add(spatial.Force("bearing", tip, (*forces, 0)))
    return system.build()


def exact(spin: float, damping: float, frequencies: np.ndarray) -> np.ndarray:
    """(K, 2, 2) displacements: ``I_t α̈ + Ω I_p β̇ + l² (k + c d/dt) α = −l F_y`` and so on."""
    tables = []
    for s in 2j * np.pi * frequencies:
        own = ACROSS * s**2 + (STIFFNESS + damping * s) * ARM**2
        tilts = [[own, spin * POLAR * s], [-spin * POLAR * s, own]]
        a, b = np.linalg.solve(tilts, [[0, -ARM], [ARM, 0]])
        tables.append([ARM * b, -ARM * a])
    return np.array(tables)


def whirl(spin: float) -> np.ndarray:
    """Backward and forward whirl [rad/s] of the undamped rotor, magnitudes."""
    half = spin * POLAR / (2 * ACROSS)
    root = np.sqrt(half**2 + STIFFNESS * ARM**2 / ACROSS)
    return np.array([root - half, root + half])


@pytest.mark.few(2)
@pytest.mark.parametrize("damping", [0.0, 0.7])
@pytest.mark.parametrize("spin", [0.0, 50.0, 300.0])
def test_frequency_response(spin, damping) -> None:
    response = da.frequency_response(rotor(spin, damping), FREQUENCIES, equilibrium=False)
    expected = exact(spin, damping, FREQUENCIES)
    size = np.abs(expected).max(axis=(1, 2), keepdims=True)
    assert (np.abs(response.table - expected) / size).max() < 1e-10


@pytest.mark.few(2)
@pytest.mark.parametrize("spin", [0.0, 50.0, 300.0])
def test_campbell_diagram(spin) -> None:
    """Both whirls are resonances of the fixed frame, at any turn of the disc."""
    response = da.frequency_response(rotor(spin, 0.0), equilibrium=False)
    peaks = np.unique([frequency for frequency, _ in response.peaks("x", "push_x")])
    np.testing.assert_allclose(peaks * 2 * np.pi, np.unique(whirl(spin)), rtol=1e-9)
    turned = da.solve_dynamics(rotor(spin, 0.7), 0.37, step=1e-3)
    options = {"about": turned}
    later = da.frequency_response(turned.model, FREQUENCIES, **options)
    np.testing.assert_allclose(
        later.table, exact(spin, 0.7, FREQUENCIES), rtol=0, atol=1e-9 * np.abs(later.table).max()
    )


def test_gradient_of_a_spinning_rotor() -> None:
    """By the stiffness of both springs, ``∂H/∂k = −H H``."""
    response = da.frequency_response(rotor(50.0, 0.7), FREQUENCIES, equilibrium=False)
    measure = da.at(3.0, "x.push_y.amplitude")
    place = list(FREQUENCIES).index(3.0)
    h = exact(50.0, 0.7, FREQUENCIES)[place]
    slope = -(h @ h)[0, 1]  # the spring acts in the points of the forces
    expected = (np.conj(h[0, 1]) * slope).real / abs(h[0, 1])
    assert abs(expected) > 1e-8
    for method in ("direct", "adjoint"):
        gradient = da.sensitivity(response, measure, method=method)
        assert gradient.sel(parameter="stiffness").item() == pytest.approx(expected, rel=1e-10)


def test_two_masses_on_a_shaking_base() -> None:
    """Transmissibilities and the dynamic force of the base, from 2 × 2 matrices."""
    system = da.System("stack")
    base = system.input("base", unit="m")
    foot = system.add(planar.Particle("foot", mass=1.0))
    parts, numbers = [foot], [(3.0, 900.0, 4.0), (1.5, 400.0, 1.0)]
    system.add(planar.PinInSlot("r0", system.ground.center, foot.center))
    system.add(planar.CoordinateDriver("shaker", foot.center, base))
    for k, (mass, stiffness, damping) in enumerate(numbers, 1):
        body = system.add(planar.Particle(f"m{k}", mass=mass, position=(0.5 * k, 0)))
        system.add(planar.PinInSlot(f"r{k}", system.ground.center, body.center))
        ends = parts[-1].center, body.center
        spring = {"stiffness": stiffness, "damping": damping, "free_length": 0.5}
        system.add(planar.Spring(f"s{k}", *ends, **spring))
        parts.append(body)
    f = np.geomspace(0.01, 100, 60)
    outputs = ["m1.x", "m2.x", "m2.ax", "s1.force", "shaker.effort"]
    response = da.frequency_response(system.build(), f, outputs=outputs)
    rows = []
    for s in 2j * np.pi * f:
        (m1, k1, c1), (m2, k2, c2) = numbers
        low, high = k1 + c1 * s, k2 + c2 * s
        x1, x2 = np.linalg.solve(
            [[m1 * s**2 + low + high, -high], [-high, m2 * s**2 + high]], [low, 0]
        )
        rows.append([x1, x2, s**2 * x2, low * (x1 - 1), s**2 + low * (1 - x1)])
    values = response.table[:, :, 0] / np.array(rows)
    assert np.abs(np.abs(values) - 1).max() < 1e-10
    signs = values[0].real.round()
    np.testing.assert_allclose(values, np.tile(signs, (f.size, 1)), atol=1e-10)
