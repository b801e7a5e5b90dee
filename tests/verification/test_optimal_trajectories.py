"""Trajectories whose optimum is known: closed forms, and a published swing-up solved another way.

Block and cart with pole: M. Kelly, *An introduction to trajectory optimization*, SIAM Review 59
(2017), sections 3 and 6, with the parameters of its table; shortest time by bang and bang, and the
cycloid of Bernoulli; rest to rest with the least torque, ``∫τ² = 12 I² φ²/T³``.
"""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar, spatial

G = 9.81


def block(bound: float) -> da.Model:
    system = da.System("block")
    push = system.parameter("push", 0.0, "N", bounds=(-bound, bound))
    mass = system.add(planar.Particle("block", mass=1.0, position=(0, 0)))
    system.add(planar.CoordinateDriver("rail", mass.center, 0.0, direction=(0, 1)))
    system.add(planar.Force("force", mass.center, (push, 0.0)))
    return system.build()


def few(intervals: int) -> da.DirectCollocation:
    return da.DirectCollocation(intervals=intervals)


def shooting(intervals: int) -> da.MultipleShooting:
    return da.MultipleShooting(intervals=intervals, steps=2)


both = pytest.mark.parametrize("method", [few, shooting])
"""Both ways to make a programme of a motion come to the same."""


@pytest.mark.few(1)
@both
def test_block_with_least_force(method):
    """``u = 6 − 12 t``, cost 12."""
    best = da.optimize_trajectory(
        block(50.0),
        da.integral("push**2"),
        ["push"],
        1.0,
        end={"block.x": 1.0, "block.vx": 0.0},
        method=method(10),
    )
    assert best.success and best.fun == pytest.approx(12.0, rel=1e-9)
    push = best.control("push")
    np.testing.assert_allclose(push.values, 6 - 12 * push.times, atol=1e-7)
    assert best.deviation < 1e-9 and best.defect < 1e-9


@pytest.mark.few(1)
@both
def test_block_in_the_shortest_time(method):
    """Full thrust, then full brake: ``T = 2 √(d/a)``."""
    best = da.optimize_trajectory(
        block(2.0),
        da.final("time"),
        ["push"],
        (0.1, 10.0),
        end={"block.x": 3.0, "block.vx": 0.0},
        method=method(20),
    )
    assert best.success and best.duration == pytest.approx(2 * math.sqrt(1.5), rel=1e-6)
    push = best.control("push")
    np.testing.assert_allclose(abs(push.values[push.times != push.times[20]]), 2.0, atol=1e-4)


def test_block_with_the_smallest_peak():
    """The same the other way round: ``4 d/T²`` all the time, forwards and backwards."""
    best = da.optimize_trajectory(
        block(50.0),
        da.maximum("push**2"),
        ["push"],
        1.0,
        end={"block.x": 1.0, "block.vx": 0.0},
        method=few(20),
    )
    assert best.success and best.fun == pytest.approx(16.0, rel=1e-6)


def test_brachistochrone():
    """A wire that pushes square to the path by ``m w v``: on a cycloid ``w = √(g/R)``.

    The control enters linearly, so that its square gets a small price, which the time pays.
    """
    system = da.System("bead", gravity=(0.0, -G))
    turn = system.parameter("turn", 1.0, "rad/s", bounds=(0.0, 20.0))
    bead = system.add(planar.Particle("bead", mass=1.0, position=(0, 0)))
    v = bead.center.velocity
    system.add(planar.Force("wire", bead.center, (-turn * v.y, turn * v.x)))
    first, last, rate = 0.5, 2.5, math.sqrt(G)

    def at(phi: float) -> dict[str, float]:
        return {"bead.x": phi - math.sin(phi), "bead.y": math.cos(phi) - 1}

    speed = {"bead.vx": rate * (1 - math.cos(first)), "bead.vy": -rate * math.sin(first)}
    best = da.optimize_trajectory(
        system.build(),
        da.combined("T + W", T=da.final("time"), W=da.integral("1e-3*turn**2")),
        ["turn"],
        (0.2, 3.0),
        begin=at(first) | speed,
        end=at(last),
        method=few(20),
    )
    assert best.success
    shortest = (last - first) / rate
    assert shortest < best.duration < shortest * 1.0003
    assert best.fun < (1 + 1e-3 * rate**2) * shortest  # what the cycloid itself would cost


def cart_and_pole() -> da.Model:
    system = da.System("cart and pole", gravity=(0.0, -G))
    push = system.parameter("push", 0.0, "N", bounds=(-20.0, 20.0))
    cart = system.add(planar.Body("cart", mass=1.0, inertia=0.1, position=(0, 0), angle=0))
    pole = system.add(planar.Body("pole", mass=0.3, inertia=0.0, position=(0, -0.5), angle=0))
    system.add(planar.Prismatic("rail", system.ground.point(0, 0), cart.center))
    system.add(planar.Revolute("pivot", cart.center, pole.point(0, 0.5)))
    system.add(planar.Force("force", cart.center, (push, 0.0)))
    return system.build()


def kelly(x, u):
    """The paper's equations (6.1) and (6.2), in cart position and angle of the pole."""
    _, q, v, w = (x[k] for k in range(4))
    m1, m2, length = 1.0, 0.3, 0.5
    sine, cosine = ca.sin(q), ca.cos(q)
    inner = m1 + m2 * (1 - cosine**2)
    cart = (length * m2 * sine * w**2 + u + m2 * G * cosine * sine) / inner
    pole = -(length * m2 * cosine * sine * w**2 + u * cosine + (m1 + m2) * G * sine)
    return ca.vertcat(v, w, cart, pole / (length * inner))


def kelly_by_radau(intervals: int = 30, degree: int = 4) -> float:
    """The least ``∫u²`` by Radau collocation of degree four, u a cubic in each interval."""
    tau = ca.collocation_points(degree, "radau")
    c, d, b = ca.collocation_coeff(tau)
    h, opti, cost = 2.0 / intervals, ca.Opti(), 0
    x = opti.variable(4)
    opti.subject_to(x == 0)
    for k in range(intervals):
        inner, u = opti.variable(4, degree), opti.variable(1, degree)
        rates = ca.horzcat(*(kelly(inner[:, j], u[j]) for j in range(degree)))
        opti.subject_to(ca.mtimes(ca.horzcat(x, inner), c) == h * rates)
        opti.subject_to(opti.bounded(-20, u, 20))
        opti.set_initial(inner[1, :], math.pi * (k + 0.5) / intervals)
        cost += h * ca.mtimes(u**2, b)
        x = opti.variable(4)
        opti.subject_to(x == ca.mtimes(ca.horzcat(inner[:, 0] * 0, inner), d))
    opti.subject_to(x == ca.vertcat(1.0, math.pi, 0.0, 0.0))
    opti.minimize(cost)
    opti.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes"})
    return float(opti.solve().value(cost))


@pytest.mark.thorough
@both
def test_swing_up_of_a_pole_on_a_cart(method):
    best = da.optimize_trajectory(
        cart_and_pole(),
        da.integral("push**2"),
        ["push"],
        2.0,
        end={"cart.x": 1.0, "pole.angle": math.pi, "cart.vx": 0.0, "pole.angular_velocity": 0.0},
        subject_to=[
            da.Limit(da.maximum("cart.x"), upper=2.0),
            da.Limit(da.minimum("cart.x"), lower=-2.0),
        ],
        method=method(50),
    )
    assert best.success and best.status.residual < 1e-6
    assert best.fun == pytest.approx(kelly_by_radau(), rel=1e-4)
    push = best.control("push")
    rates = ca.Function("rates", [(x := ca.SX.sym("x", 4)), (u := ca.SX.sym("u"))], [kelly(x, u)])
    run = solve_ivp(
        lambda t, x: np.array(rates(x, push(t))).ravel(), (0, 2), np.zeros(4), rtol=1e-9, atol=1e-9
    )
    np.testing.assert_allclose(run.y[:, -1], [1.0, math.pi, 0.0, 0.0], atol=0.02)
    assert best.deviation < 0.01 and best.defect < 1e-4


def parallelogram() -> da.Model:
    """Crank and rocker of one length: the reduced inertia is constant, a closed loop or not."""
    system = da.System("parallelogram")
    torque = system.parameter("torque", 0.0, "N m", bounds=(-200.0, 200.0))
    arm = system.parameter("arm", 0.4, "m", bounds=(0.1, 0.8))
    crank = system.add(planar.Bar("crank", length=arm, mass=1.0, angle=0.5))
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=2.0, angle=0.0))
    rocker = system.add(planar.Bar("rocker", length=arm, mass=1.5, angle=0.5))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    system.add(planar.Torque("motor", crank, torque))
    return system.build()


REST = {"crank.angle": 2.0, "crank.angular_velocity": 0.0}


@pytest.mark.thorough
@both
def test_a_closed_loop_from_rest_to_rest(method):
    inertia = 0.4**2 * (1.0 / 3 + 1.5 / 3 + 2.0)
    best = da.optimize_trajectory(
        parallelogram(), da.integral("torque**2"), ["torque"], 1.0, end=REST, method=method(20)
    )
    assert best.success and best.fun == pytest.approx(12 * inertia**2 * 1.5**2, rel=1e-5)
    assert best.planned.data["position_violation"].max() < 1e-6
    assert best.deviation < 1e-5 and best.motion.status.success


@pytest.mark.few(1)
@both
def test_control_and_design_at_once(method):
    """``A l⁴ + c/l`` is least where ``l⁵ = c/4A``."""
    factor, price = 12 * (1.0 / 3 + 1.5 / 3 + 2.0) ** 2 * 1.5**2, 10.0
    best = da.optimize_trajectory(
        parallelogram(),
        da.combined("E + 10/l", E=da.integral("torque**2"), l=da.final("arm")),
        ["torque"],
        1.0,
        end=REST,
        vary=["arm"],
        method=method(20),
    )
    assert best.success and best.x["arm"] == pytest.approx((price / 4 / factor) ** 0.2, rel=1e-5)


@pytest.mark.few(1)
@both
def test_a_satellite_turned_in_space(method):
    """Euler parameters stay of length one: a turn about a principal axis."""
    system = da.System("satellite", gravity=(0.0, 0.0, 0.0))
    torques = [system.parameter(f"t{k}", 0.0, "N m", bounds=(-50.0, 50.0)) for k in "xyz"]
    body = system.add(spatial.Body("body", mass=3.0, inertia=(1.0, 2.0, 3.0), position=(0, 0, 0)))
    body.add_point("tip", (1, 0, 0))
    body.add_point("side", (0, 1, 0))
    system.add(spatial.Torque("wheels", body, tuple(torques)))
    best = da.optimize_trajectory(
        system.build(),
        da.integral("tx**2 + ty**2 + tz**2"),
        ["tx", "ty", "tz"],
        1.0,
        end={"body.tip.y": math.sin(1.2), "body.tip.z": 0.0, "body.side.z": 0.0}
        | {f"body.angular_velocity.{k}": 0.0 for k in "xyz"},
        method=method(16),
    )
    assert best.success and best.fun == pytest.approx(12 * 3.0**2 * 1.2**2, rel=1e-5)
    assert best.deviation < 1e-5
