"""Examples 4.1 to 4.5 of the book, each against its formulas written out by hand.

Source: *Advanced Design of Mechanical Systems: From Analysis to Optimization*, CISM 511, Chapter 4.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.inertia import BlockInertia
from dalembert.model.graph.transformation import change_coordinates, change_speeds, coordinates_by

G = 9.81


def evaluated(e: Equations, outputs: list, y, v, p=()) -> list[np.ndarray]:
    function = ca.Function("f", [e.y, e.v, e.p], [ca.densify(out) for out in outputs])
    return [out.full().squeeze() for out in function.call([y, v, p])]


# 4.1 particle in spherical coordinates -------------------------------------------------------
def particle(mass: float, force: ca.SX, y: ca.SX) -> Equations:
    """``m r̈ = F`` in Cartesian coordinates; v = ẏ, no constraints."""
    v, a = ca.SX.sym("v", 3), ca.SX.sym("a", 3)
    none, zero = ca.SX(0, 1), ca.SX.zeros(3)
    return Equations(
        t=ca.SX.sym("t"),
        y=y,
        v=v,
        p=none,
        a=a,
        multiplier=none,
        pose_rate=v,
        inertia=BlockInertia(mass * ca.SX.eye(3)),
        bias=zero,
        force=force,
        constraints=none,
        potential=ca.SX(0),
        powers=ca.SX.zeros(2),
    )


def test_example_4_1_particle_in_spherical_coordinates():
    """r, θ from the z axis, φ around it: M' diagonal, d' of the textbook, f' along the axes."""
    m, force, position = 1.7, np.array([0.3, -1.2, 0.8]), ca.SX.sym("x", 3)
    q = ca.SX.sym("q", 3)
    r, polar, around = ca.vertsplit(q)
    cartesian = r * ca.vertcat(
        ca.sin(polar) * ca.cos(around), ca.sin(polar) * ca.sin(around), ca.cos(polar)
    )
    e = change_coordinates(particle(m, ca.SX(ca.DM(force)), position), cartesian, q)
    r, th, ph = y = np.array([1.3, 0.8, 2.1])
    dr, dth, dph = v = np.array([0.4, -0.9, 1.6])
    mass, bias, applied = evaluated(e, [e.mass, e.bias, e.force], y, v)
    s, c = np.sin(th), np.cos(th)
    np.testing.assert_allclose(mass, m * np.diag([1, r**2, (r * s) ** 2]), atol=1e-13)
    expected = m * np.array(
        [
            -r * (dth**2 + (dph * s) ** 2),
            2 * r * dr * dth - r**2 * dph**2 * s * c,
            2 * r * s * dph * (dr * s + r * dth * c),
        ]
    )
    np.testing.assert_allclose(bias, expected, atol=1e-13)
    along = np.array([s * np.cos(ph), s * np.sin(ph), c])
    down = np.array([c * np.cos(ph), c * np.sin(ph), -s])
    side = np.array([-np.sin(ph), np.cos(ph), 0])
    expected = [force @ along, r * force @ down, r * s * force @ side]
    np.testing.assert_allclose(applied, expected, atol=1e-13)


# 4.2 planar body in a frame fixed to it at A ---------------------------------------------------
def test_example_4_2_body_about_a_point_that_is_not_its_centre():
    """v' = (v_Aξ, v_Aη, ω): quasi-velocities, a full mass matrix, and moments about A."""
    m, inertia, xi, eta = 2.3, 0.7, 0.4, -0.15  # C lies at (ξ, η) of the frame in A
    fx, fy, moment = 1.1, -0.6, 0.25
    system = da.System("body")
    body = system.add(planar.Body("body", mass=m, inertia=inertia, position=(0, 0), angle=0))
    system.add(planar.Force("push", body.center, (fx, fy)))
    system.add(planar.Torque("turn", body, moment))
    old = system.build().equations
    c, s = ca.cos(old.y[2]), ca.sin(old.y[2])
    basis = ca.blockcat(
        [[c, -s, -xi * s - eta * c], [s, c, xi * c - eta * s], [0, 0, 1]]  # v_C = v_A + ω × ρ
    )
    e = change_speeds(old, basis, ca.SX.sym("u", 3))
    y, v = np.array([0.3, 0.9, 0.6]), np.array([0.8, -0.5, 1.9])
    mass, bias, force, pose_rate = evaluated(e, [e.mass, e.bias, e.force, e.pose_rate], y, v)
    about_a = inertia + m * (xi**2 + eta**2)
    expected = [[m, 0, -m * eta], [0, m, m * xi], [-m * eta, m * xi, about_a]]
    np.testing.assert_allclose(mass, expected, atol=1e-14)
    va, vb, w = v
    expected = [
        -m * w * (vb + xi * w),
        m * w * (va - eta * w),
        m * w * (xi * va + eta * vb),
    ]
    np.testing.assert_allclose(bias, expected, atol=1e-14)
    c, s = np.cos(y[2]), np.sin(y[2])
    along, across = fx * c + fy * s, -fx * s + fy * c
    np.testing.assert_allclose(
        force, [along, across, moment + xi * across - eta * along], atol=1e-14
    )
    centre = [va - eta * w, vb + xi * w]  # velocity of C in the body's axes
    np.testing.assert_allclose(
        pose_rate, [c * centre[0] - s * centre[1], s * centre[0] + c * centre[1], w], atol=1e-14
    )


# 4.3 and 4.5 slider and link ---------------------------------------------------------------------
M1, M2, J1, J2 = 1.4, 0.9, 0.05, 0.03
A1, B1, A2 = 0.1, 0.15, 0.3  # A C1, C1 B, B C2


@pytest.fixture(scope="module")
def slider_and_link() -> da.Model:
    system = da.System("slider-and-link", gravity=(0.0, -G))
    slider = system.add(
        planar.Body("slider", mass=M1, inertia=J1, position=(0.3, 0), angle=0, velocity=(0.5, 0))
    )
    link = system.add(planar.Body("link", mass=M2, inertia=J2, angle=-0.7, angular_velocity=2.0))
    system.add(planar.Prismatic("A", system.ground.center, slider.point(-A1, 0)))
    system.add(planar.Revolute("B", slider.point(B1, 0), link.point(-A2, 0)))
    return system.build()


def test_example_4_3_implicit_constraints(slider_and_link):
    """Φ, C and ξ at a position that need not satisfy them."""
    e = slider_and_link.equations
    x1, y1, th1, x2, y2, th2 = y = np.array([0.2, 0.05, 0.1, 0.7, -0.3, -0.8])
    v = np.array([0.3, -0.4, 0.5, 0.6, 0.7, -1.8])
    phi, c, xi = evaluated(e, [e.constraints, e.jacobian, e.constraint_acceleration], y, v)
    s1, c1, s2, c2 = np.sin(th1), np.cos(th1), np.sin(th2), np.cos(th2)
    expected = [
        y1 - A1 * s1,
        th1,
        x2 - A2 * c2 - x1 - B1 * c1,
        y2 - A2 * s2 - y1 - B1 * s1,
    ]
    np.testing.assert_allclose(phi, expected, atol=1e-15)
    expected = [
        [0, 1, -A1 * c1, 0, 0, 0],
        [0, 0, 1, 0, 0, 0],
        [-1, 0, B1 * s1, 1, 0, A2 * s2],
        [0, -1, -B1 * c1, 0, 1, -A2 * c2],
    ]
    np.testing.assert_allclose(c, expected, atol=1e-15)
    w1, w2 = v[2] ** 2, v[5] ** 2
    expected = [-A1 * s1 * w1, 0, -B1 * c1 * w1 - A2 * c2 * w2, -B1 * s1 * w1 - A2 * s2 * w2]
    np.testing.assert_allclose(xi, expected, atol=1e-14)


def explicit(e: Equations):
    """``y = g(q)`` with q = (s, φ): A on the guide, angle of the link."""
    q = ca.SX.sym("q", 2)
    s, angle = ca.vertsplit(q)
    b = s + A1 + B1
    g = ca.vertcat(s + A1, 0, 0, b + A2 * ca.cos(angle), A2 * ca.sin(angle), angle)
    return coordinates_by(e, g, q)


def test_example_4_3_explicit_constraints(slider_and_link):
    """Φ(g(q)) = 0, the D and γ of the book, C D = 0 (4.18) and C γ = ξ (4.19)."""
    e = slider_and_link.equations
    motion = explicit(e)
    reduced = motion.apply(e)
    angle, rate = -0.7, 1.3
    y, v = np.array([0.4, angle]), np.array([-0.6, rate])
    s, c = np.sin(angle), np.cos(angle)
    d, gamma, phi, jacobian, xi = evaluated(
        reduced,
        [
            motion.basis,
            motion.gamma,
            reduced.constraints,
            motion.seen(e, e.jacobian),
            motion.seen(e, e.constraint_acceleration),
        ],
        y,
        v,
    )
    expected = [[1, 0], [0, 0], [0, 0], [1, -A2 * s], [0, A2 * c], [0, 1]]
    np.testing.assert_allclose(d, expected, atol=1e-15)
    expected = [0, 0, 0, -A2 * c * rate**2, -A2 * s * rate**2, 0]
    np.testing.assert_allclose(gamma, expected, atol=1e-15)
    np.testing.assert_allclose(phi, 0, atol=1e-15)
    np.testing.assert_allclose(jacobian @ d, 0, atol=1e-15)
    np.testing.assert_allclose(jacobian @ gamma, xi, atol=1e-15)


def by_hand(angle: float, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Lagrange's equations in (s, φ), then Newton's for each body: q̈ and the four reactions."""
    s, c = np.sin(angle), np.cos(angle)
    mass = [[M1 + M2, -M2 * A2 * s], [-M2 * A2 * s, J2 + M2 * A2**2]]
    ds, dw = np.linalg.solve(mass, [M2 * A2 * c * rate**2, -M2 * G * A2 * c])
    ax, ay = ds - A2 * (s * dw + c * rate**2), A2 * (c * dw - s * rate**2)
    pull, weight = -M2 * ax, -M2 * (G + ay)  # reaction on the link is −λ3, −λ4
    guide = weight - M1 * G
    return np.array([ds, dw]), np.array([guide, A1 * guide + B1 * weight, pull, weight])


def test_example_4_5_reactions_are_forces_and_a_moment(slider_and_link):
    """λ = (guide force, guide moment, two pin forces); r = Cᵀλ as the book expands it."""
    e, start = slider_and_link.equations, slider_and_link.start
    solved = da.KKT().acceleration(e, e.constraint_acceleration).function
    state = np.concatenate([start.y, start.v, [0, 0]])
    a, multiplier = (out.full().ravel() for out in solved(0.0, state, slider_and_link.nominal))
    rates, (l1, l2, l3, l4) = by_hand(start.y[5], start.v[5])
    np.testing.assert_allclose(a[[0, 5]], rates, atol=1e-12)
    np.testing.assert_allclose(multiplier, [l1, l2, l3, l4], atol=1e-12)
    (jacobian,) = evaluated(e, [e.jacobian], start.y, start.v)
    s, c = np.sin(start.y[5]), np.cos(start.y[5])
    expected = [-l3, l1 - l4, -A1 * l1 + l2 - B1 * l4, l3, l4, A2 * (s * l3 - c * l4)]
    np.testing.assert_allclose(jacobian.T @ multiplier, expected, atol=1e-12)


def test_example_4_3_joint_coordinates_move_as_absolute_ones(slider_and_link):
    """The projected equations (6.2) are Lagrange's."""
    e = slider_and_link.equations
    reduced = explicit(e).apply(e).with_rows([])
    for angle, rate in ((-0.7, 1.3), (0.4, -2.0), (2.2, 0.6)):
        mass, force = evaluated(
            reduced, [reduced.mass, reduced.force - reduced.bias], [0.4, angle], [-0.6, rate]
        )
        np.testing.assert_allclose(
            np.linalg.solve(mass, force), by_hand(angle, rate)[0], rtol=1e-12
        )


# 4.4 pendulum, physical and unphysical ---------------------------------------------------------
LENGTH, MASS = 0.8, 1.5


def pendulum(constrain) -> np.ndarray:
    """Multiplier at an angle of 0.5 rad from the vertical, at 3 rad/s."""
    system = da.System("pendulum", gravity=(0.0, -G))
    s, c = np.sin(0.5), np.cos(0.5)
    bob = system.add(
        planar.Particle(
            "bob",
            mass=MASS,
            position=(LENGTH * s, -LENGTH * c),
            velocity=(3 * LENGTH * c, 3 * LENGTH * s),
        )
    )
    constrain(system, bob)
    model = system.build()
    e = model.equations
    solved = da.KKT().acceleration(e, e.constraint_acceleration).function
    state = np.concatenate([model.start.y, model.start.v, [0, 0]])
    return solved(0.0, state, model.nominal)[1].full().ravel()


def test_example_4_4_physical_and_unphysical_multipliers():
    """λ of ``√(x² + y²) − l`` is the tension in newtons; ``x² + y² − l²`` gives λ/(2l)."""

    def link(system, bob):
        anchor = system.ground.center
        system.add(planar.RigidLink("link", anchor, bob.center, length=LENGTH))

    def physical(system, bob):
        length = da.sqrt(bob.x**2 + bob.y**2)
        system.add(planar.UserConstraint("link", length - LENGTH))

    def unphysical(system, bob):
        system.add(planar.UserConstraint("link", bob.x**2 + bob.y**2 - LENGTH**2))

    tension = MASS * (G * np.cos(0.5) + LENGTH * 3**2)  # positive: it pulls, as (4.22) signs it
    assert pendulum(link) == pytest.approx(tension, rel=1e-13)
    assert pendulum(physical) == pytest.approx(tension, rel=1e-13)
    assert pendulum(unphysical) == pytest.approx(tension / (2 * LENGTH), rel=1e-13)
