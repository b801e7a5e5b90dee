"""Tyres whose force begins with a kink and, by their damping, with a jump: an arm and a strut.

References are the equations by hand, one set for each side of the switch, integrated by SciPy with
the touch as a terminal event.
"""

from __future__ import annotations

import functools
import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from thorough import crossed

import dalembert as da
from dalembert import planar

GRAVITY, STIFFNESS, DAMPING = 9.81, 1e5, 1000.0
END = 0.8


def tyre(y, vy):
    return da.where(y < 0, -(STIFFNESS * y + DAMPING * vy), 0)


def arm():
    """A body of 20 kg at the end of a pinned arm of 1 m, dropped from 0.3 m."""
    system = da.System("arm", gravity=(0.0, -GRAVITY))
    b = system.add(planar.Body("b", mass=20.0, inertia=1.0, position=(1.0, 0.3)))
    system.add(planar.Revolute("O", system.ground.point(0, 0.3), b.point(-1, 0)))
    system.add(planar.Force("tyre", b.point(0, 0), (0, tyre(b.y, b.vy))))
    return system, ["b.angle"], ["b.angular_velocity"]


def arm_rate(z, touching):
    angle, rate = z
    y, vy = 0.3 + np.sin(angle), np.cos(angle) * rate
    push = -(STIFFNESS * y + DAMPING * vy) if touching else 0.0
    return np.array([rate, (push - 20 * GRAVITY) * np.cos(angle) / 21.0])


LINK, HEIGHT, STRUT = 0.4, 0.5, (6e4, 500.0, 0.55)
"""Length of the suspension link, of the strut's top above its pin, and the strut itself."""


def strut():
    """A quarter of a car that falls on its wheel: chassis, link with the wheel, strut, tyre."""
    system = da.System("strut", gravity=(0.0, -GRAVITY))
    chassis = system.add(planar.Body("chassis", mass=300.0, inertia=10.0, position=(0, 0.3)))
    ground = system.ground.point(0, 0)
    system.add(planar.Prismatic("column", ground, chassis.point(0, 0), axis=(0, 1)))
    wheel = system.add(planar.Body("wheel", mass=30.0, inertia=1.2, position=(LINK, 0.3)))
    system.add(planar.Revolute("pin", chassis.point(0, 0), wheel.point(-LINK, 0)))
    k, c, free = STRUT
    top, hub = chassis.point(0, HEIGHT), wheel.point(0, 0)
    system.add(planar.Spring("strut", top, hub, stiffness=k, damping=c, free_length=free))
    system.add(planar.Force("tyre", hub, (0, tyre(wheel.y, wheel.vy))))
    return system, ["chassis.y", "wheel.angle"], ["chassis.vy", "wheel.angular_velocity"]


def strut_rate(z, touching):
    height, angle, speed, rate = z
    cos, sin = np.cos(angle), np.sin(angle)
    y, vy = height + LINK * sin, speed + LINK * cos * rate
    push = -(STIFFNESS * y + DAMPING * vy) if touching else 0.0
    k, c, free = STRUT
    length = np.sqrt(LINK**2 + HEIGHT**2 - 2 * LINK * HEIGHT * sin)
    lever = -LINK * HEIGHT * cos / length  # of the strut's length, by the angle
    pull = k * (length - free) + c * lever * rate
    mass = np.array([[330.0, 30.0 * LINK * cos], [30.0 * LINK * cos, 30.0 * LINK**2 + 1.2]])
    force = [
        push - 330.0 * GRAVITY + 30.0 * LINK * sin * rate**2,
        (push - 30.0 * GRAVITY) * LINK * cos - pull * lever,
    ]
    return np.concatenate([[speed, rate], np.linalg.solve(mass, force)])


CASES = {
    "arm": (arm, arm_rate, lambda z: 0.3 + np.sin(z[0]), [0.0, 0.0]),
    "strut": (strut, strut_rate, lambda z: z[0] + LINK * np.sin(z[1]), [0.3, 0.0, 0.0, 0.0]),
}


@functools.cache
def reference(name: str) -> tuple[np.ndarray, list[float]]:
    """State at the end, and when the tyre touches and leaves the ground."""
    _, rate, height, start = CASES[name]

    def touch(t, z):
        return height(z)

    touch.terminal = True
    t, z, touching, times = 0.0, np.array(start), False, []
    while t < END:
        touch.direction = 1 if touching else -1
        reference = solve_ivp(
            lambda t, z, side=touching: rate(z, side),
            (t, END),
            z,
            "DOP853",
            events=touch,
            rtol=1e-12,
            atol=1e-13,
        )
        t, z = reference.t[-1], reference.y[:, -1]
        if reference.status == 1:
            touching = not touching
            times.append(t)
    return z, times


@functools.cache
def model(name: str):
    system, *names = CASES[name][0]()
    return system.build(), [measure for kind in names for measure in kind]


INTEGRATORS = {
    "Radau, index 3": (da.Radau, da.DAE(index=3)),
    "Radau, index 2": (da.Radau, da.DAE(index=2)),
    "Radau, index 1": (da.Radau, da.DAE(index=1)),
    "Radau, stabilised": (da.Radau, da.DAE(index=2, stabilized=True)),
    "Radau, ODE": (da.Radau, da.RangeSpace()),
    "Dormand-Prince": (da.DormandPrince, da.RangeSpace()),
    "Dormand-Prince 853": (da.DormandPrince853, da.RangeSpace()),
    "BDF": (da.BDF, da.DAE(index=3)),
}


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("method", "name", "rtol"),
    crossed(INTEGRATORS, itertools.product(CASES, [1e-4, 1e-6, 1e-8, 1e-10]), 2),
)
def test_tyre(method, name, rtol):
    """Every integrator gets over the touch, in few steps and as exactly as it was told to."""
    wanted, touches = reference(name)
    integrator, formulation = INTEGRATORS[method]
    system, measures = model(name)
    motion = da.solve_dynamics(
        system,
        END,
        integrator=integrator(rtol=rtol, atol=rtol / 100),
        formulation=formulation,
    )
    assert motion.status.success, motion.status
    computed = np.array([motion[measure].values[-1] for measure in measures])
    size = np.maximum(np.abs(wanted), 1.0)
    assert np.max(np.abs(computed - wanted) / size) < 100 * rtol
    # the order of the error estimates of Radau is 3: steps grow as rtol^(-1/4)
    order = 4 if integrator is da.Radau else 5
    assert motion.statistics["steps"] < 300 * (1e-4 / rtol) ** (1 / order)
    for time in touches:
        assert np.min(np.abs(motion.time - time)) < 100 * rtol, time


@pytest.mark.parametrize("name", CASES)
def test_the_tyre_touches(name):
    assert len(reference(name)[1]) >= 2
