"""Motions of structures with known solutions.

Clough and Penzien, Dynamics of Structures (1993): the damped oscillator under a harmonic load, the
bar under a sudden load, modal superposition. The pendulum's period is Legendre's.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.special import ellipk

import dalembert as da
from dalembert import structures


def test_damped_oscillator_under_a_harmonic_load():
    """``m ẍ + c ẋ + k x = F sin Ωt`` from rest; a bar whose mass matrix is ``ρ A L/3``."""
    area, modulus, density, length = 1e-3, 4e6, 1200.0, 2.0
    s = da.Structure("oscillator")
    a, b = s.node("a", 0.0), s.node("b", length)
    s.add(structures.Truss("bar", a, b, area=area, modulus=modulus, density=density))
    s.support(a)
    force, drive = 30.0, 25.0
    s.load(b, fx=force * da.sin(drive * da.t))
    mass, stiffness = density * area * length / 3, modulus * area / length
    omega, zeta = np.sqrt(stiffness / mass), 0.05
    damping = da.Rayleigh(mass=zeta * omega, stiffness=zeta / omega)  # half the ratio by each
    motion = da.solve_transient(s.build(), 1.0, step=2e-4, damping=damping, outputs=101)
    t, r = motion.time, drive / omega
    size = force / stiffness / ((1 - r**2) ** 2 + (2 * zeta * r) ** 2)
    steady = size * ((1 - r**2) * np.sin(drive * t) - 2 * zeta * r * np.cos(drive * t))
    damped = omega * np.sqrt(1 - zeta**2)
    cosine = 2 * zeta * r * size
    sine = (zeta * omega * cosine - size * (1 - r**2) * drive) / damped
    free = np.exp(-zeta * omega * t) * (cosine * np.cos(damped * t) + sine * np.sin(damped * t))
    computed = motion.values("b.ux")
    np.testing.assert_allclose(computed, steady + free, atol=1e-4 * np.abs(steady).max())


@pytest.mark.parametrize("lumped", [False, True])
def test_bar_under_a_sudden_load(lumped):
    """The end goes to twice the static displacement at ``2 L/c``, back at ``4 L/c``.

    The wave runs with ``c = √(E/ρ)``: the middle rests until ``L/(2c)``.
    """
    count, length, modulus, density, area, force = 100, 2.0, 2e9, 800.0, 1e-4, 50.0
    s = da.Structure("bar")
    nodes = s.add_nodes("n", np.linspace(0.0, length, count + 1)[:, None])
    cells = np.stack([np.arange(count), np.arange(1, count + 1)], axis=1)
    s.add_elements("e", structures.Truss, nodes, cells, area=area, modulus=modulus, density=density)
    s.support(nodes[0])
    s.load(nodes[count], fx=force)
    speed, static = np.sqrt(modulus / density), force * length / (modulus * area)
    trip = length / speed
    motion = da.solve_transient(s.build(), 4 * trip, step=trip / 400, lumped=lumped)
    end, middle = motion.values(f"n[{count}].ux"), motion.values(f"n[{count // 2}].ux")
    wave = 2 * static * (1 - np.abs(motion.time / (2 * trip) - 1))
    np.testing.assert_allclose(end, wave, atol=0.02 * static)
    assert end.max() == pytest.approx(2 * static, rel=0.01)
    early = motion.time < 0.45 * trip  # but for what the mesh disperses
    assert np.abs(middle[early]).max() < 5e-3 * static
    late = (motion.time > 0.6 * trip) & (motion.time < 1.4 * trip)
    course = (motion.time[late] - 0.5 * trip) * static / trip
    np.testing.assert_allclose(middle[late], course, atol=0.02 * static)
    reaction = motion.values("n[0].fx")
    held = (motion.time > 1.3 * trip) & (motion.time < 2.7 * trip)
    assert reaction[held].mean() == pytest.approx(-2 * force, rel=0.01)


def cantilever(count: int = 10):
    """Steel blade, 0.5 m long."""
    length, area, second_moment, modulus, density = 0.5, 1e-4, 2e-10, 2e11, 7850.0
    s = da.Structure("blade")
    nodes = s.add_nodes("n", np.stack([np.linspace(0, length, count + 1), np.zeros(count + 1)], 1))
    cells = np.stack([np.arange(count), np.arange(1, count + 1)], axis=1)
    numbers = {"area": area, "second_moment": second_moment, "modulus": modulus}
    s.add_elements("e", structures.Frame, nodes, cells, density=density, **numbers)
    s.support(nodes[0])
    stiffness, mass = modulus * second_moment, density * area
    return s, nodes, 1.8751040687119612**2 * np.sqrt(stiffness / (mass * length**4)), stiffness


@pytest.mark.thorough
def test_ring_down_of_a_cantilever_is_modal_superposition():
    """Released from a load at its tip; all modes ring, the first as Euler and Bernoulli say."""
    s, nodes, omega, rigidity = cantilever()
    s.load(nodes[10], fy=da.where(da.t <= 0, 1.0, 0.0))
    zeta = 0.01
    damping = da.Rayleigh(mass=2 * zeta * omega)
    model, period = s.build(), 2 * np.pi / omega
    motion = da.solve_transient(
        model, 3 * period, step=period / 4000, start="statics", damping=damping, outputs=61
    )
    tip = motion.values("n[10].uy")
    assert tip[0] == pytest.approx(0.5**3 / (3 * rigidity), rel=1e-9)
    e = motion.record.march.equation
    free = e.free
    squares, shapes = eigh(e.stiffness[free][:, free].toarray(), e.mass[free][:, free].toarray())
    assert np.sqrt(squares[0]) == pytest.approx(omega, rel=1e-4)
    start = shapes.T @ e.mass[free][:, free] @ motion.displacements[free, 0]
    decay = e.alpha / 2
    rates = np.sqrt(squares - decay**2)[:, None] * motion.time
    ringing = np.cos(rates) + decay / np.sqrt(squares - decay**2)[:, None] * np.sin(rates)
    modes = np.exp(-decay * motion.time) * ringing
    row = int(np.flatnonzero(free == model.degrees["n[10]", "uy"])[0])
    superposed = shapes[row] @ (start[:, None] * modes)
    np.testing.assert_allclose(tip, superposed, atol=2e-3 * tip[0])


@pytest.mark.thorough
@pytest.mark.parametrize(("lumped", "share"), [(True, 1.0), (False, 2.0 / 3.0)])
def test_stiff_bar_swings_as_a_pendulum(lumped, share):
    """Released at 120°: ``T = 4 √(L'/g) K(sin θ₀/2)``.

    Half the bar's mass at its end makes a simple pendulum, ``L' = L``; spread over the bar it makes
    a rod, whose length is ``L' = J/(m l) = 2L/3``.
    """
    angle, length, mass, gravity = np.deg2rad(120.0), 1.3, 2.0, 9.81
    s = da.Structure("pendulum")
    a = s.node("a", 0.0, 0.0)
    b = s.node("b", length * np.sin(angle), -length * np.cos(angle))
    s.add(structures.Truss("bar", a, b, area=1.0, modulus=1e7, density=mass / length))
    s.support(a)
    s.load(b, fy=-mass / 2 * gravity)
    period = 4 * np.sqrt(share * length / gravity) * ellipk(np.sin(angle / 2) ** 2)
    options = {"nonlinear": True, "lumped": lumped, "integrator": da.GeneralizedAlpha(rho_inf=0.8)}
    motion = da.solve_transient(s.build(), period, step=period / 1500, **options)
    assert motion.status.success
    place = motion.values("b.ux") + length * np.sin(angle)
    across = np.flatnonzero(np.diff(np.sign(place)))  # through the lowest point, both ways
    quarter, three = motion.time[across] - place[across] * np.diff(motion.time)[0] / (
        place[across + 1] - place[across]
    )
    assert 2 * (three - quarter) == pytest.approx(period, rel=2e-4)
    assert quarter == pytest.approx(period / 4, rel=2e-4)
    assert motion.values("b.ux")[-1] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.thorough
def test_right_angle_cantilever():
    """Simo and Vu-Quoc (Computer Methods in Applied Mechanics and Engineering 66, 1988).

    Two legs of 10 m, E A = G A = 1e6 N, E I = G J = 1e3 N m², ρ A = 1 kg/m, rotary inertia
    (20, 10, 10) kg m; a force out of the plane at the elbow grows to 50 N and vanishes within 2 s.
    The tip rises to 8.25 m at 7.44 s; with inertia that does not turn it would be 7.73 m at 7.80 s.
    """
    count, modulus = 4, 1e6
    along, zero = np.linspace(0.0, 10.0, count + 1), np.zeros(count + 1)
    first, second = np.stack([along, zero, zero], 1), np.stack([zero + 10.0, along, zero], 1)
    s = da.Structure("elbow")
    nodes = s.add_nodes("n", np.vstack([first, second[1:]]))
    cells = [(k, k + 1) for k in range(2 * count)]
    numbers = {"area": 1.0, "second_moment_y": 1e-3, "second_moment_z": 1e-3, "density": 1.0}
    numbers |= {"torsion_constant": 2e-3, "modulus": modulus, "shear_modulus": modulus / 2}
    s.add_elements("leg", structures.SpaceFrame, nodes, cells, **numbers)
    inertia = np.zeros((2 * count + 1, 3))
    for k in range(2 * count):  # half of each element's at both of its ends
        own = [20.0, 10.0, 10.0] if k < count else [10.0, 20.0, 10.0]
        inertia[k : k + 2] += np.array(own) * 10.0 / count / 2
    about = dict(zip(("inertia_x", "inertia_y", "inertia_z"), inertia.T, strict=True))
    each = np.arange(2 * count + 1)[:, None]
    s.add_elements("rotary", structures.PointInertia, nodes, each, **about)
    s.support(nodes[0])
    hat = da.where(da.t < 1, 50 * da.t, da.where(da.t < 2, 100 - 50 * da.t, 0.0))
    s.load(nodes[count], fz=hat)
    options = {"nonlinear": True, "integrator": da.GeneralizedAlpha(rho_inf=0.9)}
    motion = da.solve_transient(s.build(), 8.0, step=0.1, **options)
    assert motion.status.success
    tip = motion.values(f"n[{2 * count}].uz")
    top = int(np.argmax(tip))
    a, b, c = np.polyfit(motion.time[top - 1 : top + 2], tip[top - 1 : top + 2], 2)
    assert c - b**2 / (4 * a) == pytest.approx(8.25, rel=0.01)
    assert -b / (2 * a) == pytest.approx(7.44, rel=0.015)
