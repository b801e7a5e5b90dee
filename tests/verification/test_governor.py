"""Centrifugal governor that spins freely: two arms with balls, links and a sleeve on the spindle.

Source: J. C. Maxwell, *On Governors*, 1868, and textbooks of mechanics: two freedoms, the spindle
and the angle β of the arms. The angular momentum p about the spindle is kept, so that with
``J(β) ψ̇ = p`` one equation is left, of ``a(β) β̇²/2 + p²/2J(β) + V(β)``, Routh's. Its steady
motion and small oscillation are compared with ``linearize`` in joint coordinates, too.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import spatial

G, ARM, LINK, BALL, SLEEVE, SHAFT, ROUND = 9.81, 0.25, 0.15, 0.6, 0.9, 0.004, 0.001
UP, ASIDE = (0, 0, 1), (0, 1, 0)


def governor(angle: float, spin: float, opening: float = 0.0) -> da.Model:
    """Links as long as the upper part of the arms; β and its rate, and the rate of the spindle."""
    system = da.System("governor", gravity=(0.0, 0.0, -G))

    def body(name, mass, inertia, place, turn=0.0, turning=0.0, **more):
        axes = da.rotation.axis_angle(ASIDE, turn)
        spinning = {"angular_velocity": (0, turning, spin)}
        body = spatial.Body(
            name, mass=mass, inertia=inertia, position=place, rotation=axes, **spinning, **more
        )
        return system.add(body)

    spindle = body("spindle", 1.0, (0.01, 0.01, SHAFT), (0, 0, 0))
    sleeve = body("sleeve", SLEEVE, (ROUND,) * 3, (0, 0, -2 * LINK * np.cos(angle)))
    shaft, guide = (one.frame(axis=UP, x=(1, 0, 0)) for one in (spindle, sleeve))
    system.add(spatial.Revolute("shaft", system.ground.frame(axis=UP, x=(1, 0, 0)), shaft))
    system.add(spatial.Prismatic("guide", shaft, guide))
    for name, side in (("left", -1), ("right", 1)):
        arm = body(
            name, BALL, (ROUND,) * 3, (0, 0, 0), -side * angle, -side * opening,
            center_of_mass=(0, 0, -ARM), points={"middle": (0, 0, -LINK)},
        )  # fmt: skip
        hinge = (one.frame(axis=ASIDE, x=(1, 0, 0)) for one in (spindle, arm))
        system.add(spatial.Revolute(f"{name}_hinge", *hinge))
        link = (arm.points["middle"], sleeve.center)
        system.add(spatial.RigidLink(f"{name}_link", *link, length=LINK))
    return system.build()


BETA, RATE, P = ca.SX.sym("beta"), ca.SX.sym("rate"), ca.SX.sym("p")
DRAG = 2 * (BALL * ARM**2 + ROUND) + SLEEVE * (2 * LINK * ca.sin(BETA)) ** 2
ABOUT = SHAFT + 3 * ROUND + 2 * BALL * (ARM * ca.sin(BETA)) ** 2
POTENTIAL = -G * (2 * BALL * ARM + 2 * SLEEVE * LINK) * ca.cos(BETA) + P**2 / (2 * ABOUT)
FORCE = -ca.gradient(POTENTIAL, BETA) - ca.gradient(DRAG, BETA) * RATE**2 / 2
OPENING = ca.Function("opening", [BETA, RATE, P], [FORCE / DRAG])
SIZES = ca.Function("sizes", [BETA], [ABOUT])


def test_motion_by_the_one_equation():
    angle, spin, opening, times = 0.5, 9.0, 2.0, np.linspace(0, 3, 31)
    momentum = float(SIZES(angle)) * spin
    exact = solve_ivp(
        lambda t, s: [s[1], float(OPENING(s[0], s[1], momentum))],
        (0, 3), [angle, opening], "DOP853", times, rtol=1e-11, atol=1e-12,
    ).y[0]  # fmt: skip
    motion = da.solve_dynamics(
        governor(angle, spin, opening), 3.0, integrator=da.DormandPrince(1e-9, 1e-9), outputs=times
    )
    assert motion.status.success
    np.testing.assert_allclose(motion["sleeve.z"], -2 * LINK * np.cos(exact), atol=1e-7)
    speed = momentum / SIZES(exact[None]).full().ravel()
    np.testing.assert_allclose(motion["spindle.angular_velocity.z"], speed, atol=1e-5)
    assert np.ptp(exact) > 0.2


def test_small_oscillation_about_the_steady_motion():
    angle = 0.7
    spin = np.sqrt(G * (BALL * ARM + SLEEVE * LINK) / (BALL * ARM**2 * np.cos(angle)))
    momentum = float(SIZES(angle)) * spin
    assert abs(float(OPENING(angle, 0, momentum))) < 1e-12
    stiffness = ca.Function("k", [BETA, RATE, P], [ca.gradient(FORCE / DRAG, BETA)])
    frequency = np.sqrt(-float(stiffness(angle, 0, momentum)))
    modes = da.linearize(
        governor(angle, spin), equilibrium=False, coordinates=da.JointCoordinates()
    )
    (computed,) = [z for z in modes.eigenvalues if z.imag > 1e-3]
    assert computed == pytest.approx(1j * frequency, abs=1e-9 * frequency)
