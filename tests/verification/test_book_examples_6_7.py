"""Examples 6.1, 6.4 and 7.2: joint coordinates against equations written by hand.

Source: *Advanced Design of Mechanical Systems: From Analysis to Optimization*, CISM 511, Chapters 6
and 7. Angles are measured from the x axis. Geometry and state are general, numbers are our own but
for the lengths of Example 6.2/6.4, a = 2, b = 1, l1 = 0.8, l2 = 1, l3 = 0.5 m.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from test_book_three_bodies import (
    A1,
    A2 as TO_PIN,
    A3 as TO_ROD,
    FREE,
    J1,
    J2,
    J3,
    M1,
    M2,
    M3,
    STATES,
    G,
    K,
    by_hand,
)

import dalembert as da
from dalembert import planar
from dalembert.model.graph.tree.joint_view import JointView

ABSOLUTE = da.JointCoordinates(angles="absolute")


def evaluated(view: JointView, outputs: list, q, u, a=None, multiplier=None) -> list[np.ndarray]:
    """Expressions of ``q, q̇, q̈, λ_II`` at a state."""
    e = view.equations
    function = ca.Function("f", [e.t, e.y, e.v, e.a, e.multiplier, e.p], outputs)
    values = [
        np.zeros(x.numel()) if v is None else v
        for x, v in zip((e.a, e.multiplier), (a, multiplier), strict=True)
    ]
    return [x.full().squeeze() for x in function.call([0.0, q, u, *values, view.model.nominal])]


def direction(angle) -> np.ndarray:
    return np.array([np.cos(angle), np.sin(angle)])


def normal(angle) -> np.ndarray:
    return np.array([-np.sin(angle), np.cos(angle)])


# 6.1 ------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def three_bodies() -> JointView:
    system = da.System("three bodies", gravity=(0.0, -G))
    bar = system.add(planar.Body("bar", mass=M1, inertia=J1, angle=0.3))
    slider = system.add(planar.Body("slider", mass=M2, inertia=J2, position=(0.5, 0.2)))
    rod = system.add(planar.Body("rod", mass=M3, inertia=J3, angle=-1.2))
    pin = system.ground.center
    system.add(planar.Revolute("O", pin, bar.point(-A1, 0)))
    system.add(planar.Prismatic("guide", bar.point(-A1, 0), slider.center))
    system.add(planar.Revolute("A", slider.point(TO_PIN, 0), rod.point(-TO_ROD, 0)))
    system.add(planar.Spring("spring", pin, slider.center, stiffness=K, free_length=FREE))
    return ABSOLUTE.view(system.build())


@pytest.mark.parametrize("state", STATES)
def test_example_6_1(three_bodies, state):
    """M̄, d̄ and f̄ of (6.2); the library finds q = (φ, s, θ) itself."""
    e = three_bodies.equations
    assert three_bodies.names == ["bar.angle", "guide.displacement", "rod.angle"]
    assert e.constraint_count == 0
    computed = evaluated(three_bodies, [e.mass, e.bias, e.force], *state)
    for one, other in zip(computed, by_hand(*state), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12)


# 6.4 ------------------------------------------------------------------------------------------

A, B, L1, L2, L3 = 2.0, 1.0, 0.8, 1.0, 0.5
MASS, C2, C3, STIFF, RELAXED = (1.5, 0.9, 0.6), 0.5 * L2, 0.5 * L3, 40.0, 1.1
INERTIA = (0.1, 0.075, 0.0125)


@pytest.fixture(scope="module")
def mechanism() -> JointView:
    system = da.System("slider, link and crank", gravity=(0.0, -G))
    slider = system.add(
        planar.Body("slider", mass=MASS[0], inertia=INERTIA[0], position=(1.4, L1 / 2), angle=0.0)
    )
    link = system.add(planar.Bar("link", length=L2, mass=MASS[1], inertia=INERTIA[1], angle=0.6))
    crank = system.add(
        planar.Bar(
            "crank", length=L3, mass=MASS[2], inertia=INERTIA[2], angle=0.9, angular_velocity=1.3
        )
    )
    foot = slider.point(0, -L1 / 2)
    system.add(planar.Prismatic("A", system.ground.center, foot))
    system.add(planar.Revolute("B", slider.point(0, L1 / 2), link.start))
    system.add(planar.Revolute("D", link.end, crank.end))
    system.add(planar.Revolute("E", system.ground.point(A, B), crank.start))
    system.add(
        planar.Spring("spring", system.ground.center, foot, stiffness=STIFF, free_length=RELAXED)
    )
    return da.JointCoordinates(cut=("D",), angles="absolute").view(system.build())


def loop(theta3: float, omega3: float) -> tuple[np.ndarray, ...]:
    """q, q̇, C_II and ξ_II for a position and speed of the crank, ordered (s, θ2, θ3)."""
    theta2 = np.arcsin((B + L3 * np.sin(theta3) - L1) / L2)
    q = np.array([A + L3 * np.cos(theta3) - L2 * np.cos(theta2), theta2, theta3])
    c = np.array(
        [
            [1.0, -L2 * np.sin(theta2), L3 * np.sin(theta3)],
            [0.0, L2 * np.cos(theta2), -L3 * np.cos(theta3)],
        ]
    )
    u = np.append(np.linalg.solve(c[:, :2], -c[:, 2] * omega3), omega3)
    xi = L2 * direction(theta2) * u[1] ** 2 - L3 * direction(theta3) * u[2] ** 2
    return q, u, c, xi


def open_chain(q, u) -> tuple[np.ndarray, ...]:
    """M̄, d̄, f̄ of the chain cut at D."""
    (s, theta2, theta3), m2 = q, MASS[1]
    cross = -m2 * C2 * np.sin(theta2)
    mass = np.array(
        [
            [MASS[0] + m2, cross, 0],
            [cross, INERTIA[1] + m2 * C2**2, 0],
            [0, 0, INERTIA[2] + MASS[2] * C3**2],
        ]
    )
    bias = np.array([-m2 * C2 * np.cos(theta2) * u[1] ** 2, 0, 0])
    force = np.array(
        [
            -STIFF * (s - RELAXED),
            -m2 * G * C2 * np.cos(theta2),
            -MASS[2] * G * C3 * np.cos(theta3),
        ]
    )
    return mass, bias, force


def ordered(view: JointView, wanted: tuple[str, ...]) -> list[int]:
    assert sorted(view.names) == sorted(wanted)
    return [wanted.index(name) for name in view.names]


SLIDER_LINK_CRANK = ("A.displacement", "link.angle", "crank.angle")


@pytest.mark.parametrize("theta3", [0.4, 2.0, 4.4])
def test_example_6_4(mechanism, theta3):
    """M̄, d̄, f̄, C_II and ξ_II of (6.21), and all 8 reactions by both schemes."""
    e, order = mechanism.equations, ordered(mechanism, SLIDER_LINK_CRANK)
    q, u, c, xi = loop(theta3, -2.2)
    mass, bias, force = open_chain(q, u)
    computed = evaluated(
        mechanism,
        [e.constraints, e.mass, e.bias, e.force, e.jacobian, e.constraint_acceleration],
        q[order],
        u[order],
    )
    expected = [np.zeros(2), mass[np.ix_(order, order)], bias[order], force[order]]
    sign = np.sign(computed[4][0, order.index(0)])  # which end of D comes first
    expected += [sign * c[:, order], sign * xi]
    for one, other in zip(computed, expected, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12)
    saddle = np.block([[mass, c.T], [c, np.zeros((2, 2))]])
    solution = np.linalg.solve(saddle, np.concatenate([force - bias, xi]))
    a, multiplier = solution[:3], sign * solution[3:]
    bodies = mechanism.model.all_equations
    balance = bodies.inertia.times(bodies.a) - bodies.force
    balance += ca.mtimes(bodies.jacobian.T, bodies.multiplier)
    for reactions in ("augmented", "projected"):
        view = da.JointCoordinates(("D",), "absolute", reactions).view(mechanism.model)
        (rest,) = evaluated(view, [view.lift(balance)], q[order], u[order], a[order], multiplier)
        np.testing.assert_allclose(rest, 0, atol=1e-11)


def test_figure_6_4(mechanism):
    """det W = l2 cos θ2 of the partition u = θ̇3 never vanishes over a turn of the crank."""
    e, order = mechanism.equations, ordered(mechanism, SLIDER_LINK_CRANK)
    columns = [order.index(0), order.index(1)]
    results = []
    for theta3 in np.linspace(0, 2 * np.pi, 41):
        q, u, _, _ = loop(theta3, 1.0)
        (c,) = evaluated(mechanism, [e.jacobian], q[order], u[order])
        results.append(np.linalg.det(c[:, columns]))
        assert results[-1] == pytest.approx(L2 * np.cos(q[1]), abs=1e-12)
    # largest inclination of the link: crank up, sin θ2 = (1 + 0.5 − 0.8)/1
    assert min(results) == pytest.approx(np.sqrt(1 - 0.7**2), rel=1e-12)


def test_example_6_4_minimal_equation(mechanism):
    """One ODE (6.26) of θ3, partitioned by hand, and its solution by the library."""
    partitioned = da.VelocityPartitioning(independent=("crank.angle",))
    motion = da.solve_dynamics(
        mechanism.model,
        0.6,
        coordinates=da.JointCoordinates(cut=("D",), angles="absolute"),
        formulation=partitioned,
        integrator=da.DormandPrince853(1e-11, 1e-11),
        outputs=7,
    )
    for k in range(motion.time.size):
        theta3, omega3 = (float(motion[f"crank.{x}"][k]) for x in ("angle", "angular_velocity"))
        q, u, c, xi = loop(theta3, omega3)
        mass, bias, force = open_chain(q, u)
        basis = np.append(-np.linalg.solve(c[:, :2], c[:, 2]), 1.0)
        drift = np.append(np.linalg.solve(c[:, :2], xi), 0.0)
        rate = basis @ (force - bias - mass @ drift) / (basis @ mass @ basis)
        assert float(motion["crank.angular_acceleration"][k]) == pytest.approx(rate, rel=1e-8)
        assert float(motion["link.angle"][k]) == pytest.approx(q[1], abs=1e-8)


# 7.2 ------------------------------------------------------------------------------------------

BAR, BLOCK, LOAD = (2.0, 0.15), (0.7, 0.02), 0.9  # mass, inertia
TO_BAR, A_C2, C2_B, STRING = 0.45, 0.12, 0.08, 0.6
SPRING, UNLOADED = 90.0, 0.5
BAR_SLIDER_MASS = ("bar.angle", "guide.displacement", "string.direction")


def hanging(angle=-1.1, length=0.55, swing=-1.9) -> da.Model:
    system = da.System("bar, slider and mass", gravity=(0.0, -G))
    bar = system.add(planar.Body("bar", mass=BAR[0], inertia=BAR[1], angle=angle))
    place = (length + A_C2) * direction(angle)
    slider = system.add(planar.Body("slider", mass=BLOCK[0], inertia=BLOCK[1], position=place))
    end = place + C2_B * direction(angle)
    load = system.add(planar.Particle("load", mass=LOAD, position=end + STRING * direction(swing)))
    start = bar.point(-TO_BAR, 0)
    hook = slider.point(C2_B, 0)
    system.add(planar.Revolute("O", system.ground.center, start))
    system.add(planar.Prismatic("guide", start, slider.point(-A_C2, 0)))
    system.add(planar.RigidLink("string", hook, load.center, length=STRING))
    spring = planar.Spring(
        "spring", start, slider.point(-A_C2, 0), stiffness=SPRING, free_length=UNLOADED
    )
    system.add(spring)
    return system.build()


@pytest.fixture(scope="module")
def suspended() -> JointView:
    return ABSOLUTE.view(hanging())


def augmented(q) -> tuple[np.ndarray, np.ndarray]:
    """D and E of (7.8), y = (x1, y1, φ1, x2, y2, φ2, x3, y3)."""
    theta, s, swing = q
    e, n = direction(theta), normal(theta)
    d, forced = np.zeros((8, 3)), np.zeros((8, 5))
    d[:3, 0] = [*(TO_BAR * n), 1]
    d[3:6, 0] = [*((s + A_C2) * n), 1]
    d[3:5, 1] = d[6:, 1] = e
    d[6:, 0] = (s + A_C2 + C2_B) * n
    d[6:, 2] = STRING * normal(swing)
    for rows in (slice(0, 2), slice(3, 5), slice(6, 8)):
        forced[rows, :2] = np.eye(2)
    forced[3:5, 2] = forced[6:, 2] = n
    forced[3:6, 3] = [*(A_C2 * n), 1]
    forced[6:, 3] = (A_C2 + C2_B) * n
    forced[6:, 4] = direction(swing)
    return d, forced


@pytest.mark.parametrize("q", [(-1.1, 0.55, -1.9), (0.4, 0.3, -0.7)])
def test_example_7_2_matrices(suspended, q):
    """D and E of (7.8) by hand, and C E = I (7.9)."""
    assert suspended.names == list(BAR_SLIDER_MASS)
    e, basis = suspended.model.all_equations, suspended.motion.basis
    (c,) = suspended.moved([e.jacobian])
    computed, forced, c = evaluated(
        suspended,
        [basis.times(ca.SX.eye(3)), basis.opened_times(ca.SX.eye(5)), ca.densify(c)],
        q,
        np.zeros(3),
    )
    d, expected = augmented(q)
    np.testing.assert_allclose(computed, d, atol=1e-14)
    np.testing.assert_allclose(forced, expected, atol=1e-14)
    np.testing.assert_allclose(c @ expected, np.eye(5), atol=1e-14)


def test_example_7_2_reactions(suspended):
    """λ by (7.13) is λ by (6.3), with the matrix C M⁻¹ Cᵀ inverted by NumPy."""
    model, e = suspended.model, suspended.model.all_equations
    q, u = np.array([-1.1, 0.55, -1.9]), np.array([0.8, -0.5, 2.1])
    reduced = suspended.equations
    mass, bias, force = evaluated(suspended, [reduced.mass, reduced.bias, reduced.force], q, u)
    a = np.linalg.solve(mass, force - bias)
    (computed,) = evaluated(suspended, [suspended.lift(e.multiplier)], q, u, a)
    y, v = evaluated(suspended, [suspended.motion.pose, suspended.motion.speed], q, u)
    parts = [e.mass, e.force, e.jacobian, e.constraint_acceleration]
    function = ca.Function("f", [e.t, e.y, e.v, e.p], parts)
    m, f, c, xi = (x.full() for x in function(0.0, y, v, model.nominal))
    inverse = np.linalg.inv(m)
    expected = np.linalg.solve(c @ inverse @ c.T, c @ inverse @ f - xi).ravel()
    np.testing.assert_allclose(computed, expected, rtol=1e-11)


def test_example_7_2_at_rest():
    """Hanging straight down: the string carries the load, the pin everything."""
    down, stretch = -np.pi / 2, (BLOCK[0] + LOAD) * G / SPRING
    view = ABSOLUTE.view(hanging(down, UNLOADED + stretch, down))
    e = view.model.all_equations
    q = np.array([down, UNLOADED + stretch, down])
    rest, multiplier = evaluated(
        view, [view.equations.force, view.lift(e.multiplier)], q, np.zeros(3)
    )
    np.testing.assert_allclose(rest, 0, atol=1e-12)
    weight = (BAR[0] + BLOCK[0] + LOAD) * G
    np.testing.assert_allclose(multiplier, [0, -weight, 0, 0, LOAD * G], atol=1e-12)
