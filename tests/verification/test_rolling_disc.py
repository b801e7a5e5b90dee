"""A disc that rolls on a plane without slip: exact steady motions, and the classical equations.

Source: J. I. Neimark, N. A. Fufaev, *Dynamics of Nonholonomic Systems*, 1972. With ``e1`` along
the horizontal tangent of the disc, ``e2`` from the contact to the centre and ``e3`` the axle,

    L̇ + r e2 × m (v̇ + g z) = 0,    v = r ω × e2,    L = It ω1 e1 + It ω2 e2 + Ia ω3 e3.

The inclination θ is the angle of the axle from the vertical.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import spatial

MASS, RADIUS, G = 2.0, 0.3, 9.81
ACROSS, AXIAL = MASS * RADIUS**2 / 4, MASS * RADIUS**2 / 2
UP = np.array([0.0, 0.0, 1.0])


def disc(angles, spin) -> da.Model:
    """``angles``: heading, inclination and turn about the axle; ``spin``: ω in (e1, e2, e3)."""
    heading, inclination, turn = angles
    frame = tangent_frame(heading, inclination)
    system = da.System("disc", gravity=(0.0, 0.0, -G))
    body = spatial.Body(
        "disc",
        mass=MASS,
        inertia=(ACROSS, ACROSS, AXIAL),
        position=tuple(RADIUS * frame[:, 1]),
        rotation=da.rotation.euler("zxz", heading, inclination, turn),
        velocity=tuple(RADIUS * np.cross(frame @ spin, frame[:, 1])),
        angular_velocity=tuple(frame @ spin),
    )
    system.add(body)
    rolling = {"radius": RADIUS, "axis": (0, 0, 1)}
    system.add(spatial.RollingDisc("rolling", body, system.ground.frame(), **rolling))
    return system.build()


def tangent_frame(heading, inclination) -> np.ndarray:
    """(3, 3) e1, e2, e3 as columns."""
    c, s, up, level = (
        *(f(heading) for f in (np.cos, np.sin)),
        np.sin(inclination),
        np.cos(inclination),
    )
    return np.array([[c, -s * level, s * up], [s, c * level, -c * up], [0, up, level]])


def classical(state) -> tuple[np.ndarray, np.ndarray]:
    """Rates of (heading, inclination, turn, ω1, ω2, ω3, x, y), and the force of the contact."""
    heading, inclination, _, *spin = state[:6]
    spin, up, level = np.array(spin), np.sin(inclination), np.cos(inclination)
    precession = spin[1] / up
    frame_spin = np.array([spin[0], spin[1], precession * level])
    velocity = RADIUS * np.array([-spin[2], 0, spin[0]])
    momentum = np.array([ACROSS, ACROSS, AXIAL]) * spin
    weight = G * np.array([0, up, level])
    e2 = np.array([0.0, 1.0, 0.0])
    expected = np.cross(frame_spin, velocity) + weight
    right = -np.cross(frame_spin, momentum) - RADIUS * MASS * np.cross(e2, expected)
    rate = right / (np.array([ACROSS, ACROSS, AXIAL]) + MASS * RADIUS**2 * np.array([1, 0, 1]))
    frame = tangent_frame(heading, inclination)
    force = MASS * frame @ (expected + RADIUS * np.array([-rate[2], 0, rate[0]]))
    moved = (frame @ velocity)[:2]
    return np.array([precession, spin[0], spin[2] - precession * level, *rate, *moved]), force


@pytest.mark.parametrize(
    ("inclination", "precession"),
    [(1.2, 1.5), (0.9, -2.5), (0.5, 6.0)],
    ids=["fast", "lean", "flat"],
)
def test_steady_motion(inclination, precession):
    """Constant inclination: ``(Ia + m r²) ω3 Ω sin θ = (It Ω² sin θ − m g r) cos θ``."""
    up, level = np.sin(inclination), np.cos(inclination)
    inertia = AXIAL + MASS * RADIUS**2
    pull = ACROSS * precession**2 * up - MASS * G * RADIUS
    spin = np.array([0.0, precession * up, pull * level / (inertia * precession * up)])
    motion = da.solve_dynamics(
        disc((0.0, inclination, 0.0), spin),
        2.0,
        integrator=da.DormandPrince853(1e-10, 1e-10),
        outputs=21,
    )
    assert motion.status.success
    time, angle = motion.time, precession * motion.time
    circle = RADIUS * spin[2] / precession  # the centre's, about a fixed vertical
    start = motion["disc.position"].values[0]
    expected = start + circle * np.column_stack([-np.sin(angle), np.cos(angle) - 1, 0 * time])
    np.testing.assert_allclose(motion["disc.position"], expected, atol=1e-8)
    axle = motion["disc.rotation"].values.reshape(-1, 3, 3)[:, :, 2]
    np.testing.assert_allclose(axle[:, 2], level, atol=1e-8)
    inward = MASS * circle * precession**2 * np.column_stack([np.sin(angle), -np.cos(angle)])
    np.testing.assert_allclose(motion["rolling.force"][:, :2], inward, atol=1e-6)
    np.testing.assert_allclose(motion["rolling.force"][:, 2], MASS * G, atol=1e-6)


def test_euler_disc_against_the_classical_equations():
    """Place, attitude, contact force and energy of a disc that reels between 37° and 58°."""
    angles, spin = np.array([0.3, 1.0, 0.2]), np.array([0.4, 2.0, -3.0])
    centre = RADIUS * tangent_frame(*angles[:2])[:, 1]
    times = np.linspace(0, 3, 31)
    exact = solve_ivp(
        lambda t, state: classical(state)[0],
        (0, 3),
        [*angles, *spin, *centre[:2]],
        "DOP853",
        times,
        rtol=1e-12,
        atol=1e-12,
    ).y
    motion = da.solve_dynamics(
        disc(angles, spin), 3.0, integrator=da.DormandPrince853(1e-10, 1e-10), outputs=times
    )
    assert motion.status.success
    np.testing.assert_allclose(motion["disc.position"][:, :2], exact[6:].T, atol=1e-7)
    np.testing.assert_allclose(motion["disc.z"], RADIUS * np.sin(exact[1]), atol=1e-7)
    axle = motion["disc.rotation"].values.reshape(-1, 3, 3)[:, :, 2]
    expected = [tangent_frame(*state[:2])[:, 2] for state in exact.T]
    np.testing.assert_allclose(axle, expected, atol=1e-7)
    forces = [classical(state)[1] for state in exact.T]
    np.testing.assert_allclose(motion["rolling.force"], forces, atol=1e-5)
    np.testing.assert_allclose(motion["energy"] - motion["energy"][0], 0.0, atol=1e-7)
    assert np.ptp(exact[1]) > 0.3
    assert float(motion["velocity_violation"].max()) < 1e-11
