"""Oscillator with dry friction, ``m = k = 1``, ``|F| ≤ 1``, from x = 12 with speed 6.

It stops for good at ``t = atan(6/13) + 7π`` in ``x = 15 − √205`` (Siconos, FrictionOscillator: with
steps of 0.01 s, 0.682044).
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

kit = planar.contact
STOP, PLACE = math.atan(6 / 13) + 7 * math.pi, 15 - math.sqrt(205)
WEIGHT, DEPTH = 1.0, 1e-4


def oscillator(slip_speed: float) -> da.Model:
    """A block that its weight presses on a rough floor, at its depth in equilibrium."""
    system = da.System("oscillator", gravity=(0.0, -WEIGHT))
    block = planar.Particle("block", mass=1.0, position=(12.0, -DEPTH), velocity=(6.0, 0.0))
    block = system.add(block)
    system.add(planar.Force("spring", block.center, (-block.x, 0)))
    law = kit.KelvinVoigt(stiffness=WEIGHT / DEPTH, damping=100.0)
    floor = kit.HalfPlane(system.ground.point(0, 0))
    friction = kit.Coulomb(1.0, slip_speed=slip_speed)
    system.add(planar.Contact("floor", floor, block.center, law=law, friction=friction))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("slip_speed", [1e-2, 1e-3, 1e-4])
def test_where_it_stops(slip_speed):
    """Smoothing moves the stop by less than half the square of the transition speed."""
    integrator = da.Radau(rtol=1e-8, atol=1e-10)
    motion = da.solve_dynamics(oscillator(slip_speed), STOP, integrator=integrator)
    assert abs(motion["block.x"].values[-1] - PLACE) < 0.5 * slip_speed**2
    assert np.abs(motion.data.balance_error).max() < 1e-7


def test_where_it_should_stick_it_creeps():
    """With ``v_t atanh(T/N)/4``, as the smooth law says."""
    integrator = da.Radau(rtol=1e-8, atol=1e-10)
    motion = da.solve_dynamics(oscillator(1e-3), STOP + 1.0, integrator=integrator)
    x, speed = (motion[f"block.{name}"].values[-1] for name in ("x", "vx"))
    assert speed == pytest.approx(-1e-3 * math.atanh(x) / 4, rel=1e-3)
