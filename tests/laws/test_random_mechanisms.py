"""Identities that hold for any mechanism, on random trees of bars with springs."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings, strategies as st
from newton_euler import Snapshot
from twins import cross

import dalembert as da
from dalembert import planar

GRAVITY = (0.3, -9.81)
counts = st.integers(2, 5)
seeds = st.integers(0, 10_000)


def tree(count: int, seed: int, pinned: bool) -> da.System:
    """Bars, each pinned to the end of an earlier one, and springs between random points."""
    rng = np.random.default_rng(seed)
    system = da.System("tree", gravity=GRAVITY if pinned else None)
    bars: list[planar.Bar] = []
    for k in range(count):
        bar = planar.Bar(
            f"bar{k}",
            length=rng.uniform(0.4, 0.9),
            mass=rng.uniform(0.5, 2.0),
            angle=rng.uniform(-3, 3),
            angular_velocity=rng.uniform(-1, 1),
        )
        parent = bars[rng.integers(k)] if k else None
        bars.append(system.add(bar))
        if parent is not None:
            system.add(planar.Revolute(f"pin{k}", parent.end, bar.start))
        elif pinned:
            system.add(
                planar.Revolute("pin0", system.ground.point(*rng.uniform(-1, 1, 2)), bar.start)
            )
    for k in range(1, count):
        system.add(
            planar.Spring(
                f"spring{k}",
                bars[rng.integers(k)].start,
                bars[k].point(0.05, rng.uniform(0.6, 0.9)),
                stiffness=rng.uniform(5, 20),
                free_length=rng.uniform(0.1, 0.4),
            )
        )
    return system


def run(count: int, seed: int, pinned: bool):
    motion = da.solve_dynamics(
        tree(count, seed, pinned).build(),
        0.3,
        integrator=da.DormandPrince(1e-11, 1e-11),
        outputs=np.linspace(0, 0.3, 4),
    )
    assert motion.status.success
    return motion


def springs(now: Snapshot) -> list[tuple]:
    """Forces of all springs, by hand."""
    found = []
    for spring in (e for e in now.model.forces if isinstance(e, planar.Spring)):
        i, j = (now.frame(p.body).at(now.number(p.local)) for p in (spring.point_i, spring.point_j))
        s = np.linalg.norm(j - i)
        tension = float(now.number(spring.stiffness)[0]) * (
            s - float(now.number(spring.free_length)[0])
        )
        pull = tension * (i - j) / s
        found += [
            (spring.point_j.body.name, pull, j, 0.0),
            (spring.point_i.body.name, -pull, i, 0.0),
        ]
    return found


def with_springs(motion, k: int) -> Snapshot:
    now = Snapshot(motion, k)
    now.case.loads = lambda seen: springs(now)
    return now


@settings(max_examples=12)
@given(count=counts, seed=seeds)
def test_energy_of_a_pinned_tree_is_constant(count, seed):
    energy = run(count, seed, True).data.energy.values
    np.testing.assert_allclose(energy, energy[0], atol=1e-8 * (1 + np.abs(energy).max()))


@settings(max_examples=12)
@given(count=counts, seed=seeds)
def test_momentum_of_a_free_tree_is_constant(count, seed):
    """Linear momentum and moment of momentum about the origin."""
    motion = run(count, seed, False)
    totals = []
    for k in range(4):
        now, total = Snapshot(motion, k), np.zeros(3)
        for body in motion.model.bodies:
            frame = now.frame(body)
            mass, inertia = (float(now.number(q)[0]) for q in (body.mass, body.inertia))
            spin = inertia * frame.w + mass * cross(frame.r, frame.v)
            total += np.append(mass * frame.v, spin)
        totals.append(total)
    np.testing.assert_allclose(totals, np.tile(totals[0], (4, 1)), atol=1e-9)


@settings(max_examples=12)
@given(count=counts, seed=seeds, pinned=st.booleans())
def test_reactions_balance_every_bar(count, seed, pinned):
    motion = run(count, seed, pinned)
    for k in (0, 3):
        now = with_springs(motion, k)
        limit = 1e-9 * (1 + np.abs(now.data.multiplier.values).max())
        assert now.imbalance(GRAVITY if pinned else (0.0, 0.0)) < limit
