"""Steps of a nonsmooth run, linearised with the contact states of the run."""

from __future__ import annotations

from functools import cached_property
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from dalembert.analysis.nonsmooth.active_contacts import ActiveContacts
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.correction import SETTINGS
from dalembert.analysis.nonsmooth.mobility import delassus
from dalembert.analysis.nonsmooth.nonsmooth_run import NonsmoothRun
from dalembert.analysis.nonsmooth.speed_jumps import speed_jumps
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.integrators.contact.approach import Approach
from dalembert.integrators.contact.contact_laws import FIRST, IMPACT
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.results.nonsmooth_motion import NonsmoothMotion
from dalembert.sensitivity.nonsmooth.contact_changes import ContactChanges
from dalembert.sensitivity.nonsmooth.contact_equations import STICK_MARGIN
from dalembert.sensitivity.nonsmooth.contact_maps import ContactMaps
from dalembert.sensitivity.nonsmooth.linear_map import MapAt
from dalembert.sensitivity.nonsmooth.near_impacts import times_between_impacts
from dalembert.sensitivity.nonsmooth.recorded_contacts import RecordedContacts
from dalembert.sensitivity.nonsmooth.recorded_opening import SAME, RecordedOpening
from dalembert.sensitivity.nonsmooth.stacked_impacts import StackedImpacts
from dalembert.sensitivity.nonsmooth.step_stacks import StepStacks
from dalembert.symbolic.equations import newton


class ContactSteps:
    """All steps of a run.

    Parameters
    ----------
    motion : NonsmoothMotion

    Attributes
    ----------
    changes : step → ContactChanges of the linearised steps
    growth : largest entry of a change of the state, or of its weights, in the marches so far
    """

    def __init__(self, motion: NonsmoothMotion):
        analysis: Any = motion.analysis
        self.record, self.p = motion.record, motion.parameters
        run = NonsmoothRun(analysis, motion.model, motion.parameters)
        self.step: ContactStep = run.step
        self.maps = ContactMaps(self.step)
        self.x = np.vstack([self.record.ends.y, self.record.ends.v])
        self.size = self.record.ends.y.shape[0]
        self.changes: dict[int, ContactChanges] = {}
        self.growth = 0.0
        self.contacts = RecordedContacts(self.record)

    @property
    def count(self) -> int:
        """Number of steps."""
        return self.record.t.size - 1

    def active(self, k: int) -> ActiveContacts:
        """Pressing contacts of a step; none before the first."""
        return self.contacts.of(k)

    def observe_growth(self, columns: np.ndarray) -> None:
        """Include changes of a state, or weights, in the largest growth."""
        self.growth = max(self.growth, float(np.abs(columns).max(initial=0.0)))

    @cached_property
    def times_between(self) -> np.ndarray:
        """(K,) time since the last impact of another gap on the bodies of the impacts of each step,
        in steps; infinite without any."""
        return times_between_impacts(self.maps, self.record, self.contacts)

    @cached_property
    def breaks(self) -> dict[int, np.ndarray]:
        """Step → keys of the contacts with higher static friction that slip in the next step, but
        not in this one."""
        if not self.record.key.size or not self.step.groups:
            return {}
        keys = self.contacts.all.keys
        laws, slips = self._laws(keys), self._are_slipping
        begins, owner = self.contacts.follows, self.contacts.owner
        ends = np.flatnonzero(begins >= 0)
        begins = begins[ends]
        breaks = slips[ends] & ~slips[begins] & (laws[:, FIRST - 1] > laws[:, FIRST])[ends]
        rows = begins[breaks]
        return {int(k): keys[rows[owner[rows] == k]] for k in owner[rows]}

    @cached_property
    def _are_slipping(self) -> np.ndarray:
        """(n,) mask of the sliding contacts of all steps."""
        return self._slips(self.contacts.all.keys, self.contacts.all.impulses)

    def _laws(self, key: np.ndarray) -> np.ndarray:
        """(n, c) coefficients of gaps at the start."""
        keys, laws = self._all_laws
        return laws[np.searchsorted(keys, key)]

    @cached_property
    def _all_laws(self) -> tuple[np.ndarray, np.ndarray]:
        """Keys of all pressing contacts, and (n, c) coefficients of these gaps at the start."""
        keys, start = np.unique(self.contacts.all.keys), (self.x[:, 0], float(self.record.t[0]))
        return keys, np.asarray(self.maps.gaps_at(*start, keys).values.laws)

    def _slips(self, key: np.ndarray, impulse: np.ndarray) -> np.ndarray:
        """(n,) mask of the impulses (n, k) of sliding contacts."""
        linear = 1 + sum(self.step.groups[:1])
        if linear == 1 or not key.size:
            return np.ones(key.size, dtype=bool)
        limit = self._laws(key)[:, FIRST] * impulse[:, 0]
        slip = np.linalg.norm(impulse[:, 1:linear], axis=1)
        return np.asarray(np.abs(slip - limit) <= STICK_MARGIN * limit)

    @cached_property
    def _are_single(self) -> np.ndarray:
        """(K,) mask of the steps with several solutions, which are linearised one by one: those on
        whose paths means of gaps are taken, and impacts by other laws than Newton's."""
        contacts = self.contacts.all
        single = contacts.curved.copy()
        if single.size:
            single |= self._laws(contacts.keys)[:, IMPACT] != ImpactLaw.NEWTON.number
        mask: np.ndarray = np.bincount(self.contacts.owner, single, self.count) > 0
        return mask

    @cached_property
    def stacks(self) -> StepStacks:
        """Steps whose maps are evaluated together."""
        sticks = ~self._are_slipping
        return StepStacks(self.maps, self.record, self.contacts, self._are_single, sticks)

    def stacked_impacts(self, k: int) -> tuple[StackedImpacts, int] | None:
        """Impacts that contain those of a step, and its number among them; None for steps that are
        linearised one by one."""
        return None if k in self.breaks else self.stacks.impacts_at(k)

    def split(self, k: int) -> tuple[np.ndarray, np.ndarray]:
        """``y`` and ``v`` at the start of step ``k``."""
        return self.x[: self.size, k], self.x[self.size :, k]

    def span(self, k: int) -> tuple[float, float]:
        """Start time and length of step ``k``."""
        t = self.record.t
        return float(t[k]), float(t[k + 1] - t[k])

    def at(self, k: int, whole: bool = False) -> list[MapAt]:
        """Sequence of maps of step ``k``; ``whole`` ones have no contacts on their own.

        Raises
        ------
        AnalysisError
            The maps do not reproduce the recorded step.
        """
        if (stacked := self.stacks.at(k)) is not None:
            return [stacked[0].at(stacked[1], whole=whole)]
        maps = self._maps(k)
        if not self._is_recorded(k, maps[-1].following):
            (t, h), y = self.span(k), self.record.ends.y[:, k + 1]
            if self.step.smooth.prescribes and speed_jumps(self.step, t, h, y):
                raise AnalysisError(
                    f"a prescribed speed jumps under a contact in the step at t = {t:.9g} s, which "
                    "has no gradient; give its driver a law without a kink"
                )
            raise AnalysisError(
                f"the step at t = {t:.9g} s cannot be repeated as a smooth map; "
                "give ContactSolver a smaller tolerance"
            )
        return maps

    def _is_recorded(self, k: int, end: np.ndarray) -> bool:
        """Whether a state is the recorded one at the end of step ``k``."""
        scale = np.abs(self.x[:, k : k + 2]).max(initial=0.0) + self.step.model.scales.length
        return bool(np.abs(end - self.x[:, k + 1]).max(initial=0.0) <= SAME * scale)

    def _maps(self, k: int) -> list[MapAt]:
        """Sequence of maps of a step outside of stacks: the last of its solutions, each of which
        has its means over the path of the one before, and corrections."""
        (t, h), x, path, impact = self.span(k), self.x[:, k], None, self.record.impacts[k]
        for solution in self.record.paths[k].solutions:
            means = path, solution.curved, solution.impact
            path = self.maps.step(x, solution.v, t, h, solution.active, *means)
        active, after = self.active(k), self.x[self.size :, k + 1]
        if self._is_mixed(k, active):
            raise UnsupportedError(
                f"rigid contacts along curved paths act with contacts with a force law in the step "
                f"at t = {t:.9g} s: no gradient; give them all force laws, or none"
            )
        means = path, self.record.paths[k].curved, impact
        maps = [self.maps.step(x, after, t, h, active.after(impact), *means)]
        recorder = RecordedOpening(self.step, t + h, self.step.scheme.projection)
        newton.solve(recorder, maps[0].following[: self.size], SETTINGS)
        for keys, lifts in recorder.active:
            presses = np.isin(keys, active.keys)
            maps.append(self.maps.opening(maps[-1].following, t + h, keys, lifts, presses))
        if self.step.smooth.has_joints:
            maps.append(self.maps.consistent(maps[-1].following, t + h))
        return maps

    def _is_mixed(self, k: int, active: ActiveContacts) -> bool:
        """Whether rigid contacts have means over a path, and compliant ones others."""
        laws, own = self.step.force_laws, active.keys[active.curved]
        if not laws.elements or not own.size:
            return False
        contacts = self.step.selected(self.step.at(self.span(k)[0], self.split(k)[0]), own)
        return not laws.compliant(contacts).all()

    def acceleration(
        self,
        x: np.ndarray,
        t: float,
        h: float,
        lasting: ActiveContacts,
        slipping: np.ndarray | None = None,
    ) -> np.ndarray:
        """Mean accelerations over a step in which ``lasting`` contacts neither impact nor part;
        those that stick have static friction, except keys ``slipping``."""
        return self.accelerations(x, t, h, lasting, slipping)[0]

    def accelerations(
        self,
        x: np.ndarray,
        t: float,
        h: float,
        lasting: ActiveContacts,
        slipping: np.ndarray | None = None,
    ) -> tuple[np.ndarray, np.ndarray]:
        """``acceleration``, and the same without contacts."""
        (y, v), step = np.split(x, [self.size]), self.step
        start = step.begin(t, h, y, v, False)
        after, mobility = start.free, start.motion.mobility
        alone = np.asarray((after - v) / h)
        if lasting.keys.size:
            contacts = step.selected(step.at(t, y), lasting.keys)
            contacts = step.in_middle(start, contacts, lasting=True)
            before, end = contacts.at_start(v), contacts.at_end(after)
            offsets = Approach(contacts, before, end, h, step.longest).newton()
            offsets[:, 0] = -before[:, 0]
            speeds = end + offsets
            scale = float(np.abs(speeds).max(initial=0.0)) or 1.0
            matrix = delassus(contacts.directions, mobility)
            friction, laws = contacts.laws.friction.copy(), contacts.laws
            if laws.higher_at_rest.any():
                sticking = lasting.keys[~self._slips(lasting.keys, lasting.impulses)]
                static = laws.higher_at_rest & np.isin(contacts.key, sticking)
                static &= ~np.isin(contacts.key, [] if slipping is None else slipping)
                friction[static, :1] = laws.static_friction[static, None]
            problem = FrictionProblem(matrix, speeds, friction, contacts.groups, scale)
            impulses = step.solver.solve(problem, lasting.impulses).impulses
            after = after + mobility(contacts.directions.T @ impulses.ravel())[0]
        return np.asarray((after - v) / h), alone


_STEPS: WeakKeyDictionary[NonsmoothMotion, ContactSteps] = WeakKeyDictionary()


def contact_steps(motion: NonsmoothMotion) -> ContactSteps:
    """Steps of a run, linearised once for all gradients and notes."""
    if motion not in _STEPS:
        _STEPS[motion] = ContactSteps(motion)
    return _STEPS[motion]
