"""Residual check of a dynamic run: constraints, equations of motion, energy balance."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from dalembert.analysis.contact.gap_checks import gap_violation
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.model_residuals import ModelResiduals, Violation
from dalembert.analysis.residual_check import ResidualCheck
from dalembert.errors import AnalysisError
from dalembert.formulations.base import NONE, Level
from dalembert.integrators.marching.steps import Steps
from dalembert.results.recording import Trajectory
from dalembert.results.status import Outcome

ROUNDING = 1e-9, 1e-6
"""Rounding: share of the energies themselves, and of the mechanism's natural energy."""
ENERGY_WARNING = 0.25
"""Fraction of the permitted energy error that causes a warning."""
DRIFT, DRIFT_WARNING = 0.1, 1e-2
"""Violation of approximately enforced constraints: upper limit, and threshold for a warning."""


def check_balance(balance: float) -> None:
    """Check that the permitted energy error is a positive share.

    Raises
    ------
    AnalysisError
        It is not positive.
    """
    if not balance > 0:
        raise AnalysisError(f"balance is {balance}; it must be a positive share")


class EnergyBalance:
    """``E − E₀ + dissipated − input`` along a trajectory, relative to the energy that took part.

    Parameters
    ----------
    energies : (2, K) kinetic and potential energy from the start on [J]
    work : (2, K) dissipated and put in since the start [J]
    t : (K,) [s]
    natural : energy of the mechanism's own size [J]
    """

    def __init__(self, energies: np.ndarray, work: np.ndarray, t: np.ndarray, natural: float):
        self.energies, self.work, self.t, self.natural = energies, work, t, natural

    @property
    def errors(self) -> np.ndarray:
        """(K,) energy error [J]."""
        return energy_errors(self.energies, self.work)

    @property
    def moved(self) -> float:
        """The energy that took part: kinetic, of storages since the start, dissipated, put in."""
        return float(energy_moved(self.energies, self.work, self.natural))

    @cached_property
    def worst(self) -> tuple[float, float, float]:
        """Largest error over the energy that took part, the error itself [J], and its time [s]."""
        with np.errstate(all="ignore"):
            shares = np.abs(self.errors) / self.moved
        shares = np.where(np.isfinite(shares), shares, np.inf)
        k = int(np.argmax(shares))
        return float(shares[k]), float(self.errors[k]), float(self.t[k])

    def objection(self, limit: float, cure: str) -> tuple[Outcome, str] | None:
        """Outcome and message if the error exceeds a share ``limit`` of the energy, else None."""
        if self.worst[0] <= limit:
            return None
        return Outcome.UNBALANCED, f"{self.text}; {cure}"

    def warnings(self, limit: float) -> list[str]:
        """Warning about an error within the limit."""
        if not ENERGY_WARNING * limit < self.worst[0] <= limit:
            return []
        return [f"{self.text}; the steps are long for this motion"]

    @property
    def text(self) -> str:
        """The largest error in words."""
        share, error, time = self.worst
        verb = "appeared" if error > 0 else "vanished"
        return (
            f"{abs(error):.3g} J {verb} by t = {time:.9g} s, {share:.0%} of the {self.moved:.3g} J "
            "that took part in the motion"
        )


def energy_errors(energies: np.ndarray, work: np.ndarray) -> np.ndarray:
    """(…, K) energy error [J] from arrays (…, 2, K) as in ``EnergyBalance``."""
    total = energies.sum(axis=-2) + work[..., 0, :] - work[..., 1, :]
    return np.asarray(total - total[..., :1])


def energy_moved(energies: np.ndarray, work: np.ndarray, natural: float) -> np.ndarray:
    """(…,) energy that took part [J]."""
    kinetic, potential = energies[..., 0, :], energies[..., 1, :]
    parts = (kinetic, potential - potential[..., :1], work[..., 0, :], work[..., 1, :])
    least = ROUNDING[0] * np.abs(energies).max(axis=(-2, -1)) + ROUNDING[1] * natural
    return np.asarray(sum(np.abs(part).max(axis=-1) for part in parts) + least)


class DynamicsResidualCheck(ResidualCheck):
    """Positions, speeds, accelerations, forces and energies of a run against the model equations.

    Parameters
    ----------
    kernel, steps, trajectory : of the run
    p : (np,) parameters
    balance : largest permitted energy error, relative to the energy that took part
    """

    def __init__(
        self,
        kernel: DynamicsKernel,
        steps: Steps,
        trajectory: Trajectory,
        p: np.ndarray,
        balance: float,
    ):
        super().__init__(kernel.model, trajectory, p)
        self.kernel, self.steps, self.s, self.p = kernel, steps, trajectory, p
        self.balance = balance
        crossings = kernel.crossings(steps)
        turns = [k for k, change in crossings if getattr(change, "turns", False)]
        self.residuals.one_sided = steps.t[turns]

    @cached_property
    def held(self) -> frozenset[Level]:
        """Levels at which all constraints are enforced exactly."""
        return held_levels(self.kernel)

    def violation(self, level: Level) -> tuple[Violation, float]:
        if level in self.held:
            return super().violation(level)
        return self.residuals.of_level(level, drifts=True), DRIFT

    def cure(self, limit: float) -> str:
        projection = ", or stabilization=Projection()" if limit == DRIFT else ""
        return f"; use a shorter step{projection}"

    @cached_property
    def energy(self) -> EnergyBalance:
        """Energy balance from the start, also where that is not an output."""
        s, steps, model = self.s, self.steps, self.kernel.model
        energies, work, t = self.residuals.energies, s.work, s.t
        if t[0] != steps.t[0]:
            mode, first = steps.mode[:1] if steps.count else np.array([0]), steps.t[:1]
            bodies = self.kernel.mapped(lambda v: v.bodies, mode, first, steps.x[:, :1], self.p)
            y, v, a, multiplier = bodies
            start = Trajectory(first, y, v, a, multiplier, np.zeros((2, 1)))
            before = ModelResiduals(model, start, self.p).energies
            energies, work = np.hstack([before, energies]), np.hstack([start.work, work])
            t = np.append(first, t)
        return EnergyBalance(energies, work, t, model.scales.energy)

    @property
    def objection(self) -> tuple[Outcome, str] | None:
        """Outcome and message if the run is not a motion of the model, else None."""
        if violated := super().objection:
            return violated
        if self.kernel.contacts is not None and Level.POSITION in self.held:
            model, checked = self.kernel.model, self.residuals.checked
            if text := gap_violation(model, checked, self.p):
                return Outcome.VIOLATED, text
        return self.energy.objection(self.balance, "use a shorter step, or another integrator")

    @property
    def warnings(self) -> list[str]:
        """Warnings about residuals within their limits."""
        warnings = [
            f"{gap.text}, {gap.share:.2g} of the size of its terms: nothing holds it there"
            for gap, limit in self.violations
            if limit == DRIFT and DRIFT_WARNING < gap.share <= DRIFT
        ]
        return warnings + self.energy.warnings(self.balance)


def held_levels(kernel: DynamicsKernel) -> frozenset[Level]:
    """Levels at which a run enforces all constraints exactly.

    Dropped redundant constraints follow from the others where the levels below are enforced.
    """
    first, stabilization = kernel.variants[0], kernel.stabilization
    fed_back = {Level.ACCELERATION} if stabilization.feedback else NONE
    held = (first.formulation.exact_levels - fed_back) | stabilization.exact_levels
    if not first.equations.dropped.numel():
        return held
    return frozenset(level for level in held if set(range(level)) <= held)
