"""Cart on two rolling wheels, driven by motion (A, B) and by a motor (C).

Source: P. E. Nikravesh, *Planar Multibody Dynamics*, 2nd ed., models Cart_A, Cart_B, Cart_C of the
program DAP_BC and their stored results (ode45, relative tolerance 1e-6). Chassis 20 kg, wheels
2 kg, 0.5 kg m², radius 0.1 m. All three have closed forms.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

RADIUS, START = 0.1, 0.5


def cart():
    system = da.System("cart", gravity=(0.0, -9.81))
    chassis = system.add(
        planar.Body("chassis", mass=20.0, inertia=5.0, position=(START, 0.2), angle=0.0)
    )
    wheels = []
    for k, side in ((1, -0.3), (2, 0.3)):
        wheel = system.add(
            planar.Body(f"wheel{k}", mass=2.0, inertia=0.5, position=(START + side, 0.1), angle=0.0)
        )
        system.add(planar.Revolute(f"axle{k}", chassis.point(side, -0.1), wheel.center))
        system.add(
            planar.RollingDisc(
                f"contact{k}", system.ground.point(0, 0), wheel.center, radius=RADIUS
            )
        )
        wheels.append(wheel)
    return system, chassis, wheels[1]


def travel(system: da.System, times) -> np.ndarray:
    """Position and speed of the chassis."""
    motion = da.solve_dynamics(
        system.build(),
        times[-1],
        integrator=da.DormandPrince(1e-11, 1e-11, max_step=0.02),
        outputs=times,
    )
    assert motion.status.success
    return np.stack([motion["chassis.x"].values, motion["chassis.vx"].values])


def test_constant_turning():
    """A: wheel 2 turns at −2π rad/s against the chassis."""
    system, chassis, wheel = cart()
    system.add(planar.RotationalDriver("motor", chassis, wheel, -2 * np.pi * da.t))
    times = np.array([1.0, 10.0])
    x, v = travel(system, times)
    np.testing.assert_allclose(x, START + 2 * np.pi * RADIUS * times, atol=1e-9)
    np.testing.assert_allclose(v, 2 * np.pi * RADIUS, atol=1e-9)
    assert x[-1] == pytest.approx(6.78318530717951, abs=1e-9)


def test_smooth_start():
    """B: the speed rises to −2π rad/s in 2 s by the 3-4-5 polynomial."""
    system, chassis, wheel = cart()
    s = da.t / 2
    rising = 2 * s**4 * (2.5 + s * (-3 + s))
    system.add(
        planar.RotationalDriver(
            "motor", chassis, wheel, -2 * np.pi * da.where(da.t < 2, rising, da.t - 1)
        )
    )
    x, _ = travel(system, np.array([1.0, 2.0, 10.0]))
    np.testing.assert_allclose(x, START + 2 * np.pi * RADIUS * np.array([5 / 32, 1, 9]), atol=1e-9)
    np.testing.assert_allclose(
        x, [0.598174778658534, 1.12831856753888, 6.15485457322214], rtol=1e-5
    )


def test_motor():
    """C: a motor of torque 20 (1 − |ω|/4π) N m between chassis and wheel 2."""
    system, chassis, wheel = cart()
    torque = -20 * (1 - da.absolute(wheel.angular_velocity) / (4 * np.pi))
    system.add(planar.Torque("motor", wheel, torque, reaction_on=chassis))
    times = np.array([1.0, 10.0])
    x, v = travel(system, times)
    top, tau = 0.4 * np.pi, 124 * 0.4 * np.pi / 200
    np.testing.assert_allclose(v, top * (1 - np.exp(-times / tau)), atol=1e-9)
    np.testing.assert_allclose(
        x, START + top * (times - tau * (1 - np.exp(-times / tau))), atol=1e-9
    )
    np.testing.assert_allclose(x, [1.04883558873404, 12.087308510222], rtol=1e-5)
    np.testing.assert_allclose(v, [0.908468573453447, 1.25663365699492], rtol=1e-5)
