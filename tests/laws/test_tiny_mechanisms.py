"""Mechanisms without freedoms, equations, forces or masses, through every combination of choices.

Whatever is empty has a shape, and 0 × 1 is not 1 × 0: nothing may take notice.
"""

from __future__ import annotations

import itertools
import random

import numpy as np
import pytest
from registry import FORMULATIONS, INTEGRATORS, SOFT, STABILIZATIONS
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar

COORDINATES = (
    da.AbsoluteCoordinates(),
    da.JointCoordinates(),
    da.JointCoordinates(angles="absolute"),
    da.JointCoordinates(reactions="projected"),
)
LEVELS = (da.DAE(index=2), da.DAE(index=2, stabilized=True), da.DAE(index=1))
DURATION, ROUGHLY = 0.02, 5e-3
"""Two steps, of which the first order makes errors of some millimetres."""


def pinned(weight: float = 9.81) -> tuple[da.System, planar.Bar]:
    system = da.System("tiny", gravity=(0.0, -weight) if weight else None)
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0, angular_velocity=1.0))
    system.add(planar.Revolute("O", system.ground.point(0, 0), bar.start))
    return system, bar


def free_particle() -> da.System:
    """No equation, no parameter, no force."""
    system = da.System("tiny")
    system.add(planar.Particle("bar", mass=1.0, position=(0.5, 0.0), velocity=(0.0, 0.5)))
    return system


def pendulum() -> da.System:
    """No equation in joint coordinates."""
    return pinned()[0]


def clamped() -> da.System:
    """No freedom; in joint coordinates no coordinate at all."""
    system = da.System("tiny", gravity=(0.0, -9.81))
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0))
    system.add(planar.Weld("O", system.ground.point(0, 0), bar.start))
    return system


def driven() -> da.System:
    """As many equations as coordinates."""
    system, bar = pinned()
    system.add(planar.RotationalDriver("drive", system.ground, bar, 2 * da.t))
    return system


def tipped() -> da.System:
    """A body without any mass behind a pendulum."""
    system, bar = pinned()
    tip = system.add(planar.Body("tip", mass=0, inertia=0))
    system.add(planar.Weld("W", bar.end, tip.point(0, 0)))
    return system


def weightless() -> da.System:
    """No mass at all."""
    system = da.System("tiny")
    bar = system.add(planar.Body("bar", mass=0, inertia=0, position=(0.5, 0.0)))
    system.add(planar.Weld("O", system.ground.point(0.5, 0), bar.point(0, 0)))
    return system


def doubled() -> da.System:
    """An equation too many."""
    system, bar = pinned()
    system.add(planar.Revolute("again", system.ground.point(0, 0), bar.start))
    return system


def swung() -> float:
    """Angle of the pendulum at the end, ``φ̈ = −(3g/2l) cos φ``."""
    end = solve_ivp(
        lambda t, s: (s[1], -1.5 * 9.81 * np.cos(s[0])), (0, DURATION), (0, 1), rtol=1e-9
    )
    return float(end.y[0, -1])


TINY = {
    free_particle: DURATION,
    pendulum: swung(),
    clamped: 0.0,
    driven: 2 * DURATION,
    tipped: swung(),
    weightless: 0.0,
    doubled: swung(),
}
"""Mechanism, and the angle at the end under which its middle is seen from the origin."""
CHOICES = list(
    itertools.product((*FORMULATIONS.values(), *SOFT.values(), *LEVELS), INTEGRATORS.values())
)
UNSOLVED = (da.Penalty, da.IDA)
"""IDA's Newton gives up on equations that are all but redundant, and says so."""


@pytest.fixture(scope="module")
def models():
    return {make: make().build() for make in TINY}


def check(model, angle: float, **choices) -> bool:
    """Whether the choices go together; if so, that they arrive."""
    try:
        motion = da.solve_dynamics(model, DURATION, step=DURATION / 2, **choices)
    except da.UnsupportedError:
        return False
    if isinstance(choices["formulation"], UNSOLVED) and isinstance(choices["integrator"], UNSOLVED):
        return False
    assert motion.status.success, (choices, motion.status)
    y = motion.trajectory.y[:2, -1]
    assert abs(np.arctan2(y[1], y[0]) - angle) < ROUGHLY, choices
    assert motion.data.sizes["time"] >= 2, choices
    return True


@pytest.mark.thorough
@pytest.mark.parametrize("each", [3, pytest.param(1, marks=pytest.mark.thorough)])
def test_every_combination_takes_a_tiny_mechanism(each, models):
    """All combinations, or one in ``each`` with all formulations and integrators."""
    rng = random.Random(1)
    ran = 0
    for formulation, integrator in CHOICES[::each]:
        make = rng.choice(list(TINY))
        ran += check(
            models[make],
            TINY[make],
            formulation=formulation,
            integrator=integrator,
            coordinates=rng.choice(COORDINATES),
            stabilization=rng.choice(list(STABILIZATIONS.values())),
        )
    assert ran > 80 / each


@pytest.mark.few(2)
@pytest.mark.parametrize("make", [clamped, driven, pendulum], ids=lambda make: make.__name__)
@pytest.mark.parametrize("integrator", INTEGRATORS.values(), ids=INTEGRATORS)
def test_every_integrator_takes_what_has_no_coordinate_or_no_equation(make, integrator, models):
    for formulation in (da.RangeSpace(), da.VelocityPartitioning()):
        check(
            models[make],
            TINY[make],
            formulation=formulation,
            integrator=integrator,
            coordinates=da.JointCoordinates(),
            stabilization=da.Projection(),
        )
