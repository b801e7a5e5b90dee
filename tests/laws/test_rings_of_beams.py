"""Beams that close a loop: conditions of their free starts depend on each other."""

import math

import pytest

import dalembert as da
from dalembert import planar

RADIUS = 0.1


def ring(relaxed: bool) -> da.System:
    """Two half circles, welded to each other; one of them starts as it is placed."""
    system = da.System("ring")
    data = {"axial_rigidity": 2e4, "shear_rigidity": 2e4, "bending_rigidity": 1e-3}
    data |= {"mass_per_length": 0.2, "rotary_inertia": 1e-5, "elements": 4, "order": 1}
    halves = [
        planar.Beam(
            name,
            length=math.pi * RADIUS,
            curvature=-1 / RADIUS,
            position=(x, 0.0),
            angle=angle,
            relaxed=relaxed or name == "upper",
            **data,
        )
        for name, x, angle in (("upper", -RADIUS, math.pi / 2), ("lower", RADIUS, -math.pi / 2))
    ]
    upper, lower = (system.add(half) for half in halves)
    system.add(planar.Weld("right", upper.end, lower.start))
    system.add(planar.Weld("left", lower.end, upper.start, angle=2 * math.pi))
    return system


def test_a_closed_ring_of_relaxed_beams_names_the_remedy():
    with pytest.raises(da.ModelError, match=r"3 of the conditions on speeds .*relaxed=False"):
        ring(relaxed=True).build()


def test_a_closed_ring_with_one_placed_beam_has_its_shape():
    model = ring(relaxed=False).build()
    motion = da.solve_dynamics(model, 1e-3, step=1e-4, integrator=da.BackwardEuler())
    assert motion.status.success
    assert motion["upper.end.x"].values == pytest.approx(RADIUS, abs=1e-6)
    assert motion["lower.end.x"].values == pytest.approx(-RADIUS, abs=1e-6)
