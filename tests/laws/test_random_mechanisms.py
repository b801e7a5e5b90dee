"""Identities on random trees of bars with springs; mechanisms of all kinds by random choices.

``pytest -m thorough tests/laws/test_random_mechanisms.py`` tries more of them.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from newton_euler import Snapshot
from random_mechanisms import random_mechanism
from random_strategies import faults, judged
from thorough import sampled
from twins import cross

import dalembert as da
from dalembert import planar
from dalembert.elements.base import Constraint, ForceElement
from dalembert.elements.stateful import Stateful

MECHANISMS, PARTS = 250, 10
EQUATIONS_OR_FORCES = (Constraint, ForceElement)
GRAVITY = (0.3, -9.81)
TREES = sampled(range(12), 3)
"""Seeds of random trees."""


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


def run(seed: int, pinned: bool):
    motion = da.solve_dynamics(
        tree(2 + seed % 4, seed, pinned).build(),
        0.3,
        integrator=da.DormandPrince(1e-11, 1e-11),
        outputs=np.linspace(0, 0.3, 4),
    )
    assert motion.status.success
    return motion


def springs(now: Snapshot) -> list[tuple]:
    """Forces of all springs, by hand."""
    faults = []
    for spring in (e for e in now.model.forces if isinstance(e, planar.Spring)):
        i, j = (now.frame(p.body).at(now.number(p.local)) for p in (spring.point_i, spring.point_j))
        s = np.linalg.norm(j - i)
        tension = float(now.number(spring.stiffness)[0]) * (
            s - float(now.number(spring.free_length)[0])
        )
        pull = tension * (i - j) / s
        faults += [
            (spring.point_j.body.name, pull, j, 0.0),
            (spring.point_i.body.name, -pull, i, 0.0),
        ]
    return faults


def with_springs(motion, k: int) -> Snapshot:
    now = Snapshot(motion, k)
    now.case.loads = lambda seen: springs(now)
    return now


@pytest.mark.few(2)
@pytest.mark.parametrize("seed", TREES)
def test_energy_of_a_pinned_tree_is_constant(seed):
    energy = run(seed, True).data.energy.values
    np.testing.assert_allclose(energy, energy[0], atol=1e-8 * (1 + np.abs(energy).max()))


@pytest.mark.few(2)
@pytest.mark.parametrize("seed", TREES)
def test_momentum_of_a_free_tree_is_constant(seed):
    """Linear momentum and moment of momentum about the origin."""
    motion = run(seed, False)
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


@pytest.mark.few(3)
@pytest.mark.parametrize("pinned", [False, True])
@pytest.mark.parametrize("seed", TREES)
def test_reactions_balance_every_bar(seed, pinned):
    motion = run(seed, pinned)
    for k in (0, 3):
        now = with_springs(motion, k)
        limit = 1e-9 * (1 + np.abs(now.data.multiplier.values).max())
        assert now.imbalance(GRAVITY if pinned else (0.0, 0.0)) < limit


# all kinds of mechanisms and strategies ----------------------------------------------------------


@pytest.mark.thorough
@pytest.mark.parametrize("part", sampled(range(PARTS), PARTS))
def test_completed_runs_are_correct(part):
    """Open, closed, redundant, massless, driven; sprung, stopped, loaded: the twin finds no fault.

    A run may end otherwise where there is a reason, and says it.
    """
    verdicts: Counter[str] = Counter()
    for seed in range(part, MECHANISMS, PARTS):
        verdict = judged(seed)
        assert not verdict.faults, str(verdict)
        assert verdict.verdict == "completed" or verdict.message, str(verdict)
        verdicts[verdict.verdict] += 1
    assert verdicts["completed"] > 0.85 * verdicts.total(), verdicts


def test_every_joint_and_force_takes_part():
    seen = {kind for seed in range(60) for kind in random_mechanism(seed)[1].kinds}
    classes = {name: getattr(planar, name) for name in planar.__all__}
    elements = {name for name, cls in classes.items() if issubclass(cls, EQUATIONS_OR_FORCES)}
    elements -= {name for name, cls in classes.items() if issubclass(cls, Stateful)}
    assert elements == seen


@pytest.mark.parametrize(
    ("field", "row", "fault"),
    [("y", 0, "Φ"), ("v", 1, "Ψ"), ("a", 0, "C v̇"), ("multiplier", 0, "M v̇")],
)
def test_the_twin_notices_what_is_wrong(field, row, fault):
    _, m = random_mechanism(5)
    motion = da.solve_dynamics(m.system.build(), 0.1, step=0.01, outputs=3)
    assert motion.status.success and not faults(m, motion)
    spoilt = getattr(motion.trajectory, field).copy()
    spoilt[row, 1] += 0.1 * (1 + np.abs(spoilt[:, 1]).max())
    motion.trajectory = replace(motion.trajectory, **{field: spoilt})
    assert any(text.startswith(fault) for text in faults(m, motion))
