"""Book example 6.2: slider, link, crank and spring; which speed may be independent for whole turns.

a = 2, b = 1, l1 = 0.8, l2 = 1, l3 = 0.5 m (Fig. 6.3, 6.4). The slider moves along the x-axis and
carries the pin B at the height l1; the crank turns about (a, b); the link joins B to its end D.

By hand: with u = θ₃ the rows of W at the slider's guide and the crank's pivot are triangular with
ones on the diagonal. What is left, the columns ẋ₁, ẋ₂, ẏ₂, φ̇₂ in the rows of the pins B and D, has
the determinant ± l2 cos φ₂, the horizontal distance of the pins. So, with φ measured from the
x-axis,

    |det W| = √(l2² − (b + l3 sin φ₃ − l1)²)  for u = φ̇₃,
    l3 |cos φ₃|  for u = φ̇₂,    l2 l3 |sin(φ₂ − φ₃)|  for u = ẋ₁.
"""

from __future__ import annotations

import functools
import math

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar

A, B, L1, L2, L3 = 2.0, 1.0, 0.8, 1.0, 0.5
A1, STIFFNESS, FREE = 0.4, 20.0, 0.9
"""The book prints no masses and no spring: these are ours."""
TURN = np.linspace(0, 2 * np.pi, 73)


@functools.cache
def mechanism() -> da.Model:
    system = da.System("example 6.2")
    slider = system.add(planar.Body("slider", mass=2.0, inertia=0.1, position=(1.2, A1), angle=0.0))
    link = system.add(planar.Bar("link", length=L2, mass=1.0, angle=0.6))
    crank = system.add(planar.Bar("crank", length=L3, mass=0.8, angular_velocity=5.0))
    system.add(planar.Prismatic("A", system.ground.center, slider.point(0, -A1)))
    system.add(planar.Revolute("B", slider.point(0, L1 - A1), link.start))
    system.add(planar.Revolute("D", link.end, crank.end))
    system.add(planar.Revolute("E", system.ground.point(A, B), crank.start))
    system.add(
        planar.Spring(
            "spring",
            system.ground.center,
            slider.point(0, -A1),
            stiffness=STIFFNESS,
            free_length=FREE,
        )
    )
    return system.build()


def position(crank: float) -> np.ndarray:
    """The nine coordinates by hand, from the angle of the crank."""
    along = np.array([np.cos(crank), np.sin(crank)])
    end = np.array([A, B]) + L3 * along
    rise = end[1] - L1
    link = np.arcsin(rise / L2)
    slide = end[0] - np.sqrt(L2**2 - rise**2)
    middle = (np.array([slide, L1]) + end) / 2
    return np.array([slide, A1, 0.0, *middle, link, *(np.array([A, B]) + L3 / 2 * along), crank])


def determinants(name: str) -> np.ndarray:
    """|det W| of the model over a turn, with the speed of one coordinate independent."""
    model = mechanism()
    e = model.equations
    function = ca.Function("C", [e.t, e.y, e.p], [ca.densify(e.jacobian)])
    k = model.guesses.names.index(name)
    computed = [function(0, position(angle), model.nominal).full() for angle in TURN]
    return np.array([abs(np.linalg.det(np.delete(c, k, axis=1))) for c in computed])


def test_geometry():
    """Nine coordinates, eight equations, all satisfied by the positions found by hand."""
    e = mechanism().equations
    assert (e.coordinate_count, e.constraint_count) == (9, 8)
    function = ca.Function("Phi", [e.t, e.y, e.p], [e.constraints])
    for angle in TURN:
        violation = function(0, position(angle), mechanism().nominal).full()
        np.testing.assert_allclose(violation, 0, atol=1e-14)


def test_determinant_of_the_books_partition_never_vanishes():
    """Figure 6.4: between √0.51 and 1 for a whole turn."""
    determinant_values = determinants("crank.angle")
    expected = np.sqrt(L2**2 - (B + L3 * np.sin(TURN) - L1) ** 2)
    np.testing.assert_allclose(determinant_values, expected, rtol=1e-13)
    assert determinant_values.min() == pytest.approx(
        math.sqrt(0.51), rel=1e-13
    )  # crank upright, TURN[18]
    assert determinant_values.max() <= 1 + 1e-13


def test_other_partitions_vanish():
    link = np.array([position(angle)[5] for angle in TURN])
    np.testing.assert_allclose(determinants("link.angle"), L3 * abs(np.cos(TURN)), atol=1e-13)
    expected = L2 * L3 * abs(np.sin(link - TURN))
    np.testing.assert_allclose(determinants("slider.x"), expected, atol=1e-13)
    assert expected.min() < 0.05 * expected.max()


def energy(crank: float, speed: float) -> float:
    """Of the mechanism as one degree of freedom, speeds by differences of the positions."""
    h = 1e-5
    rate = speed * (position(crank + h) - position(crank - h)) / (2 * h)
    mass = np.array([2.0, 2.0, 0.1, 1.0, 1.0, L2**2 / 12, 0.8, 0.8, 0.8 * L3**2 / 12])
    stretch = position(crank)[0] - FREE
    return float(mass @ rate**2 / 2 + STIFFNESS * stretch**2 / 2)


def test_minimal_equations_turn_fully():
    """One second-order equation in the book's u: it keeps the energy of the positions by hand."""
    book = da.VelocityPartitioning(("crank.angle",))
    motion = da.solve_dynamics(
        mechanism(), 2.0, step=0.001, formulation=book, stabilization=da.Stabilization()
    )
    assert motion.status.success
    angle, speed = motion["crank.angle"].values, motion["crank.angular_velocity"].values
    assert abs(angle[-1] - angle[0]) > 2 * math.pi
    start = energy(angle[0], speed[0])
    for k in range(0, motion.time.size, 100):
        assert energy(angle[k], speed[k]) == pytest.approx(start, rel=1e-7)
        np.testing.assert_allclose(motion.trajectory.y[:, k], position(angle[k]), atol=1e-8)
