"""Steps of a nonsmooth run, linearised with the contact states of the run."""

from __future__ import annotations

from functools import cached_property
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from dalembert.analysis.nonsmooth.advance import advance
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.correction import SETTINGS
from dalembert.analysis.nonsmooth.mobility import delassus
from dalembert.analysis.nonsmooth.nonsmooth_run import NonsmoothRun
from dalembert.analysis.nonsmooth.step_state import LastImpulses, StepResult
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.integrators.contact.approach import Approach
from dalembert.integrators.contact.contact_laws import FIRST, IMPACT
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.results.nonsmooth_motion import NonsmoothMotion
from dalembert.sensitivity.nonsmooth.active_contacts import STICK_MARGIN, ActiveContacts
from dalembert.sensitivity.nonsmooth.contact_changes import ContactChanges
from dalembert.sensitivity.nonsmooth.contact_maps import ContactMaps
from dalembert.sensitivity.nonsmooth.linear_map import MapAt
from dalembert.sensitivity.nonsmooth.recorded_opening import SAME, RecordedOpening
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
        self._starts = np.searchsorted(self.record.step, np.arange(self.count + 1))

    @property
    def count(self) -> int:
        """Number of steps."""
        return self.record.t.size - 1

    def active(self, k: int) -> ActiveContacts:
        """Pressing contacts of a step; none before the first."""
        rows = np.arange(*self._starts[k : k + 2]) if k >= 0 else np.zeros(0, dtype=int)
        rows = rows[np.argsort(self.record.key[rows])]
        record = self.record
        fields = record.key, record.impulse, record.offset, record.curved
        return ActiveContacts(*(field[rows] for field in fields))

    def observe_growth(self, columns: np.ndarray) -> None:
        """Include changes of a state, or weights, in the largest growth."""
        self.growth = max(self.growth, float(np.abs(columns).max(initial=0.0)))

    @cached_property
    def breaks(self) -> dict[int, np.ndarray]:
        """Step → keys of the contacts with higher static friction that slip in the next step, but
        not in this one."""
        record = self.record
        if not record.key.size or not self.step.groups:
            return {}
        number = np.unique(record.key, return_inverse=True)[1]
        laws, slips = self._laws(record.key), self._slips(record.key, record.impulse)
        static, moving = laws[:, FIRST - 1], laws[:, FIRST]
        order = np.lexsort((record.step, number))
        ends, begins = order[1:], order[:-1]
        breaks = (number[ends] == number[begins]) & (record.step[ends] == record.step[begins] + 1)
        breaks &= slips[ends] & ~slips[begins] & (static > moving)[ends]
        rows = begins[breaks]
        return {int(k): record.key[rows[record.step[rows] == k]] for k in record.step[rows]}

    def _laws(self, key: np.ndarray) -> np.ndarray:
        """(n, c) coefficients of gaps at the start."""
        keys, number = np.unique(key, return_inverse=True)
        start = self.x[:, 0], float(self.record.t[0])
        return np.asarray(self.maps.gaps_at(*start, keys).values.laws[number])

    def _slips(self, key: np.ndarray, impulse: np.ndarray) -> np.ndarray:
        """(n,) mask of the impulses (n, k) of sliding contacts."""
        linear = 1 + sum(self.step.groups[:1])
        if linear == 1 or not key.size:
            return np.ones(key.size, dtype=bool)
        limit = self._laws(key)[:, FIRST] * impulse[:, 0]
        slip = np.linalg.norm(impulse[:, 1:linear], axis=1)
        return np.asarray(np.abs(slip - limit) <= STICK_MARGIN * limit)

    def _is_repeated(self, active: ActiveContacts) -> bool:
        """Whether a step has solutions that are not recorded: those on whose paths means of gaps
        are taken, and impacts by other laws than Newton's."""
        if active.curved.any() or not active.keys.size:
            return bool(active.curved.any())
        return bool((self._laws(active.keys)[:, IMPACT] != ImpactLaw.NEWTON.number).any())

    def split(self, k: int) -> tuple[np.ndarray, np.ndarray]:
        """``y`` and ``v`` at the start of step ``k``."""
        return self.x[: self.size, k], self.x[self.size :, k]

    def span(self, k: int) -> tuple[float, float]:
        """Start time and length of step ``k``."""
        t = self.record.t
        return float(t[k]), float(t[k + 1] - t[k])

    def at(self, k: int) -> list[MapAt]:
        """Sequence of maps of step ``k``.

        Raises
        ------
        AnalysisError
            The maps do not reproduce the recorded step.
        """
        maps = self._maps(k)
        end, recorded = maps[-1].following, self.x[:, k + 1]
        scale = np.abs(self.x[:, k : k + 2]).max(initial=0.0) + self.step.model.scales.length
        if not np.abs(end - recorded).max(initial=0.0) <= SAME * scale:
            raise AnalysisError(
                f"the step at t = {self.record.t[k]:.9g} s cannot be repeated as a smooth map; "
                "give ContactSolver a smaller tolerance"
            )
        return maps

    def _maps(self, k: int) -> list[MapAt]:
        (t, h), active, x = self.span(k), self.active(k), self.x[:, k]
        after = self.x[self.size :, k + 1]
        if self._is_repeated(active):
            maps = [self._repeated(k)]
        else:
            maps = [self.maps.step(x, after, t, h, active)]
        recorder = RecordedOpening(self.step, t + h, self.step.scheme.projection)
        newton.solve(recorder, maps[0].following[: self.size], SETTINGS)
        for keys, lifts in recorder.active:
            presses = np.isin(keys, active.keys)
            maps.append(self.maps.opening(maps[-1].following, t + h, keys, lifts, presses))
        if self.step.smooth.has_joints:
            maps.append(self.maps.consistent(maps[-1].following, t + h))
        return maps

    def _repeated(self, k: int) -> MapAt:
        """Map of a step that is repeated: with means of gaps over the path of a solution, or with
        impacts at its start."""
        (t, h), (y, v), x = self.span(k), self.split(k), self.x[:, k]
        result: StepResult | None = advance(self.step, t, h, y, v, self._last(k - 1))
        results = []
        while result is not None:
            results.append(result)
            result = result.path
        before: MapAt | None = None
        if any(self._is_mixed(result) for result in results):
            raise UnsupportedError(
                f"rigid contacts along curved paths act with contacts with a force law in the step "
                f"at t = {t:.9g} s: no gradient; give them all force laws, or none"
            )
        for result in reversed(results):
            own = ActiveContacts.of(result), before, result.impact
            before = self.maps.step(x, result.v, t, h, *own)
        assert before is not None
        return before

    def _is_mixed(self, result: StepResult) -> bool:
        """Whether rigid contacts have means over a path, and compliant ones others."""
        own = result.contacts.some(np.isin(result.contacts.key, result.curved))
        laws = self.step.force_laws
        return bool(laws.elements) and not laws.compliant(own).all()

    def _last(self, k: int) -> LastImpulses | None:
        """Part of step ``k`` on which the next one depends; None before the first."""
        if k < 0:
            return None
        active = self.active(k)
        order = np.argsort(active.keys)
        stuck = active.keys[~self._slips(active.keys, active.impulses)]
        return LastImpulses((active.keys[order], active.impulses[order]), stuck)

    def acceleration(
        self,
        x: np.ndarray,
        t: float,
        h: float,
        lasting: ActiveContacts | None,
        slipping: np.ndarray | None = None,
    ) -> np.ndarray:
        """Mean accelerations over a step in which ``lasting`` contacts neither impact nor part, or
        without contacts; those that stick have static friction, except keys ``slipping``."""
        y, v = x[: self.size], x[self.size :]
        step, scheme = self.step, self.step.scheme
        free = step.smooth.step(t, y, v, self.p, h, scheme.theta).free
        after, mobility = free.speeds, free.mobility
        if lasting is not None and lasting.keys.size:
            contacts = step.near(step.at(t, y), 2 * h * np.column_stack([v, after]))
            contacts = contacts.some(np.isin(contacts.key, lasting.keys))
            before = contacts.speeds(v)
            offsets = Approach(contacts, before, contacts.speeds(after), h).newton()
            offsets[:, 0] = -before[:, 0]
            speeds = contacts.speeds(after) + offsets
            scale = float(np.abs(speeds).max(initial=0.0)) or 1.0
            matrix = delassus(contacts.directions, mobility)
            friction, laws = contacts.laws.friction.copy(), contacts.laws
            if laws.higher_at_rest.any():
                sticking = lasting.keys[~self._slips(lasting.keys, lasting.impulses)]
                static = laws.higher_at_rest & np.isin(contacts.key, sticking)
                static &= ~np.isin(contacts.key, [] if slipping is None else slipping)
                friction[static, :1] = laws.static_friction[static, None]
            problem = FrictionProblem(matrix, speeds, friction, contacts.groups, scale)
            start = lasting.impulses[np.searchsorted(lasting.keys, contacts.key)]
            impulses = step.solver.solve(problem, start).impulses
            after = after + mobility(contacts.directions.T @ impulses.ravel())[0]
        return np.asarray((after - v) / h)


_STEPS: WeakKeyDictionary[NonsmoothMotion, ContactSteps] = WeakKeyDictionary()


def contact_steps(motion: NonsmoothMotion) -> ContactSteps:
    """Steps of a run, linearised once for all gradients and notes."""
    if motion not in _STEPS:
        _STEPS[motion] = ContactSteps(motion)
    return _STEPS[motion]
