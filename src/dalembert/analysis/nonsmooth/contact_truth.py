"""Whether steps with contacts have left a motion of the model at all."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from dalembert.analysis.contact.start import ROUNDED
from dalembert.analysis.dynamics.energy_balance import EnergyBalance
from dalembert.analysis.dynamics.truth import DRIFT, TOLD
from dalembert.analysis.model_residuals import Gap
from dalembert.analysis.model_truth import EXACT, ModelTruth
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.formulations.base import Level
from dalembert.results.contact_record import ContactRecord
from dalembert.results.status import Outcome


class ContactTruth(ModelTruth):
    """Joints and gaps at the ends of all steps; forces are means, which no instant has.

    Parameters
    ----------
    step : ContactStep of the run
    record : what it has left
    balance : largest error of the energy over the energy that took part
    """

    def __init__(self, step: ContactStep, record: ContactRecord, balance: float):
        super().__init__(step.model, record.ends, step.p, (Level.POSITION, Level.SPEED), np.inf)
        self.step, self.record, self.balance = step, record, balance

    @property
    def residual(self) -> float:
        """The largest violation of a joint or a gap [m]."""
        joints = self.residuals.violations.max(initial=0.0)
        return float(max(joints, self.record.penetration.max()))

    @cached_property
    def deepest(self) -> Gap:
        """The gap that is closed furthest, by the natural length; not by rounding of the start."""
        model, penetration = self.step.model, np.array(self.record.penetration)
        if penetration[0] <= ROUNDED * model.scales.length:
            penetration[0] = 0.0
        k = int(np.argmax(penetration))
        depth = float(penetration[k])
        if depth == 0:
            return Gap(0.0)
        t, none = float(self.record.t[k]), np.zeros((model.equations.speed_count, 1))
        found = self.step.near(t, self.record.ends.y[:, k], none)
        name = self.record.names[found.owner[np.argmin(found.distance)]]
        text = f"a gap of {name} is {-depth:.3g} m at t = {t:.9g} s"
        return Gap(depth / model.scales.length, text)

    @cached_property
    def energy(self) -> EnergyBalance:
        """Energies at the ends of the steps, and what contacts took."""
        record = self.record
        energies, natural = self.residuals.energies, self.step.model.scales.energy
        return EnergyBalance(energies, record.ends.work, record.t, natural)

    @property
    def limit(self) -> float:
        """How deep a gap may be: where none is opened, motions of half a step are."""
        return EXACT[Level.POSITION] if self.step.scheme.projection else DRIFT

    def cure(self, limit: float) -> str:
        return "; use a shorter step"

    @property
    def objection(self) -> tuple[Outcome, str] | None:
        """Why the run must not be called completed, if so."""
        if violated := super().objection:
            return violated
        if not self.deepest.share <= self.limit:
            text = f"{self.deepest.text}, {self.deepest.share:.2g} of the natural length"
            return Outcome.VIOLATED, text + self.cure(self.limit)
        return self.energy.objection(self.balance, "use a shorter step")

    @property
    def doubts(self) -> list[str]:
        """What is no reason to refuse the run, but should be known."""
        found = self.energy.doubts(self.balance)
        if TOLD < self.deepest.share <= self.limit:
            found.append(
                f"{self.deepest.text}: it is not opened; use a shorter step, or projection=True"
            )
        return found
