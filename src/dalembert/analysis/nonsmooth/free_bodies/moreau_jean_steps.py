"""Steps of free bodies by the scheme of Moreau and Jean, and corrections of their positions."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.advance import SUPPLIED
from dalembert.analysis.nonsmooth.checks.missing_impacts import SHARE as MISSING
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.correction import SHARE
from dalembert.analysis.nonsmooth.free_bodies.free_body_motion import FreeBodyMotion
from dalembert.analysis.nonsmooth.free_bodies.free_body_steps import FreeBodySteps
from dalembert.analysis.nonsmooth.free_bodies.pair_lists import RENEWALS
from dalembert.analysis.nonsmooth.free_bodies.step_arrays import stored_outputs
from dalembert.integrators.contact.places import Counts, Inputs, Outputs, Status
from dalembert.integrators.contact.schemes import ROUNDING, MoreauJean
from dalembert.integrators.contact.step_calls import Calls, StepOutcome
from dalembert.integrators.contact.step_places import Descriptions, Limits, Sizes


class MoreauJeanSteps(FreeBodySteps):
    """Arrays of the machine code, and its calls.

    Attributes
    ----------
    mass : entries of the mass matrix where the shapes are
    """

    files = "stored_contacts.c", "position_correction.c", "moreau_jean_step.c"

    def __init__(self, step: ContactStep, motion: FreeBodyMotion):
        self.mass = np.zeros(motion.columns.size)
        bodies, widest = motion.first.size - 1, motion.widest
        self._mass_inverses = np.zeros(bodies * widest**2), np.full(self.mass.size, np.nan)
        super().__init__(step, motion)

    def _scheme_limits(self, step: ContactStep) -> dict[int, float]:
        scheme = step.scheme
        assert isinstance(scheme, MoreauJean)
        return {
            **super()._scheme_limits(step),
            Limits.LEAST_TURN: np.inf,  # directions turn without a clearance
            Limits.CLEARANCE: 0.0,
            Limits.LEAST_GAP: -np.inf,
            Limits.GAMMA: scheme.gamma,
            Limits.PROJECTS: scheme.projection,
            Limits.LEAST_PENETRATION: SHARE * step.rounding / step.solver.tolerance,
            Limits.MISSED_ENERGY: MISSING,
        }

    def set_lengths(self, h: float, longest: float, rest: float) -> None:
        self.limits[Limits.LENGTH] = h

    def joined(self) -> StepOutcome:
        """The last step with the contacts that are added, from its start; its entry in the record
        replaces the last one."""
        self._sizes[Sizes.CALL] = Calls.JOINED
        outcome = self._kept_contacts()
        self._sizes[Sizes.CALL] = Calls.STEP
        return outcome

    def parted(self) -> StepOutcome:
        """The last step again without the contacts that were added last."""
        self._sizes[Sizes.CALL] = Calls.PARTED
        outcome = self._kept_contacts()
        self._sizes[Sizes.CALL] = Calls.STEP
        return outcome

    def at_end(self) -> StepOutcome:
        """Gaps at the end of the last step, where the shapes are: ``CLOSED`` if one is."""
        self._sizes[Sizes.CALL] = Calls.AT_END
        outcome = self._kept_contacts()
        self._sizes[Sizes.CALL] = Calls.STEP
        return outcome

    def correction(self) -> StepOutcome:
        """``CLOSED`` if a gap is closed where the shapes are, with the displacement that opens it;
        other lists of pairs and orders of elimination are made where these are needed."""
        self._sizes[Sizes.CALL] = Calls.CORRECTION
        outcome = self()
        self._sizes[Sizes.CALL] = Calls.STEP
        return outcome

    def _kept_contacts(self) -> StepOutcome:
        """A call that refers to the contacts of the call before, which new memory does not hold."""
        stored = self._stored
        for _ in range(RENEWALS):
            assert self._loop is not None
            self._loop()
            outcome = StepOutcome(int(self.counts[Counts.OUTCOME]))
            if outcome is StepOutcome.OUTDATED and np.isfinite(self._status[Status.REACH]):
                super()._renew_list(float(self._status[Status.REACH]))
                described = stored[: self._sizes[Sizes.STORED]]
                if not self.pair_numbers(
                    self._pairs[:2, : self.counts[Counts.PAIRS]], described
                ).all():
                    break
            elif outcome is StepOutcome.UNORDERED:
                self._renew_order()
            elif outcome is StepOutcome.MORE:
                self._reserve(int(self.counts[Counts.CONTACTS]))
            else:
                return outcome
            if self._stored is not stored:
                break
        return StepOutcome.UNSOLVED

    @property
    def adds(self) -> bool:
        """Whether contacts are added."""
        return bool(self._sizes[Sizes.ADDED]) or self.adds_others

    @property
    def adds_others(self) -> bool:
        """Whether these are of features that are not near each other at the start of the step,
        where the shapes have to be in the next call."""
        return bool(self._sizes[Sizes.OTHERS])

    @property
    def misses(self) -> bool:
        """Whether the step may miss an impact: shapes pass through each other, or overlap and part
        again."""
        return bool(self._sizes[Sizes.MISSES])

    @property
    def deepest(self) -> float:
        """The smallest gap where the shapes are [m]."""
        return float(self._status[Status.DEEPEST])

    def allowed_work(self, depth: float) -> float:
        """Work of contacts that may result from rounding and from the residual of the impulses of
        the last step, or is little beside that of a correction of the penetration ``depth``,
        without the added contacts [J]."""
        residual = self._status[Status.RESIDUAL] if self.counts[Counts.CONTACTS] else 0.0
        error = max(residual, SUPPLIED * depth / self.limits[Limits.LENGTH])
        return float(
            ROUNDING * self._status[Status.EXCHANGED] + error * self._status[Status.PUSHES]
        )

    def _ordered_pairs(self) -> np.ndarray:
        """Those of all contacts near each other at the start of the step, too, as the active ones
        change within it."""
        stored = self._stored[: self._sizes[Sizes.STORED], Descriptions.PAIR]
        return np.concatenate([super()._ordered_pairs(), stored])

    def _renew_list(self, reach: float) -> None:
        self._sizes[Sizes.STORED] = 0  # their pairs have other numbers
        super()._renew_list(reach)

    def _lasting_inputs(self) -> dict[int, np.ndarray]:
        return {**super()._lasting_inputs(), Inputs.MASS: self.mass}

    def _lasting_outputs(self, contacts: int) -> dict[int, np.ndarray]:
        stored = stored_outputs(contacts, self.width, self._motion.widest)
        self._sizes[Sizes.STORED], self._stored = 0, stored[Outputs.STORED_DESCRIPTIONS]
        return {
            **super()._lasting_outputs(contacts),
            **stored,
            Outputs.END_SPEEDS: np.zeros(self.v.size),
            Outputs.MASS_INVERSES: self._mass_inverses[0],
            Outputs.LAST_MASS: self._mass_inverses[1],
        }
