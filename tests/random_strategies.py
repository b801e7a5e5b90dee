"""Random strategies for random mechanisms, and their runs checked by the mechanics of the twin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from random_mechanisms import Mechanism, random_mechanism
from registry import FORMULATIONS, INTEGRATORS, SOFT, STABILIZATIONS
from twins import complex_step, rate, second_rate

import dalembert as da

COORDINATES = (
    da.AbsoluteCoordinates(),
    da.JointCoordinates(),
    da.JointCoordinates(angles="absolute"),
    da.JointCoordinates(reactions="projected"),
)
LEVELS = (da.DAE(index=2), da.DAE(index=2, stabilized=True), da.DAE(index=1))
EVERY_FORMULATION = (*FORMULATIONS.values(), *SOFT.values(), *LEVELS)
COSTLY = da.NullSpace("svd")
"""Its graph is ten times as large as others: seldom enough that it takes no third of all time."""
STEP, STEPS = 0.01, 10
EQUATIONS = ("Φ", "Ψ", "C v̇ − ξ", "C v̇ − ξ as fed back", "M v̇ − f")
EXACT, NEARLY = 1e-6, 0.1
"""Of the size of the terms: where a level is held, and where it is so nearly only."""


def random_choices(rng: np.random.Generator) -> dict:
    formulation = EVERY_FORMULATION[rng.integers(len(EVERY_FORMULATION))]
    if formulation == COSTLY and rng.random() < 0.7:
        formulation = da.NullSpace()
    return {
        "coordinates": COORDINATES[rng.integers(len(COORDINATES))],
        "formulation": formulation,
        "stabilization": list(STABILIZATIONS.values())[rng.integers(len(STABILIZATIONS))],
        "integrator": list(INTEGRATORS.values())[rng.integers(len(INTEGRATORS))],
    }


@dataclass
class Judged:
    """How a run of a random mechanism went.

    Attributes
    ----------
    verdict : "completed", or the kind of error or status that ended it
    faults : what the twin says against a run that was completed
    """

    seed: int
    kind: str
    choices: dict
    verdict: str
    message: str = ""
    faults: tuple[str, ...] = ()

    def __str__(self) -> str:
        return (
            f"{self.seed} {self.kind} {self.choices}: {self.verdict} {self.message} {self.faults}"
        )


def judged(seed: int, tries: int = 20) -> Judged:
    """Run a random mechanism by strategies that can work together; errors that are typed count."""
    return judged_mechanism(seed, *random_mechanism(seed), tries)


def judged_mechanism(seed: int, kind: str, m: Mechanism, tries: int = 20) -> Judged:
    """The same of a mechanism from elsewhere."""
    rng = np.random.default_rng([seed, 1])
    try:
        model = m.system.build()
    except da.DalembertError as error:
        return Judged(seed, kind, {}, type(error).__name__, str(error))
    refusal = ""
    for choices in [*(random_choices(rng) for _ in range(tries)), {}]:  # at last the defaults
        try:
            motion = da.solve_dynamics(model, STEP * STEPS, step=STEP, outputs=3, **choices)
        except da.UnsupportedError as error:
            refusal = str(error)
            continue
        except da.DalembertError as error:
            return Judged(seed, kind, choices, type(error).__name__, str(error))
        if not motion.status.success:
            return Judged(seed, kind, choices, motion.status.outcome.name, motion.status.message)
        return Judged(seed, kind, choices, "completed", "", tuple(faults(m, motion)))
    return Judged(seed, kind, {}, "UnsupportedError", refusal)


def faults(m: Mechanism, motion) -> list[str]:
    """What the twin says against a motion."""
    results, s = [], motion.trajectory
    table = [terms_of(m, motion, k) for k in range(s.t.size)]
    for n, (name, limit) in enumerate(zip(EQUATIONS, limits(motion), strict=True)):
        residuals, sizes = (np.array([row[n][part] for row in table]) for part in (0, 1))
        if limit == NEARLY:
            sizes = sizes_of_what_moves(motion, sizes, n)
        shares = np.abs(residuals) / (sizes if limit == NEARLY else 1 + sizes)
        shares = np.where(np.isfinite(shares), shares, np.inf).max(axis=1, initial=0.0)
        k = int(np.argmax(shares))
        if not shares[k] <= limit:
            results.append(f"{name} open by {shares[k]:.2g} at {s.t[k]:g} s")
    return results + gap_faults(m, motion) + energy_faults(m, motion)


def limits(motion) -> tuple[float, ...]:
    """How far positions, speeds, accelerations, those as fed back, and forces may be open."""
    a, redundancies = motion.analysis, motion.model.diagnosis.redundancies
    projected = isinstance(a.stabilization, da.Projection)
    soft = isinstance(a.formulation, da.Penalty)
    fed_back = isinstance(a.stabilization, da.Baumgarte)
    redundant = bool(redundancies) and not projected
    drifts = EXACT if projected else NEARLY
    sharp = NEARLY if soft or redundant else 1e2 * EXACT
    return drifts, drifts, NEARLY if fed_back else sharp, sharp, EXACT


def sizes_of_what_moves(motion, sizes: np.ndarray, level: int) -> np.ndarray:
    """Of a constraint that drifts: lengths, and the largest term of any constraint at any time."""
    scales = motion.model.scales
    if not level or not sizes.size:
        return scales.rows
    least = 1e-3 * scales.time ** -min(level, 2)
    return scales.rows * max((sizes / scales.rows).max(), least)


def gap_faults(m: Mechanism, motion) -> list[str]:
    open_by = [float(gap(m.frames(y))) for gap in m.gaps for y in motion.trajectory.y.T]
    return [f"gap open by {least:.2g} m" for least in open_by if not least >= -EXACT]


def energy_faults(m: Mechanism, motion) -> list[str]:
    results, s = [], motion.trajectory
    states = list(zip(s.y.T, s.v.T, strict=True))
    energy = np.array([m.kinetic(y, v) + m.potential(y) for y, v in states])
    stored = motion.values("kinetic_energy") + motion.values("potential_energy")
    if not np.allclose(energy, stored, rtol=1e-9, atol=1e-9):
        results.append(f"energy is {energy - stored} off")
    total = energy - energy[0] + s.work[0] - s.work[1]
    kinetic = max(m.kinetic(y, v) for y, v in states)
    moved = kinetic + np.abs(energy - energy[0]).max() + np.abs(s.work).sum(axis=0).max()
    if not np.abs(total).max() <= 0.5 * moved + 1e-6:
        results.append(f"energy balance open by {np.abs(total).max():.2g} of {moved:.2g} J")
    return results


def terms_of(m: Mechanism, motion, k: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Residuals of positions, speeds, accelerations, those as fed back, and forces; their terms."""
    s, feedback = motion.trajectory, motion.analysis.stabilization.feedback or (0.0, 0.0)
    t, y, v, a, multiplier = s.t[k], s.y[:, k], s.v[:, k], s.a[:, k], s.multiplier[:, k]
    rows = multiplier.size - len(m.gaps)  # the pressures of gaps are behind them
    multiplier, pressure = multiplier[:rows], multiplier[rows:]
    assert not pressure.any()  # nothing stays on a level that it bounces off
    jacobian = complex_step(lambda x: m.constraints(x, t), y).reshape(multiplier.size, y.size)
    size = np.abs(jacobian)
    positions = m.constraints(y, t)
    speeds = rate(lambda s: m.constraints(y + s * v, t + s)) + np.zeros(multiplier.size)
    way = 2e-3 / (1 + np.abs(v).max(initial=0.0))  # differences see fast motions, too
    xi = -second_rate(lambda s: m.constraints(y + s * v, t + s), way)
    accelerations = jacobian @ a - xi
    drawn = size @ np.abs(a) + np.abs(xi)
    force, pull, push = m.forces(y, v, t), jacobian.T @ multiplier, m.taken(y, v, a)
    return [
        (positions, np.zeros(multiplier.size)),
        (speeds, size @ np.abs(v)),
        (accelerations, drawn),
        (accelerations + feedback[0] * speeds + feedback[1] * positions, drawn),
        (push - force + pull, np.abs(push) + np.abs(force) + size.T @ np.abs(multiplier)),
    ]
