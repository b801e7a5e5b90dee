"""Driven bars: the motor's effort by hand, from inverse and from forward dynamics alike."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from registry import LAWS, Builder, Observer
from twins import second_rate

import dalembert as da
from dalembert import planar

MASS, LENGTH, G = 1.7, 0.8, 9.81
TIMES = np.array([0.05, 0.12, 0.2])


def motor(name: str):
    """A bar on a pin, turned against the ground by a law; and that law's twin."""
    builder = Builder("motor", False, Observer())
    system = builder.system
    system.add(
        planar.Force(
            "weight",
            bar := system.add(planar.Bar("bar", length=LENGTH, mass=MASS)),
            (0.0, -MASS * G),
        )
    )
    system.add(planar.Revolute("pin", system.ground.point(0.3, -0.2), bar.start))
    system.add(planar.RotationalDriver("motor", system.ground, bar, LAWS[name].make(builder)))
    numbers = SimpleNamespace(**{n: p.value for n, p in system.parameters.items()})
    return system.build(), lambda time: LAWS[name].twin(numbers, time)


@pytest.mark.few(2)
@pytest.mark.parametrize("name", LAWS)
def test_effort_of_the_motor(name):
    """M = (m l²/3) φ̈ + m g (l/2) cos φ."""
    model, angle = motor(name)
    acceleration = np.array([second_rate(lambda s, t=t: angle(t + s))[0] for t in TIMES])
    phi = np.array([float(angle(t)) for t in TIMES])
    expected = MASS * LENGTH**2 / 3 * acceleration + MASS * G * LENGTH / 2 * np.cos(phi)
    inverse = da.solve_inverse_dynamics(model, TIMES[-1], step=0.01, outputs=TIMES)
    forward = da.solve_dynamics(model, TIMES[-1], step=0.005, outputs=TIMES)
    for motion in (inverse, forward):
        np.testing.assert_allclose(motion["bar.angle"].values, phi, atol=1e-11)
        effort = motion.data.effort.sel(driver="motor").values
        np.testing.assert_allclose(effort, expected, rtol=1e-8)
