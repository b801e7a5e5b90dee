"""Newton's cradle by Newton's law in all gaps at once: (−1/3, 2/3, 2/3), not what cradles do.

Balls that touch are struck at one time. The law of restitution then gives the speeds above for
``e = 1`` (e.g. Glocker and Aeberhard 2006); a small distance between the balls, one impact after
the other, gives the cradle of everyday.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("between", "speeds"), [(0.0, (-1 / 3, 2 / 3, 2 / 3)), (1e-3, (0.0, 0.0, 1.0))]
)
def test_three_balls(between, speeds):
    system = da.System("cradle")
    places, size = (0.0, 1.0, 1.2 + between), system.parameter("size", 0.2)
    balls = [
        system.add(planar.Particle(f"b{k}", mass=1.0, position=(x, 0), velocity=(k == 0, 0)))
        for k, x in enumerate(places)
    ]
    for k in range(2):
        gap = balls[k + 1].x - balls[k].x - size
        system.add(planar.UnilateralConstraint(f"c{k}", gap, restitution=1.0))
    motion = da.solve_dynamics(system.build(), 1.0, step=0.01)
    computed = [motion.values(f"b{k}.vx")[-1] for k in range(3)]
    np.testing.assert_allclose(computed, speeds, atol=1e-13)
    assert [impact.name for impact in motion.impacts] == ["c0", "c1"]


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "scheme", [da.AnticipatedImpacts(), da.MoreauJean()], ids=lambda s: type(s).__name__
)
@pytest.mark.parametrize(
    ("between", "speeds"), [(0.0, (-1 / 3, 2 / 3, 2 / 3)), (0.02, (0.0, 0.0, 1.0))]
)
def test_three_balls_as_shapes(between, speeds, scheme):
    """In steps, all impacts of a step at once; the gap exceeds the motion of a step."""
    system = da.System("cradle")
    shapes = []
    for k, x in enumerate((0.0, 0.3, 0.5 + between)):
        ball = system.add(planar.Particle(f"b{k}", mass=1.0, position=(x, 0), velocity=(k == 0, 0)))
        shapes.append(planar.contact.Circle(ball.center, 0.1))
    system.add(planar.Collisions("hits", shapes, restitution=1.0))
    motion = da.solve_nonsmooth(system.build(), 0.2, step=5e-3, integrator=scheme)
    computed = [motion.values(f"b{k}.vx")[-1] for k in range(3)]
    np.testing.assert_allclose(computed, speeds, atol=1e-10)
    assert motion.data["energy"].values[-1] == pytest.approx(0.5, abs=1e-10)


@pytest.mark.parametrize(
    "free", [True, pytest.param(False, marks=pytest.mark.thorough)], ids=["balls", "pendulums"]
)
@pytest.mark.parametrize("gap", [1e-4, 1e-3])
def test_gaps_below_the_motion_of_a_step_dissipate_no_energy(gap, free):
    """Elastic balls that part slowly when an impact reaches them: with ``e = 1`` no impact
    dissipates energy, however many of them are within a step."""
    system, radius, length = da.System("cradle", gravity=(0, 0 if free else -9.81)), 0.02, 0.3
    shapes = []
    for k in range(5):
        x, angle = (2 * radius + gap) * k, 0.0 if k or free else 0.5
        place = (x - length * np.sin(angle), -length * np.cos(angle))
        start = {"position": place, "angle": -angle, "velocity": (1e-3 * k, 0.0)}
        if free and k == 0:
            start |= {"position": (-0.01, -length), "velocity": (0.8, 0.0)}
        ball = system.add(planar.Body(f"b{k}", mass=0.1, inertia=2e-5, **start))
        if not free:
            pivot = system.ground.point(x, 0)
            system.add(planar.Revolute(f"h{k}", pivot, ball.point(0, length)))
        shapes.append(planar.contact.Circle(ball.center, radius))
    system.add(planar.Collisions("hits", shapes, restitution=1.0))
    motion = da.solve_nonsmooth(system.build(), 0.05 if free else 2.0, step=2e-3)
    energy = motion.data["energy"].values
    exchanged = 0.1 * 9.81 * length * (1 - np.cos(0.5))
    assert motion.record.step.size and abs(energy[-1] - energy[0]) < 1e-3 * exchanged
    if gap == 1e-4:  # otherwise the impacts of the free balls are in separate steps
        assert any("both count as one" in text for text in motion.warnings)


@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
@pytest.mark.parametrize("gap", [0.0, 1e-3])
def test_a_step_that_the_warning_proposes_separates_the_impacts(scheme, gap):
    """The last of three elastic balls leaves alone; balls that touch have no separate impacts."""
    system, shapes = da.System("row"), []
    for k, x in enumerate((0.0, 0.31, 0.51 + gap)):
        ball = system.add(planar.Particle(f"b{k}", mass=1.0, position=(x, 0), velocity=(k == 0, 0)))
        shapes.append(planar.contact.Circle(ball.center, 0.1))
    system.add(planar.Collisions("hits", shapes, restitution=1.0))
    model = system.build()
    motion = da.solve_nonsmooth(model, 0.2, step=1e-2, integrator=scheme)
    warnings = [text for text in motion.warnings if "both count as one" in text]
    assert len(warnings) == (gap > 0 and scheme.anticipates)
    if warnings:
        step = float(warnings[0].partition("step=")[2].split()[0])
        motion = da.solve_nonsmooth(model, 0.2, step=step, integrator=scheme)
        assert motion["b2.vx"][-1].item() == pytest.approx(1.0, rel=1e-9)
        assert not any("both count as one" in text for text in motion.warnings)
