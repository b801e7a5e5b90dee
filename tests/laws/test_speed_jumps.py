"""Prescribed speeds that jump under resting bodies, by Newton's law.

The speed before the jump is zero relative to the driven body, so that the resting body leaves with
it for any restitution, and friction transmits up to ``μ`` times the impulse.
"""

from __future__ import annotations

import numpy as np
import pytest
from thorough import sampled

import dalembert as da
from dalembert import planar
from dalembert.errors import AnalysisError

contact = planar.contact
G, H, BEFORE = 10.0, 1e-3, 0.02
SCHEMES = [da.AnticipatedImpacts(), da.MoreauJean()]
FRACTIONS = [0.0, 0.2, 0.4, 0.5, 0.8, 0.95]


def jolted(
    fraction: float, scheme, velocity=(0.0, 1.0), restitution=0.0, friction=0.0
) -> da.Motion:
    """A box of 2 kg rests on a table whose velocity jumps within a step."""
    system, start = da.System("jolt", gravity=(0, -G)), BEFORE + fraction * H
    table = system.add(planar.Body("table", mass=50.0, inertia=1.0, position=(0, 0)))
    moved = da.where(da.t < start, 0.0, da.t - start)
    system.add(planar.UserConstraint("level", table.angle))
    system.add(planar.UserConstraint("along", table.x - velocity[0] * moved))
    system.add(planar.CoordinateDriver("ram", table.center, velocity[1] * moved, (0, 1)))
    mass = system.parameter("m", 2.0)
    box = system.add(planar.Body("box", mass=mass, inertia=0.02, position=(0, 0.05)))
    shapes = [contact.Rectangle(box, (0.3, 0.1)), contact.HalfPlane(table)]
    law = {"restitution": restitution, "friction": friction}
    system.add(planar.Collisions("top", shapes, **law))
    return da.solve_nonsmooth(system.build(), BEFORE + 2 * H, step=H, integrator=scheme)


@pytest.mark.few(2)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("restitution", sampled([0.0, 0.7], 1))
@pytest.mark.parametrize("fraction", FRACTIONS)
def test_a_resting_body_leaves_with_the_driven_one(fraction, restitution, scheme):
    motion = jolted(fraction, scheme, restitution=restitution)
    assert motion.status.success
    speeds = motion["box.vy"].values
    assert speeds.max() == pytest.approx(1.0, abs=G * H)  # up to 2 where contacts are left out
    pushes = motion.impulse("top").values
    weight = 2.0 * G * H
    assert pushes.max() == pytest.approx(2.0 + weight, abs=weight)
    assert abs(motion["table.vy"].values[-1] - 1.0) < 1e-12


@pytest.mark.few(3)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("along", [0.2, 0.6])
@pytest.mark.parametrize("fraction", sampled([0.1, 0.7], 1))
def test_friction_transmits_its_share_of_the_impulse(fraction, along, scheme):
    """``v_x = min(V_x, μ (V_y + g h))`` where the table jumps obliquely, at a friction of 0.4."""
    motion = jolted(fraction, scheme, (along, 1.0), friction=0.4)
    first = int(np.argmax(motion["box.vy"].values > 0.5))
    assert motion["box.vy"].values[first] == pytest.approx(1.0, abs=G * H)
    assert motion["box.vx"].values[first] == pytest.approx(min(along, 0.4 * (1 + G * H)), abs=1e-8)


def test_a_jump_under_a_contact_has_no_gradient():
    motion = jolted(0.2, da.AnticipatedImpacts())
    with pytest.raises(AnalysisError, match=r"prescribed speed jumps .* t = 0\.02 s"):
        da.sensitivity(motion, da.final("box.y"))
