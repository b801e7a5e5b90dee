"""Augmented methods: redundant equations, soft constraints, massless members."""

from __future__ import annotations

import functools
from itertools import pairwise

import casadi as ca
import numpy as np
import pytest
from registry import CONSTRAINED, SOFT, model_of

import dalembert as da
from dalembert import planar

EVERY = da.AugmentedLagrangian()


@functools.cache
def parallelogram():
    """A coupler on three parallel cranks: one of six joints is redundant."""
    system = da.System("double parallelogram", gravity=(0.0, -9.81))
    length, angle = system.parameter("length", 0.6), 2.0
    coupler = planar.Bar("coupler", length=2.0, mass=system.parameter("mass", 3.0), angle=0.0)
    for x in (0.0, 1.0, 2.0):
        place = (x + 0.3 * np.cos(angle), 0.3 * np.sin(angle))
        bar = planar.Bar(
            f"crank{x:g}", length=length, mass=1.0, position=place, angle=angle, angular_velocity=-1
        )
        system.add(bar)
        system.add(planar.Revolute(f"O{x:g}", system.ground.point(x, 0), bar.start))
        if x == 0.0:
            system.add(coupler)
        system.add(planar.Revolute(f"A{x:g}", bar.end, coupler.point(x - 1, 0)))
    return system.build()


@functools.cache
def linked_pendulum():
    """A rigid link repeats, in another direction, what the pin of a double pendulum holds."""
    system = da.System("linked pendulum", gravity=(0.0, -9.81))
    mass = system.parameter("mass", 1.0)
    upper = planar.Bar("upper", length=1.0, mass=mass, angle=0.3, angular_velocity=3.0)
    lower = planar.Bar("lower", length=0.7, mass=0.6, angle=-0.8, angular_velocity=-2.0)
    system.add(upper), system.add(lower)
    system.add(planar.Revolute("pin", system.ground.center, upper.start))
    system.add(planar.Revolute("knee", upper.end, lower.start))
    far = float(np.hypot(0.7, 0.35))
    system.add(planar.RigidLink("link", system.ground.center, upper.point(0.2, 0.35), length=far))
    return system.build()


REDUNDANT = {"parallelogram": parallelogram, "linked pendulum": linked_pendulum}


def at_start(model, formulation, equations=None):
    """Accelerations and multipliers at the start."""
    e = equations or model.equations
    function = formulation.acceleration(e, e.constraint_acceleration).function
    x = np.concatenate([model.start.y, model.start.v, [0, 0]])
    return tuple(a.full().ravel() for a in function(0.0, x, model.nominal))


@pytest.mark.few(16)
@pytest.mark.parametrize("name", CONSTRAINED)
def test_penalty_error_falls_with_the_augmented_mass(name):
    """Errors of v̇ and λ have slope −1 in α, and stay below the largest |λ|/α can explain."""
    model, factors = model_of(name), np.array([1e3, 1e4, 1e5])
    exact = at_start(model, da.KKT())
    errors = np.array(
        [
            [np.abs(a - b).max() for a, b in zip(computed, exact, strict=True)]
            for computed in (at_start(model, da.Penalty(factor=f)) for f in factors)
        ]
    )
    for column, size in zip(errors.T, exact, strict=True):
        if column[0] > 1e-8 * (1 + np.abs(size).max()):  # else there is no error to measure
            slope = np.polyfit(np.log(factors), np.log(column), 1)[0]
            assert -1.05 < slope < -0.9


@pytest.mark.parametrize("name", REDUNDANT)
def test_redundant_equations_change_no_acceleration(name):
    """v̇ as with the independent equations; Cᵀλ too; of all λ the one with least Σ λ²."""
    model = REDUNDANT[name]()
    assert model.diagnosis.redundancies
    e, p = model.all_equations, model.nominal
    a, multiplier = at_start(model, EVERY, e)
    a_other, independent = at_start(model, da.RangeSpace())
    c = ca.Function("C", [e.t, e.y, e.p], [ca.densify(e.jacobian)])(0, model.start.y, p).full()
    other = model.all_multipliers(independent[:, None]).ravel()
    size = 1 + np.abs(other).max()
    np.testing.assert_allclose(a, a_other, atol=1e-9 * size)
    np.testing.assert_allclose(multiplier, np.linalg.pinv(c.T) @ c.T @ other, atol=1e-9 * size)


def test_equal_cranks_carry_equal_shares():
    """A third crank that is the middle of two equal ones carries what they do."""
    _, multiplier = at_start(parallelogram(), EVERY, parallelogram().all_equations)
    shares = multiplier.reshape(3, 4)
    np.testing.assert_allclose(shares - shares[0], 0.0, atol=1e-9 * np.abs(shares).max())


@pytest.mark.parametrize("name", REDUNDANT)
def test_motion_with_redundant_equations(name):
    """The same motion as with the independent ones, as closely as the integrator follows it."""
    model, method = REDUNDANT[name](), da.DormandPrince853(1e-11, 1e-11)
    run = {
        f: da.solve_dynamics(model, 0.5, formulation=f, integrator=method, outputs=4)
        for f in (EVERY, da.RangeSpace())
    }
    computed, expected = (m.trajectory for m in run.values())
    np.testing.assert_allclose(computed.y, expected.y, atol=1e-9)
    np.testing.assert_allclose(computed.a, expected.a, atol=1e-7)
    assert run[EVERY].statistics["maximum |C v̇ − ξ|"] < 1e-10
    assert float(run[EVERY].data.position_violation.max()) < 1e-12


@pytest.mark.parametrize("step", [0.01, 0.0025])
def test_intermediate_states_do_not_lock_redundant_equations(step):
    """Violated constraints inside long steps do no worse than leave an error of the same size."""
    model, exact_method = linked_pendulum(), da.DormandPrince853(1e-12, 1e-12)
    exact = da.solve_dynamics(model, 0.5, integrator=exact_method, outputs=2).trajectory.y
    error, usual = (
        np.abs(
            da.solve_dynamics(model, 0.5, step=step, formulation=f, outputs=2).trajectory.y - exact
        ).max()
        for f in (EVERY, da.RangeSpace())
    )
    assert error < 5 * usual


@pytest.mark.few(1)
@pytest.mark.parametrize("name", REDUNDANT)
def test_gradients_with_redundant_equations(name):
    """direct = adjoint = Richardson for a position and an acceleration, which are unique."""
    model = REDUNDANT[name]()
    body = model.bodies[0].name
    motion = da.solve_dynamics(model, 0.1, step=0.002, formulation=EVERY)
    responses = [da.final(model[f"{body}.angle"]), da.final(model[f"{body}.ax"])]
    direct, adjoint, difference = (
        da.sensitivity(motion, responses, method=m).values
        for m in ("direct", "adjoint", "finite-difference")
    )
    np.testing.assert_allclose(direct, adjoint, rtol=1e-9, atol=1e-9 * np.abs(direct).max())
    np.testing.assert_allclose(direct, difference, rtol=1e-6, atol=1e-6 * np.abs(direct).max())


@pytest.mark.parametrize("stabilization", [da.Stabilization(), da.Projection()])
@pytest.mark.parametrize("formulation", SOFT)
def test_soft_constraints_follow_the_motion(formulation, stabilization):
    """Violations without correction are those of Φ̈ + 2ηΦ̇ + ω²Φ = λ/α; projected, they are gone."""
    model = parallelogram()
    run, exact = (
        da.solve_dynamics(model, 0.5, step=0.002, formulation=f, stabilization=s)
        for f, s in ((SOFT[formulation], stabilization), (EVERY, da.Projection()))
    )
    soft = np.abs(exact.trajectory.multiplier).max() / (SOFT[formulation].factor * 1.0)
    assert np.abs(run.trajectory.y - exact.trajectory.y).max() < soft
    projected = isinstance(stabilization, da.Projection)
    assert float(run.data.position_violation.max()) < (1e-12 if projected else soft)


@pytest.mark.few(1)
@pytest.mark.parametrize("formulation", [EVERY, da.RangeSpace()])
def test_massless_coupler(formulation):
    """The limit of small masses: the distance to it falls with the mass."""

    def run(mass: float, formulation=formulation):
        system = da.System("four-bar", gravity=(0.0, -9.81))
        bars = [
            system.add(planar.Bar("crank", length=0.3, mass=1.5, angle=1.2, angular_velocity=2.0)),
            system.add(planar.Bar("coupler", length=1.0, mass=mass, angle=0.3)),
            system.add(planar.Bar("rocker", length=0.6, mass=3.0, angle=1.4)),
        ]
        system.add(planar.Revolute("O", system.ground.point(0, 0), bars[0].start))
        system.add(planar.Revolute("A", bars[0].end, bars[1].start))
        system.add(planar.Revolute("B", bars[1].end, bars[2].end))
        system.add(planar.Revolute("C", system.ground.point(1, 0), bars[2].start))
        motion = da.solve_dynamics(system.build(), 0.4, step=0.005, formulation=formulation)
        assert motion.status.success
        return motion.trajectory

    limit = run(0.0)
    distance = [np.abs(run(mass).y - limit.y).max() for mass in (1e-2, 1e-3, 1e-4)]
    slopes = np.diff(np.log10(distance))
    assert np.all((slopes > -1.1) & (slopes < -0.9))
    np.testing.assert_allclose(limit.y, run(0.0, da.KKT()).y, atol=1e-10)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda: da.Penalty(omega=10.0, eta=9.0), "eta=9.0 must be at least omega=10.0"),
        (lambda: da.Penalty(factor=0.0), "factor=0.0"),
        (lambda: da.Penalty(omega=-1.0), "omega=-1.0"),
        (lambda: da.AugmentedLagrangian(iterations=0), "iterations=0"),
        (lambda: da.AugmentedLagrangian(factor=float("nan")), "factor=nan"),
    ],
)
def test_wrong_numbers_are_refused_by_name(wrong, said):
    with pytest.raises(da.UnsupportedError, match=said):
        wrong()


def similar_chain(size):
    """A four-bar on three links of any size, the coupler without mass."""
    system = da.System("similar", gravity=(0.0, -9.81))
    corners = size * np.array([(0.0, 0.0), (0.3, 0.4), (1.2, 0.7), (1.3, 0.0)])
    end = system.ground.center
    for k, (start, stop) in enumerate(pairwise(corners)):
        way = stop - start
        link = planar.Bar(
            f"link{k}",
            length=float(np.hypot(*way)),
            mass=0.0 if k == 1 else 1.0,
            angle=float(np.arctan2(way[1], way[0])),
            position=tuple((start + stop) / 2),
            angular_velocity=2.0 / size**0.5,
        )
        system.add(link)
        system.add(planar.Revolute(f"pin{k}", end, link.start))
        end = link.end
    system.add(planar.Revolute("pin3", end, system.ground.point(*corners[-1])))
    return system.build()


@pytest.mark.few(3)
@pytest.mark.parametrize("coordinates", [da.AbsoluteCoordinates(), da.JointCoordinates()], ids=repr)
@pytest.mark.parametrize("size", [1e-3, 1e2])
@pytest.mark.parametrize("formulation", [EVERY, da.RangeSpace()], ids=["augmented", "range space"])
def test_weights_know_no_unit_of_length(formulation, size, coordinates):
    """Accelerations and multipliers of millimetres and of hectometres are those of (5.7)."""
    model, step = similar_chain(size), 1e-3 * size**0.5
    computed, exact = (
        da.solve_dynamics(model, 3 * step, step=step, formulation=f, coordinates=coordinates)
        for f in (formulation, da.KKT())
    )
    for name in ("a", "multiplier"):
        one, other = (getattr(motion.trajectory, name) for motion in (computed, exact))
        np.testing.assert_allclose(one, other, atol=1e-9 * np.abs(other).max())
