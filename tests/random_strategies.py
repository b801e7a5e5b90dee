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
LEVELS = (da.Dae(index=2), da.Dae(index=2, stabilized=True), da.Dae(index=1))
EVERY_FORMULATION = (*FORMULATIONS.values(), *SOFT.values(), *LEVELS)
STEP, STEPS = 0.01, 10
EQUATIONS = ("Φ", "Ψ", "C v̇ − ξ", "M v̇ − f")
EXACT, NEARLY = 1e-6, 0.1
"""Of the size of the terms: where a level is held, and where it is so nearly only."""


def random_choices(rng: np.random.Generator) -> dict:
    return {
        "coordinates": COORDINATES[rng.integers(len(COORDINATES))],
        "formulation": EVERY_FORMULATION[rng.integers(len(EVERY_FORMULATION))],
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
    kind, m = random_mechanism(seed)
    rng = np.random.default_rng([seed, 1])
    try:
        model = m.system.build()
    except da.DalembertError as error:
        return Judged(seed, kind, {}, type(error).__name__, str(error))
    for _ in range(tries):
        choices = random_choices(rng)
        try:
            motion = da.solve_dynamics(model, STEP * STEPS, step=STEP, outputs=3, **choices)
        except da.UnsupportedError:
            continue
        except da.DalembertError as error:
            return Judged(seed, kind, choices, type(error).__name__, str(error))
        if not motion.status.success:
            return Judged(seed, kind, choices, motion.status.outcome.name, motion.status.message)
        return Judged(seed, kind, choices, "completed", "", tuple(faults(m, motion)))
    return Judged(seed, kind, {}, "UnsupportedError")


def faults(m: Mechanism, motion) -> list[str]:
    """What the twin says against a motion."""
    found, a = [], motion.analysis
    projected = isinstance(a.stabilization, da.Projection)
    soft = isinstance(a.formulation, da.Penalty)
    fed_back = isinstance(a.stabilization, da.Baumgarte)
    redundant = bool(motion.model.diagnosis.redundancies) and not projected
    exactness = (
        EXACT if projected else NEARLY,
        EXACT if projected else NEARLY,
        NEARLY if soft or fed_back or redundant else 1e2 * EXACT,
        EXACT,
    )
    s = motion.trajectory
    for k, t in enumerate(s.t):
        shares = open_shares(m, t, s.y[:, k], s.v[:, k], s.a[:, k], s.multiplier[:, k])
        for name, share, limit in zip(EQUATIONS, shares, exactness, strict=True):
            if not share <= limit:
                found.append(f"{name} open by {share:.2g} at {t:g} s")
    energy = np.array([m.kinetic(v) + m.potential(y) for y, v in zip(s.y.T, s.v.T, strict=True)])
    told = motion.values("kinetic_energy") + motion.values("potential_energy")
    if not np.allclose(energy, told, rtol=1e-9, atol=1e-9):
        found.append(f"energy is {energy - told} off")
    total = energy - energy[0] + s.work[0] - s.work[1]
    kinetic = max(m.kinetic(v) for v in s.v.T)
    moved = kinetic + np.abs(energy - energy[0]).max() + np.abs(s.work).sum(axis=0).max()
    if not np.abs(total).max() <= 0.5 * moved + 1e-6:
        found.append(f"energy balance open by {np.abs(total).max():.2g} of {moved:.2g} J")
    return found


def open_shares(m: Mechanism, t: float, y, v, a, multiplier) -> tuple[float, ...]:
    """Residuals of positions, speeds, accelerations and forces, over the size of their terms."""
    jacobian = complex_step(lambda x: m.constraints(x, t), y)
    if not jacobian.size:
        jacobian = np.zeros((0, y.size))
    positions = m.constraints(y, t)
    speeds = rate(lambda s: m.constraints(y + s * v, t + s))
    way = 2e-3 / (1 + np.abs(v).max(initial=0.0))  # differences see fast motions, too
    accelerations = second_rate(lambda s: m.constraints(y + s * v + s**2 / 2 * a, t + s), way)
    force, pull = m.forces(y, v, t), jacobian.T @ multiplier
    push = np.array(m.masses) * a
    return (
        largest(positions, 1.0),
        largest(speeds, 1 + np.abs(jacobian) @ np.abs(v)),
        largest(accelerations, 1 + np.abs(jacobian) @ np.abs(a) + np.abs(v).max() ** 2),
        largest(
            push - force + pull,
            1 + np.abs(push) + np.abs(force) + np.abs(jacobian.T) @ np.abs(multiplier),
        ),
    )


def largest(residual: np.ndarray, terms) -> float:
    shares = np.abs(residual) / terms
    return float(np.max(np.where(np.isfinite(shares), shares, np.inf), initial=0.0))
