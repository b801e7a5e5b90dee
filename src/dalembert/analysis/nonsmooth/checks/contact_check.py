"""Check of the result of a nonsmooth analysis: joints, gaps, energy, and warnings."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from dalembert.analysis.dynamics.residual_check import DRIFT, DRIFT_WARNING, EnergyBalance
from dalembert.analysis.model_residuals import Violation
from dalembert.analysis.nonsmooth.checks.alternating_forces import alternation_warnings
from dalembert.analysis.nonsmooth.checks.coarse_beams import coarse_beam_warnings
from dalembert.analysis.nonsmooth.checks.contact_durations import duration_warnings
from dalembert.analysis.nonsmooth.checks.early_impacts import early_impact_warnings
from dalembert.analysis.nonsmooth.checks.gained_energy import gain_warnings
from dalembert.analysis.nonsmooth.checks.interrupted_contacts import interruption_warnings
from dalembert.analysis.nonsmooth.checks.lifted_bodies import lifting_warnings
from dalembert.analysis.nonsmooth.checks.missing_rebounds import rebound_warnings
from dalembert.analysis.nonsmooth.checks.quick_rotations import rotation_warnings
from dalembert.analysis.nonsmooth.checks.simultaneous_impacts import simultaneous_impact_warnings
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.correction_work import CorrectionWork
from dalembert.analysis.nonsmooth.starts.touching_shapes import bodies_of
from dalembert.analysis.residual_check import EXACT, ResidualCheck
from dalembert.formulations.base import Level
from dalembert.results.nonsmooth_motion import ContactRecord
from dalembert.results.status import Outcome, Status


class ContactCheck(ResidualCheck):
    """Check of joints and gaps at the ends of all steps; forces, means over steps, are not checked.

    Parameters
    ----------
    step : ContactStep of the run
    record : ContactRecord of the run
    balance : largest error of the energy, relative to the exchanged energy
    corrections : work of the corrections of positions
    """

    def __init__(
        self,
        step: ContactStep,
        record: ContactRecord,
        balance: float,
        corrections: CorrectionWork,
    ):
        super().__init__(step.model, record.ends, step.p, (Level.POSITION, Level.SPEED), np.inf)
        self.step, self.record, self.balance = step, record, balance
        self.corrections = corrections

    def verify(self, status: Status) -> Status:
        """As of every run; a failure of the first step names an overlap at the start."""
        overlaps = self.record.t.size == 1 and self.deepest.share > DRIFT
        if status.success or not overlaps:
            return super().verify(status)
        return replace(status, message=f"{self.deepest.text}{self.cure(DRIFT)}")

    @property
    def residual(self) -> float:
        """The largest violation of a joint or a gap [m]."""
        joints = self.residuals.violations.max(initial=0.0)
        return float(max(joints, self.record.penetration.max()))

    @cached_property
    def deepest(self) -> Violation:
        """The deepest penetration, by the size of the bodies, except rounding of the start."""
        model, penetration = self.step.model, np.array(self.record.penetration)
        if penetration[0] <= self.step.rounded_overlap:
            penetration[0] = 0.0
        k = int(np.argmax(penetration))
        depth = float(penetration[k])
        if depth == 0:
            return Violation(0.0)
        t, none = float(self.record.t[k]), np.zeros((model.equations.speed_count, 1))
        at = self.step.at(t, self.record.ends.y[:, k])
        contacts = self.step.rigid(self.step.near(at, none))
        deepest = int(np.argmin(contacts.distance))
        name, bodies = (
            self.record.names[contacts.owner[deepest]],
            bodies_of(model, contacts, deepest),
        )
        text = f"a gap of {name} is {-depth:.3g} m at t = {t:.9g} s, between {bodies}"
        if k == 0:
            text = f"{bodies} of {name} overlap by {depth:.3g} m at the start"
        return Violation(depth / self.step.length, text)

    @cached_property
    def energy(self) -> EnergyBalance:
        """Energies at the ends of the steps, and the dissipation of contacts."""
        record = self.record
        energies, natural = self.residuals.energies.copy(), self.step.model.scales.energy
        energies[1] += record.stored
        return EnergyBalance(energies, record.ends.work, record.t, natural)

    @property
    def limit(self) -> float:
        """Largest accepted penetration; larger where the scheme does not correct positions."""
        return EXACT[Level.POSITION] if self.step.scheme.projection else DRIFT

    def cure(self, limit: float) -> str:
        if self.starts_open:
            return "; use a shorter step"
        return "; move them apart by this depth along the normal of the contact"

    @property
    def starts_open(self) -> bool:
        """Whether the deepest penetration is not that of the start."""
        depths = self.record.penetration
        rounded = depths[0] <= self.step.rounded_overlap
        return bool(rounded or depths.max() > depths[0])

    @property
    def objection(self) -> tuple[Outcome, str] | None:
        """Outcome and reason where the run does not count as completed; None otherwise."""
        if violated := super().objection:
            return violated
        if not self.deepest.share <= self.limit:
            text = f"{self.deepest.text}, {self.deepest.share:.2g} of the size of the bodies"
            return Outcome.VIOLATED, text + self.cure(self.limit)
        work = f"corrections of positions did {self.corrections.total:.3g} J of work"
        return self.energy.objection(self.balance, f"{work}; use a shorter step")

    @property
    def warnings(self) -> list[str]:
        """Warnings about a run that counts as completed."""
        record = self.record
        warnings = self.energy.warnings(self.balance)
        balanced = self.energy.objection(self.balance, "") is None
        if balanced and not warnings:
            energies = self.corrections, record, self.energy.moved
            warnings = lifting_warnings(*energies, self.starts_open)
            if not (warnings or self.step.scheme.anticipates):
                warnings = interruption_warnings(self.step, record)
        if DRIFT_WARNING < self.deepest.share <= self.limit:
            warnings.append(
                f"{self.deepest.text}: positions are not corrected{self.cure(self.limit)}, "
                "or use projection=True"
            )
        missed = np.flatnonzero(~record.converged)
        if missed.size:
            worst = missed[np.argmax(record.residual[missed])]
            warnings.append(
                f"in {missed.size} of {record.converged.size} steps the impulses have residuals "
                f"above the tolerance, at most {record.residual[worst]:.2g} m/s at "
                f"t = {record.t[worst]:.9g} s; give ContactSolver a larger tolerance, or a smaller "
                "value of acceptable to end such runs"
            )
        warnings += gain_warnings(self.step, record, self.energy.moved)
        warnings += duration_warnings(record, self.energy.moved)
        warnings += rotation_warnings(self.step, record)
        warnings += simultaneous_impact_warnings(self.step, record, self.energy.moved)
        warnings += coarse_beam_warnings(self.step, record)
        if self.step.scheme.anticipates:
            warnings += alternation_warnings(record)
            warnings += early_impact_warnings(self.step, record, self.energy.moved)
        return warnings + rebound_warnings(self.step, record, self.energy.moved)
