"""Symbols of unilateral constraints in pictures: at the contact point."""

import math

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.elements.look import Limit
from dalembert.results.pictures.pivots import Pivots


@pytest.mark.parametrize("friction", [False, True])
def test_the_symbol_is_below_the_tip_that_touches(friction):
    """At the contact point with a slip; without one, at its place along the wall."""
    system = da.System("tilted bar", gravity=(0, -9.81))
    bar = system.add(planar.Bar("bar", length=1.0, mass=2.0, angle=0.3, position=(0.2, 0.5)))
    slip = bar.vx - bar.angular_velocity * (bar.end.y - bar.y) if friction else None
    tip = planar.UnilateralConstraint("tip", bar.end.y - 0.1, slip, restitution=0.0)
    system.add(tip)
    model = system.build()
    (look,) = tip.look()
    assert isinstance(look, Limit)
    wall = Pivots([tip]).wall(look, model.bodies, {})
    e = model.equations
    x, y, nx, ny = (
        ca.Function("wall", [e.t, e.y, e.v, e.p], [wall])(
            0.0, model.start.y, np.zeros(3), model.nominal
        )
        .full()
        .ravel()
    )
    assert x == pytest.approx(0.2 + 0.5 * math.cos(0.3))
    assert (nx, ny) == (0, 1)
    height = 0.5 * math.sin(0.3)  # of the tip over the mass centre
    assert y == pytest.approx(0.1 if friction else 0.1 - height)


def test_motions_with_unilateral_constraints_are_drawn():
    system = da.System("tilted bar", gravity=(0, -9.81))
    bar = system.add(planar.Bar("bar", length=1.0, mass=2.0, angle=0.3, position=(0.2, 0.5)))
    slip = bar.vx - bar.angular_velocity * (bar.end.y - bar.y)
    law = {"restitution": 0.0, "friction": 0.2}
    system.add(planar.UnilateralConstraint("tip", bar.end.y, slip, **law))
    motion = da.solve_nonsmooth(system.build(), 0.02, step=2e-3)
    assert motion.draw().lines
