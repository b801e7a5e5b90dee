"""Changes of speeds and coordinates (4.5)–(4.11): the same motion, only told differently."""

from __future__ import annotations

import functools

import casadi as ca
import numpy as np
import pytest
from partition import evaluated, general_state, partition
from registry import CASES, CONSTRAINED, PLANAR, RELATED, SPATIAL, model_of
from thorough import sampled

import dalembert as da
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.inertia import BlockInertia
from dalembert.model.graph.transformation import (
    Transformation,
    change_coordinates,
    change_speeds,
    consistent_speeds,
    coordinates_by,
    speeds_by_basis,
    speeds_by_partition,
)

TOLERANCE = 1e-9


def waves(y: ca.SX, t: ca.SX, count: int, seed: int) -> ca.SX:
    """Smooth functions of coordinates and time, between −1 and 1."""
    rng = np.random.default_rng(seed)
    inside = ca.mtimes(ca.DM(rng.standard_normal((count, y.numel()))), y)
    return ca.sin(inside + ca.DM(rng.standard_normal(count)) * (1 + t))


def basis_of(e: Equations, seed: int) -> ca.SX:
    """A regular ``B(y, t)``; speeds without mass stay by themselves."""
    n = e.speed_count
    basis = ca.SX.eye(n) + ca.reshape(waves(e.y, e.t, n * n, seed), n, n) / (2 * n)
    for k in e.massless:
        basis[k, :], basis[:, k] = 0, 0
        basis[k, k] = 1.5
    return basis


def other_speeds(name: str, drifting: bool = False) -> tuple[Equations, Transformation]:
    e = model_of(name).equations
    drift = waves(e.y, e.t, e.speed_count, 5) if drifting else None
    return e, speeds_by_basis(e, basis_of(e, 1), ca.SX.sym("u", e.speed_count), drift)


def other_coordinates(name: str) -> tuple[Equations, Transformation]:
    """``y = y' + small waves of y' and t``."""
    e = model_of(name).equations
    n = e.coordinate_count
    new = ca.SX.sym("q", n)
    step = waves(new, e.t, n, 2) / (4 * n)
    for k in e.massless:
        step[k] = 0
    return e, coordinates_by(e, new + step, new)


CHANGES = {
    "speeds": other_speeds,
    "speeds with drift": functools.partial(other_speeds, drifting=True),
    "coordinates": other_coordinates,
}


WITH_STATES = ["hydraulic cylinder", "bristles in revolute", "dc motor in revolute"]
"""Cases with states, whose rates are no speeds: other coordinates are refused."""
CHANGED = [(n, c) for n in PLANAR if n in RELATED or n not in CONSTRAINED for c in CHANGES]
CHANGED = [(n, c) for n, c in CHANGED if c != "coordinates" or n not in WITH_STATES]
CHANGED += [(n, "speeds") for n in SPATIAL]
"""Other coordinates are linear in the old ones here, and so of the plane."""


def accelerations(e: Equations, formulation=None) -> ca.SX:
    """``[v̇; λ]`` as expressions of ``t, y, v, p``."""
    solved = (formulation or da.KKT()).acceleration(e, e.constraint_acceleration)
    state = ca.vertcat(e.y, e.v, ca.SX.zeros(2))
    return ca.vertcat(*solved.function(e.t, state, e.p))


@functools.cache
def accelerations_of(name: str) -> ca.SX:
    """Of a case as it is."""
    return accelerations(model_of(name).equations)


@pytest.mark.few(5)
@pytest.mark.parametrize(("name", "change"), sampled(CHANGED, 7))
def test_motion_and_multipliers_stay(name, change):
    """``B v̇' + γ`` is the old acceleration, λ the old multipliers, T the old energy."""
    e, to = CHANGES[change](name)
    new = to.apply(e)
    solution = accelerations(new)
    again = ca.substitute(to.old_a, to.a, solution[: new.speed_count])
    drift = ca.substitute(to.old_v, to.v, ca.SX.zeros(to.v.numel()))
    relative = to.old_v - drift
    energy = ca.dot(relative, ca.mtimes(to.seen(e, e.mass), relative)) / 2
    computed, expected, kinetic, old_kinetic = evaluated(
        new,
        [
            ca.vertcat(again, solution[new.speed_count :]),
            to.seen(e, accelerations_of(name)),
            new.kinetic_energy,
            energy,
        ],
        general_state(new, 0, name),
    )
    scale = 1 + np.abs(expected).max()
    np.testing.assert_allclose(computed, expected, atol=TOLERANCE * scale)
    np.testing.assert_allclose(kinetic, old_kinetic, rtol=1e-12)


@pytest.mark.few(10)
@pytest.mark.parametrize(("name", "change"), sampled(CHANGED, 7))
def test_constraints_and_powers_follow(name, change):
    """Ψ, C = C B, ξ and both powers have the values they had before."""
    e, to = CHANGES[change](name)
    new = to.apply(e)
    ones = ca.SX.ones(*e.multiplier.shape)
    powers = ca.substitute([new.powers, to.seen(e, e.powers)], [e.multiplier], [ones])
    pairs = [
        (new.velocity_constraints, to.seen(e, e.velocity_constraints)),
        (new.jacobian, ca.mtimes(to.seen(e, e.jacobian), to.basis)),
        (
            new.constraint_acceleration,
            to.seen(e, e.constraint_acceleration) - ca.mtimes(to.seen(e, e.jacobian), to.gamma),
        ),
        (new.potential, to.seen(e, e.potential)),
        tuple(powers),
    ]
    outputs = [out for pair in pairs for out in pair]
    values = evaluated(new, outputs, general_state(new, 1, name))
    for computed, expected in zip(values[::2], values[1::2], strict=True):
        scale = 1 + np.abs(expected).max(initial=0)
        np.testing.assert_allclose(computed, expected, atol=1e-10 * scale)


@pytest.mark.few(7)
@pytest.mark.parametrize("name", sampled(CASES, 5))
def test_speeds_without_mass_stay_known(name):
    """The default formulation takes the transformed equations, too."""
    e, to = other_speeds(name)
    new = to.apply(e)
    assert new.massless == e.massless
    both = [accelerations(new, method) for method in (da.RangeSpace(), da.KKT())]
    computed, expected = evaluated(new, both, general_state(new, 2, name))
    scale = 1 + np.abs(expected).max()
    np.testing.assert_allclose(computed, expected, atol=TOLERANCE * scale)


@pytest.mark.parametrize("drifting", [False, True])
@pytest.mark.parametrize("name", ["revolute", "translational driver", "point on formula curve"])
def test_two_changes_are_one(name, drifting):
    """``v = B (B' v'' + b') + b``: in two steps and in one."""
    e, to = other_speeds(name, drifting)
    second, offset = basis_of(e, 3), waves(e.y, e.t, e.speed_count, 7)
    w = ca.SX.sym("w", e.speed_count)
    in_two = change_speeds(to.apply(e), second, w, offset)
    drift = ca.mtimes(to.basis, offset) + ca.substitute(to.old_v, to.v, 0 * to.v)
    in_one = change_speeds(e, ca.mtimes(to.basis, second), w, drift)
    pairs = [(getattr(in_two, part), getattr(in_one, part)) for part in ("mass", "bias", "force")]
    outputs = [out for pair in pairs for out in pair]
    values = evaluated(in_one, outputs, general_state(in_one, 4, name))
    for computed, expected in zip(values[::2], values[1::2], strict=True):
        np.testing.assert_allclose(computed, expected, atol=1e-11 * (1 + np.abs(expected).max()))


@pytest.mark.parametrize("drifting", [False, True])
@pytest.mark.parametrize("name", ["revolute", "distance driver", "spring"])
def test_coordinates_after_speeds(name, drifting):
    """New coordinates do not care which speeds were used before, drifting ones included."""
    e, to = other_speeds(name, drifting)
    _, change = other_coordinates(name)
    direct = change_coordinates(e, change.old_y, change.y, change.v)
    around = change_coordinates(to.apply(e), change.old_y, change.y, change.v)
    both = [accelerations(direct), accelerations(around)]
    computed, expected = evaluated(direct, both, general_state(direct, 6, name))
    np.testing.assert_allclose(computed, expected, atol=TOLERANCE * (1 + np.abs(expected).max()))


# explicit constraints ------------------------------------------------------------------------


@pytest.mark.parametrize("name", sampled(CONSTRAINED, 5))
def test_explicit_constraints(name):
    """C D = 0 (4.18), C γ = ξ (4.19), and D u + b satisfies the velocity equations."""
    e, motion = partition(name)
    c, xi = motion.seen(e, e.jacobian), motion.seen(e, e.constraint_acceleration)
    reduced = motion.apply(e).with_rows([])
    parts = [
        ca.mtimes(c, motion.basis),
        ca.mtimes(c, motion.gamma) - xi,
        motion.seen(e, e.velocity_constraints),
        xi,
    ]
    orthogonal, second, first, size = evaluated(reduced, parts, general_state(reduced, 3, name))
    assert reduced.constraint_count == 0
    limit = 1e-10 * (1 + np.abs(size).max())
    for residual in (orthogonal, second, first):
        assert np.abs(residual).max(initial=0) < limit


@pytest.mark.few(6)
@pytest.mark.parametrize("name", sampled(CONSTRAINED, 5))
def test_projective_scheme(name):
    """(6.9): ``M̂ u̇ = f̂ − d̂`` gives the accelerations of the saddle system."""
    e, motion = partition(name)
    reduced = motion.apply(e).with_rows([])
    u_rate = accelerations(reduced)
    computed, expected = evaluated(
        reduced,
        [
            ca.substitute(motion.old_a, motion.a, u_rate),
            motion.seen(e, accelerations_of(name))[: e.speed_count],
        ],
        general_state(reduced, 5, name),
    )
    np.testing.assert_allclose(computed, expected, atol=TOLERANCE * (1 + np.abs(expected).max()))


@pytest.mark.parametrize("name", sampled(CONSTRAINED, 5))
def test_consistent_speeds(name):
    """(6.11) keeps admissible speeds, and turns others into the nearest in the metric of M."""
    model = model_of(name)
    e, motion = partition(name)
    v = ca.SX.sym("v", e.speed_count)
    d, mass, c = motion.basis, e.mass, e.jacobian
    u = consistent_speeds(mass, d, v)
    consistent = consistent_speeds(mass, d, ca.mtimes(d, motion.v)) - motion.v
    leaning = ca.mtimes([d.T, mass, v - ca.mtimes(d, u)])  # what is taken off is orthogonal
    outputs = [consistent, leaning, ca.densify(ca.mtimes([c, d, u]))]
    function = ca.Function("speeds", [e.t, e.y, motion.v, v, e.p], outputs)
    rng = np.random.default_rng(8)
    values = [rng.standard_normal(x.numel()) for x in (motion.v, v)]
    for residual in function(0.0, model.start.y, *values, model.nominal):
        assert np.abs(residual.full()).max(initial=0) < 1e-9


def test_consistent_speeds_of_a_pendulum():
    """A bob thrown at (1, 2) m/s on a thread along (4, 3)/5 keeps its part across the thread."""
    mass, across = ca.SX(ca.DM([[2, 0], [0, 2]])), ca.SX(ca.DM([-0.6, 0.8]))
    u = consistent_speeds(mass, across, ca.SX(ca.DM([1.0, 2.0])))
    assert float(u) == pytest.approx(-0.6 + 1.6)


def test_more_coordinates_than_speeds():
    """An angle told by its cosine and sine, as Euler parameters tell an attitude: A is 2 × 1."""
    y, v, a, t = ca.SX.sym("y", 2), ca.SX.sym("v"), ca.SX.sym("a"), ca.SX.sym("t")
    none, angle = ca.SX(0, 1), ca.SX.sym("angle")
    e = Equations(
        t=t,
        y=y,
        v=v,
        p=none,
        a=a,
        multiplier=none,
        pose_rate=ca.vertcat(-y[1], y[0]) * v,
        inertia=BlockInertia(2 * ca.SX.eye(1)),
        bias=ca.SX.zeros(1),
        force=-6 * y[1],
        constraints=none,
        potential=-6 * y[0],
        powers=ca.SX.zeros(2),
    )
    new = change_coordinates(e, ca.vertcat(ca.cos(angle), ca.sin(angle)), angle)
    outputs = [new.pose_rate, new.mass, new.force - new.bias, new.potential]
    function = ca.Function("f", [new.y, new.v], outputs)
    computed = [float(out) for out in function(0.3, 0.7)]
    np.testing.assert_allclose(computed, [0.7, 2, -6 * np.sin(0.3), -6 * np.cos(0.3)], rtol=1e-14)


# wrong input ---------------------------------------------------------------------------------


def test_wrong_shapes_and_symbols_are_refused():
    e = model_of("revolute").equations
    u = ca.SX.sym("u", 2)
    with pytest.raises(da.ModelError, match=r"\(6, 2\) is needed"):
        change_speeds(e, ca.SX.eye(6), u)
    with pytest.raises(da.ModelError, match="depends on speeds"):
        change_speeds(e, ca.SX.ones(6, 2) * e.v[0], u)
    with pytest.raises(da.ModelError, match="drift"):
        change_speeds(e, ca.SX.ones(6, 2), u, ca.SX.ones(5))
    with pytest.raises(da.ModelError, match=r"\(6, 1\) is needed"):
        change_coordinates(e, ca.SX.ones(4), u)
    with pytest.raises(da.ModelError, match="old ones"):
        change_coordinates(e, e.y, u)
    for name in WITH_STATES:
        with pytest.raises(da.ModelError, match="states of elements"):
            other_coordinates(name)
    with pytest.raises(da.ModelError, match="name 4 independent ones"):
        speeds_by_partition(e, [0, 1, 2])
