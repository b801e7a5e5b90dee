"""Steps of a nonsmooth run, linearised with the contact states of the run."""

from __future__ import annotations

from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep, delassus
from dalembert.analysis.nonsmooth.correction import (
    SETTINGS,
    PositionCorrection,
    PositionResidual,
    normals_of,
)
from dalembert.analysis.nonsmooth.nonsmooth_run import NonsmoothRun
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.integrators.contact.contact_laws import FIRST
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.schemes import Approach
from dalembert.results.nonsmooth_motion import NonsmoothMotion
from dalembert.sensitivity.nonsmooth.active_contacts import STICK_MARGIN, ActiveContacts
from dalembert.sensitivity.nonsmooth.contact_changes import ContactChanges
from dalembert.sensitivity.nonsmooth.contact_maps import ContactMaps
from dalembert.sensitivity.nonsmooth.linear_map import MapAt
from dalembert.symbolic.equations import newton

SAME = 1e-6
"""Permitted difference of a repeated state from the recorded one, relative to its size [-]."""


class ContactSteps:
    """All steps of a run.

    Parameters
    ----------
    motion : NonsmoothMotion

    Attributes
    ----------
    changes : step → ContactChanges of the linearised steps
    growth : largest entry of a change of the state, or of its weights, in the marches so far

    Raises
    ------
    UnsupportedError
        The law of impact is not Newton's, or contacts have force laws.
    """

    def __init__(self, motion: NonsmoothMotion):
        analysis: Any = motion.analysis
        self.record, self.p = motion.record, motion.parameters
        run = NonsmoothRun(analysis, motion.model, motion.parameters)
        self.step: ContactStep = run.step
        if self.step.law is not ImpactLaw.NEWTON:
            raise UnsupportedError(
                f"gradients of impacts by the {self.step.law.value} law are not available in "
                "solve_nonsmooth; use Newton's law, or solve_dynamics"
            )
        if elements := self.step.force_laws.elements:
            names = ", ".join(element.name for element in elements)
            raise UnsupportedError(
                f"{names}: gradients of contacts with a force law are not available in "
                "solve_nonsmooth; use rigid contacts, or a Contact for each pair of shapes in "
                "solve_dynamics"
            )
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
        return ActiveContacts(record.key[rows], record.impulse[rows], record.offset[rows])

    def observe_growth(self, columns: np.ndarray) -> None:
        """Include changes of a state, or weights, in the largest growth."""
        self.growth = max(self.growth, float(np.abs(columns).max(initial=0.0)))

    def refuse_break_away(self) -> None:
        """Raise if a contact with higher static friction begins to slip.

        Raises
        ------
        UnsupportedError
            Names the instant.
        """
        record, linear = self.record, 1 + sum(self.step.groups[:1])
        keys, number = np.unique(record.key, return_inverse=True)
        if not keys.size or linear == 1:
            return
        laws = self.maps.gaps_at(self.x[:, 0], float(record.t[0]), keys).values.laws[number]
        static, moving = laws[:, FIRST - 1], laws[:, FIRST]
        limit = moving * record.impulse[:, 0]
        slip = np.linalg.norm(record.impulse[:, 1:linear], axis=1)
        slips = np.abs(slip - limit) <= STICK_MARGIN * limit
        order = np.lexsort((record.step, number))
        ends, begins = order[1:], order[:-1]
        breaks = (number[ends] == number[begins]) & (record.step[ends] == record.step[begins] + 1)
        breaks &= slips[ends] & ~slips[begins] & (static > moving)[ends]
        if breaks.any():
            time = record.t[record.step[ends[breaks]].min()]
            raise UnsupportedError(
                f"a contact with static friction breaks away at t = {time:.9g} s, "
                "and gradients do not include the change of this instant; give "
                "static_friction equal to friction"
            )

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
        UnsupportedError
            The gap of a contact is concave along the step.
        AnalysisError
            The maps do not reproduce the recorded step.
        """
        self._refuse_curved(k)
        maps = self._maps(k)
        end, recorded = maps[-1].following, self.x[:, k + 1]
        scale = np.abs(self.x[:, k : k + 2]).max(initial=0.0) + self.step.model.scales.length
        if not np.abs(end - recorded).max(initial=0.0) <= SAME * scale:
            raise AnalysisError(
                f"the step at t = {self.record.t[k]:.9g} s cannot be repeated as a smooth map; "
                "give ContactSolver a smaller tolerance"
            )
        return maps

    def _refuse_curved(self, k: int) -> None:
        record, rows = self.record, slice(*self._starts[k : k + 2])
        owners = np.unique(record.owner[rows][record.curved[rows]])
        if owners.size:
            names = ", ".join(record.names[owner] for owner in owners)
            raise UnsupportedError(
                f"{names}: the gap of a contact is concave along the step at t = "
                f"{record.t[k]:.9g} s, and gradients do not include its means over the path; use "
                "integrator=da.MoreauJean()"
            )

    def _maps(self, k: int) -> list[MapAt]:
        (t, h), active, x = self.span(k), self.active(k), self.x[:, k]
        maps = [self.maps.step(x, self.x[self.size :, k + 1], t, h, active)]
        recorder = RecordedOpening(self.step, t + h, self.step.scheme.projection)
        newton.solve(recorder, maps[0].following[: self.size], SETTINGS)
        for keys, lifts in recorder.active:
            presses = np.isin(keys, active.keys)
            maps.append(self.maps.opening(maps[-1].following, t + h, keys, lifts, presses))
        if self.step.smooth.has_joints:
            maps.append(self.maps.consistent(maps[-1].following, t + h))
        return maps

    def acceleration(
        self, x: np.ndarray, t: float, h: float, lasting: ActiveContacts | None
    ) -> np.ndarray:
        """Mean accelerations over a step in which ``lasting`` contacts neither impact nor part, or
        without contacts."""
        y, v = x[: self.size], x[self.size :]
        step, scheme = self.step, self.step.scheme
        after, _, mobility = step.smooth.step(t, y, v, self.p, h, scheme.theta)
        if lasting is not None and lasting.keys.size:
            contacts = step.near(step.at(t, y), 2 * h * np.column_stack([v, after]))
            contacts = contacts.some(np.isin(contacts.key, lasting.keys))
            before = contacts.speeds(v)
            offsets = Approach(contacts, before, contacts.speeds(after), h).newton()
            offsets[:, 0] = -before[:, 0]
            speeds = contacts.speeds(after) + offsets
            scale = float(np.abs(speeds).max(initial=0.0)) or 1.0
            matrix = delassus(contacts.directions, mobility)
            friction = contacts.laws.friction
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


class RecordedOpening(PositionCorrection):
    """Position correction that records its active gaps.

    Attributes
    ----------
    active : for each iteration, keys of the active gaps and their distances
    """

    def __init__(self, step: ContactStep, t: float, open_gaps: bool):
        super().__init__(step, t, open_gaps)
        self.active: list[tuple[np.ndarray, np.ndarray]] = []

    def step(self, x: np.ndarray, residual: newton.Residual) -> np.ndarray:
        assert isinstance(residual, PositionResidual)
        shift, gaps = self.shift(x, residual)
        keys, lifts = np.zeros(0, dtype=int), np.zeros(0)
        if gaps is not None:
            remainder = np.abs(gaps.distance + normals_of(gaps) @ shift)
            active = np.flatnonzero(remainder <= SAME * -gaps.distance.min())
            active = active[np.argsort(gaps.key[active])]
            keys, lifts = gaps.key[active], gaps.distance[active]
        self.active.append((keys, lifts))
        return shift
