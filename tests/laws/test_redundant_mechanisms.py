"""Redundant equations: whichever are solved, all of them hold wherever the mechanism moves."""

from __future__ import annotations

import numpy as np
import pytest
from random_mechanisms import Mechanism, doubled, empty, parallelogram, trammel

import dalembert as da
from dalembert import planar

EXACT = 1e-10


def redundant(seed: int) -> Mechanism:
    rng = np.random.default_rng(seed)
    m = empty(rng)
    rng.choice([trammel, parallelogram, doubled])(m)
    return m


def violation(m: Mechanism, motion) -> float:
    """Largest residual of any joint along a motion, by the twin."""
    s = motion.trajectory
    return max(np.abs(m.constraints(y, t)).max() for t, y in zip(s.t, s.y.T, strict=True))


@pytest.mark.few(1)
@pytest.mark.parametrize("coordinates", [da.AbsoluteCoordinates(), da.JointCoordinates()])
def test_all_equations_hold_though_some_are_solved(coordinates):
    """With other rows as the mechanism moves: those of the start lose their independence."""
    changes = 0
    for seed in range(14):
        m = redundant(seed)
        motion = da.solve_dynamics(m.system.build(), 1.5, step=0.02, coordinates=coordinates)
        assert motion.status.success, (seed, motion.status)
        assert violation(m, motion) < EXACT, seed
        changes += motion.statistics.get("variant changes", 0)
    assert changes > 4


@pytest.mark.thorough
@pytest.mark.parametrize("formulation", [da.Penalty(), da.AugmentedLagrangian()])
def test_equations_that_the_tree_satisfies_carry_no_weight(formulation):
    """A pin held twice leaves nothing but rounding in joint coordinates, in which α was lost."""
    for seed in range(30):
        model = redundant(seed).system.build()
        expected = accelerations(model, da.AbsoluteCoordinates(), da.RangeSpace())
        computed = accelerations(model, da.JointCoordinates(), formulation)
        assert np.abs(computed - expected).max() < 1e-2 * (1 + np.abs(expected).max()), seed


def accelerations(model: da.Model, coordinates, formulation) -> np.ndarray:
    """``v̇`` of the bodies at the start."""
    view = coordinates.view(model, formulation.every_equation)
    e, start, p = view.equations, model.start, model.nominal
    q, u = (x.full().ravel() for x in view.reduce.function(0.0, start.y, start.v, p))
    seen = [e.without_dropped(view.everything[2])]
    function = formulation.acceleration(e, e.constraint_acceleration, seen).function
    return function(0.0, np.concatenate([q, u, [0, 0]]), p).full().ravel()


def test_gradients_pass_through_a_change_of_equations():
    """An elliptic trammel driven round by a moment: ``(J + m a²) φ̈ = M``."""
    system = da.System("trammel")
    a, moment = system.parameter("a", 0.5), system.parameter("moment", 0.7)
    bar = planar.Bar(
        "bar", length=2 * a, mass=1.0, angle=0.4, position=(0.4, 0.2), angular_velocity=3.0
    )
    system.add(bar)
    centre = system.ground.point(0, 0)
    system.add(planar.RigidLink("crank", centre, bar.center, length=a))
    system.add(planar.PinInSlot("x", centre, bar.start, axis=(1.0, 0.0)))
    system.add(planar.PinInSlot("y", centre, bar.end, axis=(0.0, 1.0)))
    system.add(planar.Torque("motor", bar, moment))
    motion = da.solve_dynamics(system.build(), 2.0, step=0.01)
    assert motion.status.success and motion.statistics["variant changes"] >= 1
    direct, adjoint = (
        da.sensitivity(motion, da.final("bar.angle"), method=method).values.ravel()
        for method in ("direct", "adjoint")
    )
    np.testing.assert_allclose(direct, adjoint, rtol=1e-9)
    inertia = 0.5**2 + (2 * 0.5) ** 2 / 12
    turned = 3.0 * 2.0 + 0.7 * 2.0**2 / (2 * inertia)
    assert motion["bar.angle"].values[-1] - 0.4 == pytest.approx(turned, rel=1e-8)
    expected = [-0.7 * 2.0**2 / inertia / 0.5, 2.0**2 / (2 * inertia)]
    np.testing.assert_allclose(direct, expected, rtol=1e-6)


@pytest.mark.parametrize("coordinates", [da.AbsoluteCoordinates(), da.JointCoordinates()])
def test_what_moves_twice_must_move_alike(coordinates):
    """Two formulas of time hold one coordinate: at one speed that is a redundancy, else refused."""
    for rate, alike in ((0.7, True), (0.5, False)):
        system = da.System("moved twice")
        body = system.add(planar.Body("b", mass=1.0, inertia=0.1, position=(0.3, 0.0)))
        system.add(planar.UserConstraint("first", body.x - 0.3 - 0.7 * da.t))
        system.add(planar.UserConstraint("second", 2 * (body.x - 0.3 - rate * da.t)))
        if alike:
            model = system.build()
            assert [r.joint for r in model.diagnosis.redundancies] == ["second"]
            motion = da.solve_dynamics(model, 0.1, step=0.01, coordinates=coordinates)
            assert motion.status.success
        else:
            with pytest.raises(
                da.ModelError, match=r"second: .* another speed than first.*0\.4 m/s"
            ):
                system.build()
