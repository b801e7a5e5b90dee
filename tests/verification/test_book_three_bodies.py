"""Examples 5.1, 6.1 and 6.3: bar on a pin, slider on the bar with a spring, hanging bar.

Source: *Advanced Design of Mechanical Systems: From Analysis to Optimization*, CISM 511, Chapters 5
and 6. The equations in joint coordinates q = (φ, s, θ) are written here by hand in the axes of the
bar: φ and θ are the angles of the first and the third bar from the x axis, s is the distance O C2.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.model.graph.derivation import appell_function, gibbs_appell, kane
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.transformation import (
    Transformation,
    change_coordinates,
    coordinates_by,
    speeds_by_basis,
)

G, K, FREE = 9.81, 60.0, 0.5
M1, M2, M3, J1, J2, J3 = 2.0, 0.8, 1.1, 0.12, 0.01, 0.05
A1, A2, A3 = 0.4, 0.1, 0.3  # O C1, C2 A, A C3
STATES = [
    (np.array([0.3, 0.55, -1.2]), np.array([0.7, -0.4, 1.5])),
    (np.array([-1.4, 0.35, 0.6]), np.array([-2.1, 0.9, -0.3])),
]


@pytest.fixture(scope="module")
def equations() -> Equations:
    system = da.System("three bodies", gravity=(0.0, -G))
    bar = system.add(planar.Body("bar", mass=M1, inertia=J1, angle=0.3))
    slider = system.add(planar.Body("slider", mass=M2, inertia=J2, position=(0.5, 0.2)))
    rod = system.add(planar.Body("rod", mass=M3, inertia=J3, angle=-1.2))
    pin = system.ground.center
    system.add(planar.Revolute("O", pin, bar.point(-A1, 0)))
    system.add(planar.Prismatic("guide", bar.center, slider.center))
    system.add(planar.Revolute("A", slider.point(A2, 0), rod.point(-A3, 0)))
    system.add(planar.Spring("spring", pin, slider.center, stiffness=K, free_length=FREE))
    return system.build().equations


def along(angle) -> ca.SX:
    return ca.vertcat(ca.cos(angle), ca.sin(angle))


def joint_coordinates(e: Equations) -> Transformation:
    """``y = g(q)`` (4.15)."""
    q = ca.SX.sym("q", 3)
    phi, s, theta = ca.vertsplit(q)
    third = (s + A2) * along(phi) + A3 * along(theta)
    g = ca.vertcat(A1 * along(phi), phi, s * along(phi), phi, third, theta)
    return coordinates_by(e, g, q)


def by_hand(q, u):
    """M̂, d̂ and f̂, from the accelerations of the mass centres in the axes of the bar."""
    (phi, s, theta), (w, ds, turn) = q, u
    r, cd, sd = s + A2, np.cos(theta - phi), np.sin(theta - phi)
    mass = np.array(
        [
            [J1 + M1 * A1**2 + J2 + M2 * s**2 + M3 * r**2, 0, M3 * r * A3 * cd],
            [0, M2 + M3, -M3 * A3 * sd],
            [M3 * r * A3 * cd, -M3 * A3 * sd, J3 + M3 * A3**2],
        ]
    )
    bias = np.array(
        [
            2 * M2 * s * ds * w + M3 * r * (2 * ds * w - A3 * turn**2 * sd),
            -(M2 * s + M3 * r) * w**2 - M3 * A3 * turn**2 * cd,
            M3 * A3 * (r * w**2 * sd + 2 * ds * w * cd),
        ]
    )
    force = np.array(
        [
            -G * np.cos(phi) * (M1 * A1 + M2 * s + M3 * r),
            -G * np.sin(phi) * (M2 + M3) - K * (s - FREE),
            -G * np.cos(theta) * M3 * A3,
        ]
    )
    return mass, bias, force


def evaluated(motion: Transformation, outputs: list, state, rates=(0, 0, 0)) -> list[np.ndarray]:
    function = ca.Function(
        "f", [motion.y, motion.v, motion.a], [ca.densify(out) for out in outputs]
    )
    return [out.full().squeeze() for out in function.call([*state, rates])]


def test_example_5_1_counts(equations):
    """Nine coordinates, six constraints; the explicit ones satisfy them at every level."""
    assert (equations.coordinate_count, equations.constraint_count) == (9, 6)
    motion = joint_coordinates(equations)
    closed = motion.apply(equations)
    c, xi = (
        motion.seen(equations, x) for x in (equations.jacobian, equations.constraint_acceleration)
    )
    residuals = [
        closed.constraints,
        ca.mtimes(c, motion.basis),
        ca.mtimes(c, motion.gamma) - xi,
    ]
    for state in STATES:
        for residual in evaluated(motion, residuals, state):
            np.testing.assert_allclose(residual, 0, atol=1e-14)


@pytest.mark.parametrize("state", STATES)
def test_example_6_1_joint_coordinates(equations, state):
    """M̂, d̂ and f̂ of (6.2)."""
    motion = joint_coordinates(equations)
    reduced = motion.apply(equations).with_rows([])
    computed = evaluated(motion, [reduced.mass, reduced.bias, reduced.force], state)
    for one, other in zip(computed, by_hand(*state), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12)


@pytest.mark.parametrize("derive", [gibbs_appell, kane])
@pytest.mark.parametrize("state", STATES)
def test_example_6_3_gibbs_appell_and_kane(equations, state, derive):
    """The same equations by either road, for any accelerations."""
    motion, rates = joint_coordinates(equations), np.array([0.6, -1.1, 2.3])
    (computed,) = evaluated(motion, [derive(equations, motion)], state, rates)
    mass, bias, force = by_hand(*state)
    np.testing.assert_allclose(computed, mass @ rates + bias - force, atol=1e-12)


@pytest.mark.parametrize("state", STATES)
def test_example_6_3_appell_function(equations, state):
    """S = Σ (m |r̈_C|² + J φ̈²)/2 with the accelerations of the three centres."""
    motion, rates = joint_coordinates(equations), np.array([0.6, -1.1, 2.3])
    (computed,) = evaluated(motion, [appell_function(equations, motion)], state, rates)
    (phi, s, theta), (w, ds, turn) = state
    spin, slide, swing = rates
    e, n = np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
    f, k = np.array([np.cos(theta), np.sin(theta)]), np.array([-np.sin(theta), np.cos(theta)])

    def on_bar(r, moving):
        radial = (slide if moving else 0) - r * w**2
        return radial * e + (r * spin + (2 * ds * w if moving else 0)) * n

    third = on_bar(s + A2, True) + A3 * (swing * k - turn**2 * f)
    squares = [on_bar(A1, False), on_bar(s, True), third]
    expected = sum(m * a @ a for m, a in zip((M1, M2, M3), squares, strict=True)) / 2
    expected += ((J1 + J2) * spin**2 + J3 * swing**2) / 2
    assert computed == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("derive", [gibbs_appell, kane])
def test_independent_speeds_without_coordinates(equations, derive):
    """Quasi-velocities w (6.13c): ṡ, the velocity of A along the hanging bar, and θ̇.

    The equations are Bᵀ times those in joint coordinates at q̈ = B ẇ + Ḃ w.
    """
    joint = joint_coordinates(equations)
    reduced = joint.apply(equations).with_rows([])
    phi, s, theta = ca.vertsplit(joint.y)
    r, delta = s + A2, theta - phi
    # from w = (ṡ, ṡ cos δ + r φ̇ sin δ, θ̇)
    basis = ca.blockcat(
        [[-ca.cos(delta) / (r * ca.sin(delta)), 1 / (r * ca.sin(delta)), 0], [1, 0, 0], [0, 0, 1]]
    )
    motion = speeds_by_basis(reduced, basis, ca.SX.sym("w", 3))
    q, w, rates = STATES[0][0], np.array([0.4, -0.2, 1.1]), np.array([0.6, -1.1, 2.3])
    side, u, a, b = evaluated(
        motion, [derive(reduced, motion), motion.old_v, motion.old_a, basis], (q, w), rates
    )
    mass, bias, force = by_hand(q, u)
    assert u[1] * np.cos(q[2] - q[0]) + (q[1] + A2) * u[0] * np.sin(q[2] - q[0]) == pytest.approx(
        w[1], rel=1e-12
    )
    np.testing.assert_allclose(side, b.T @ (mass @ a + bias - force), atol=1e-12)


def test_relative_and_absolute_joint_angles(equations):
    """Section 6.2.1: from one set of joint coordinates to the other, δ = θ − φ."""
    absolute = joint_coordinates(equations).apply(equations).with_rows([])
    new = ca.SX.sym("q", 3)
    relative = change_coordinates(
        absolute, ca.vertcat(new[0], new[1], new[0] + new[2]), new, ca.SX.sym("u", 3)
    )
    (phi, s, theta), (w, ds, turn) = STATES[0]
    function = ca.Function(
        "f", [relative.y, relative.v], [relative.mass, relative.force - relative.bias]
    )
    mass, force = (out.full() for out in function([phi, s, theta - phi], [w, ds, turn - w]))
    computed = np.linalg.solve(mass, force).ravel()
    mass, bias, force = by_hand(*STATES[0])
    expected = np.linalg.solve(mass, force - bias)
    computed[2] += computed[0]
    np.testing.assert_allclose(computed, expected, rtol=1e-12)
