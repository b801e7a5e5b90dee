"""Linearised steps with contacts: equations of motion, of contacts, and corrections.

    M (v⁺ − v) + C̄ᵀ Λ − Wᵀ P = h F̄,      C̄ (v⁺ + v)/2 = −Φ̄_t − Φ/h
    P − proj(P − ρ (u⁺ + offset)) = 0

then ``y⁺ = y ⊕ h (θ v⁺ + (1−θ) v)``; correction of gaps along ``M⁻¹``; projection of speeds.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.active_contacts import NO_PATH, ActiveContacts
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.gaps.model_gaps import APART
from dalembert.analysis.nonsmooth.impact_stage import ImpactStage
from dalembert.integrators.contact.contact_laws import FIRST
from dalembert.sensitivity.nonsmooth.contact_equations import ContactEquations
from dalembert.sensitivity.nonsmooth.force_slopes import ForceSlopes
from dalembert.sensitivity.nonsmooth.forced_changes import ForcedSteps
from dalembert.sensitivity.nonsmooth.gap_matrices import joined_matrices
from dalembert.sensitivity.nonsmooth.gap_slopes import Gaps, Part
from dalembert.sensitivity.nonsmooth.gap_values import GapValues
from dalembert.sensitivity.nonsmooth.impact_slopes import ImpactSlopes, Motions
from dalembert.sensitivity.nonsmooth.linear_map import MapAt
from dalembert.sensitivity.nonsmooth.path_slopes import Path, path_gaps, path_points
from dalembert.sensitivity.nonsmooth.proximal_factors import Block, ProximalFactors
from dalembert.sensitivity.nonsmooth.residual_terms import is_solved
from dalembert.sensitivity.nonsmooth.source_slopes import StepState, source_slopes
from dalembert.sensitivity.nonsmooth.step_equations import step_equations
from dalembert.sensitivity.nonsmooth.triplets import Sparse, Triplets, by_rows

MAX_ITERATIONS = 20
"""Newton iterations."""


class ContactMaps:
    """Linearised maps of one model and scheme.

    Parameters
    ----------
    step : ContactStep of the run
    """

    def __init__(self, step: ContactStep):
        self.contact_step, self.e, self.p = step, step.model.equations, step.p
        self.equations = step_equations(step.model, step.scheme.theta)
        self._sources = source_slopes(step.model)
        self.size, self.speeds = self.e.y.numel(), self.e.v.numel()
        self.smooth = self.speeds + self.e.constraint_count

    def gaps(
        self,
        state: StepState,
        keys: np.ndarray,
        impulses: np.ndarray,
        curved: np.ndarray | None = None,
        path: Path | None = None,
        owner: np.ndarray | None = None,
        kept: np.ndarray | None = None,
    ) -> Gaps:
        """Gaps with some keys, in their order, and their derivatives.

        Parameters
        ----------
        impulses : (n, k)
        curved, path : (n,) mask of means over a path, none by default, and the path
        owner : (n,) column of the state of each gap; the first one by default
        kept : (n,) mask of directions at the start of the step, none by default
        """
        numbers, laws = keys // APART, self.laws
        none = np.zeros(keys.size, dtype=bool)
        means, still = (none if mask is None else mask for mask in (curved, kept))
        parts: list[Part] = []
        for number, source in enumerate(self._sources):
            moving, fixed, own = (
                np.flatnonzero((numbers == number) & mask)
                for mask in (~(means | still), still & ~means, means)
            )
            for rows, at in ((moving, state), (fixed, replace(state, lead=0.0))):
                if rows.size or not (keys.size or parts):
                    place = None if owner is None else owner[rows]
                    own_keys = keys[rows] % APART
                    parts.append(source.at(at, rows, own_keys, impulses[rows], laws, place))
            if own.size and path is not None:
                arguments = own, keys[own] % APART, impulses[own], laws
                parts.append(path_gaps(source, state, path, *arguments, still[own]))
        return Gaps.of(parts)

    def values(
        self, state: StepState, keys: np.ndarray, owner: np.ndarray, kept: np.ndarray | None = None
    ) -> GapValues:
        """Gaps with some keys, in their order, without derivatives; arguments as in ``gaps``."""
        numbers, shape = keys // APART, (1 + sum(self.contact_step.groups), self.laws)
        still = np.zeros(keys.size, dtype=bool) if kept is None else kept
        parts: list[tuple[np.ndarray, GapValues]] = []
        for number, source in enumerate(self._sources):
            for mask, at in ((~still, state), (still, replace(state, lead=0.0))):
                rows = np.flatnonzero((numbers == number) & mask)
                if rows.size or not (keys.size or parts):
                    parts.append((rows, source.values(at, keys[rows] % APART, shape, owner[rows])))
        return GapValues.joined(parts)

    @property
    def laws(self) -> int:
        """Number of coefficients of each gap."""
        return FIRST + len(self.contact_step.groups)

    def lead(self, h: float | np.ndarray) -> float | np.ndarray:
        """``(1−θ) h`` of steps."""
        return (1 - self.contact_step.scheme.theta) * h

    def gaps_at(self, x: np.ndarray, t: float, keys: np.ndarray) -> Gaps:
        """Gaps and their velocities at a state."""
        y, v = self._split(x)
        impulses = np.zeros((keys.size, 1 + sum(self.contact_step.groups)))
        return self.gaps(StepState(t, y, self.p, v, v), keys, impulses)

    def step(
        self,
        x: np.ndarray,
        after: np.ndarray,
        t: float,
        h: float,
        active: ActiveContacts,
        before: MapAt | None = None,
        curved: np.ndarray = NO_PATH.curved,
        stage: ImpactStage | None = None,
    ) -> MapAt:
        """Map from the start of a step to its end before corrections.

        Parameters
        ----------
        after : initial guess of the speeds at the end
        active : the pressing contacts
        before : map of the solution on whose path means of gaps are taken
        curved : keys of all contacts with means, pressing ones and others
        stage : impacts at the start of the step, whose impulses ``active`` does not include
        """
        (y, v), n = self._split(x), self.speeds
        path = None
        if before is not None:
            step = self.contact_step
            path = Path(before.z[:n], h, step.scheme.theta, path_points(step.model))
        z = np.concatenate([after, np.zeros(self.smooth - n), active.impulses.ravel()])
        impact = None if stage is None else self._impact(stage, active, path, (y, v, t, self.p, h))
        for _ in range(MAX_ITERATIONS):
            smooth, impulses = np.split(z, [self.smooth])
            pressing = active.pressing(impulses)
            value, (by_z, by_q), following, slopes = self.equations.step(smooth, y, v, t, self.p, h)
            right, matrix, contacts = value, [(0, 0, by_z)], None
            if pressing.keys.size:
                state = StepState(t, y, self.p, v, smooth[:n], lead=self.lead(h))
                own = pressing.keys, pressing.impulses, pressing.curved
                gaps = self.gaps(state, *own, path, kept=pressing.kept)
                inertia = np.maximum(np.abs(by_z.diagonal()[:n]), np.finfo(float).tiny)
                arguments = self.contact_step, pressing, h, inertia, smooth[:n] - v
                forces = self._forces(gaps, y, t, h, pressing.keys)
                contacts = ContactEquations.of(gaps, *arguments, impact, forces)
                right, below = self.joined(value, contacts, impulses)
                matrix += below
            factors = ProximalFactors.of(matrix, self._weight(impulses.size))
            if is_solved(right, matrix, z):
                break
            z = z - factors.solve(right)
        forced = None
        if contacts is not None and contacts.slopes.forced.any():
            dependent = contacts.slopes.some(contacts.slopes.forced > 0)
            changes = [dependent.change], [dependent.forced]
            means = None if before is None else (curved, before.z[:n])
            single = ForcedSteps(x[:, None], np.array([t]), np.array([h]), *changes, means)
            forced = self.forced_changes(single, path)
        next_by_z, next_by_q = slopes
        return MapAt(z, following, factors, by_q, next_by_z, next_by_q, contacts, forced, before)

    def _forces(
        self, gaps: Gaps, y: np.ndarray, t: float, h: float, keys: np.ndarray
    ) -> ForceSlopes | None:
        """Contacts with force laws; None without any."""
        step = self.contact_step
        if not step.force_laws.elements:
            return None
        numbers, values = step.force_laws.of(step.selected(step.at(t, y), keys)), gaps.values
        state = values.distance, values.before[:, 0], values.after[:, 0]
        span = h, step.scheme.theta
        return ForceSlopes.of(step.force_laws, numbers, step.model, span, state)

    def _impact(
        self,
        stage: ImpactStage,
        active: ActiveContacts,
        path: Path | None,
        state: tuple[np.ndarray, np.ndarray, float, np.ndarray, float],
    ) -> ImpactSlopes:
        """Impacts at the start ``y``, ``v``, ``t``, ``p``, ``h`` of a step."""
        (y, v, t, p, _), n, lead = state, self.speeds, self.lead(state[-1])
        start = np.concatenate([v, np.zeros(self.smooth - n)])

        def slopes(change: np.ndarray) -> list[Sparse]:
            return self.equations.linear(start + change, *state)[1]

        def gaps(own: np.ndarray, impulses: np.ndarray, change: np.ndarray, end=-1.0) -> Gaps:
            state = StepState(t, y, p, v, v + change, lead=lead, end=end)
            kept = np.isin(own, stage.contacts.key[stage.contacts.kept_mask])
            return self.gaps(state, own, impulses, kept=kept)

        def middle(own: np.ndarray, impulses: np.ndarray) -> Gaps:
            return gaps(own, impulses, np.zeros(n), end=1.0)

        def means(change: np.ndarray) -> Gaps:
            own = active.keys, np.zeros_like(active.impulses), active.curved, path
            state = StepState(t, y, p, v, v + change, lead=lead, end=-1.0)
            return self.gaps(state, *own, kept=active.kept)

        by_z, by_q = slopes(0 * start)
        factors = ProximalFactors.of([(0, 0, by_z)], self._weight(0))
        changes = lambda change: by_rows(slopes(change)[1]) - by_rows(by_q)  # noqa: E731
        motions = Motions(factors, changes, gaps, middle, means, n, self.size)
        return ImpactSlopes(stage, active.keys, motions)

    def forced_changes(self, steps: ForcedSteps, path: Path | None = None) -> Sparse:
        """(K, K n_q) derivatives by ``q`` of the largest changes of normal speeds by forces; that
        of a mean over a path is followed by those by the speeds of the path.

        With the speeds ``v_f`` at the end of a step without impulses, a change is ``u_N⁺(v_f) −
        u_N⁻`` or its negative, and

            d(u_N⁺ − u_N⁻) = du_N⁺ − du_N⁻ + N dv_f,      dv_f = −A⁻¹ G_q dq

        Raises
        ------
        AnalysisError
            The change is not that which the offsets of the contacts state.
        """
        (y, v), count, n = np.split(steps.x, [self.size]), steps.count, self.smooth
        t, h = steps.t[None], steps.h[None]
        own = y, v, t, self.p, h
        value, (matrix, _), *_ = self.equations.linear(np.zeros((n, count)), *own)
        factors = ProximalFactors.of([(0, 0, matrix)], np.tile(self._weight(0), count))
        z = -factors.solve(value).reshape(count, n).T
        _, (_, by_q), *_ = self.equations.linear(z, *own)
        free = z[: self.speeds]
        keys, signs, kept, means = steps.largest(self.contact_step, free)
        none = np.zeros((count, 1 + sum(self.contact_step.groups)))
        state = StepState(t, y, self.p, v, free, lead=self.lead(h))
        if means.any():  # of a single step
            single = y[:, 0], self.p, v[:, 0], free[:, 0]
            state = StepState(float(steps.t[0]), *single, lead=self.lead(float(steps.h[0])))
        gaps = self.gaps(state, keys, none, means, path, np.arange(count), kept)
        normal, slopes = np.arange(count) * none.shape[1], joined_matrices(gaps)
        by_speeds = np.zeros((count, n))  # of one gap of each step, and so of all in one column
        by_speeds[:, : self.speeds] = gaps.directions[normal].sum(axis=0).reshape(count, -1)
        weights = factors.solve(by_speeds.ravel(), transposed=True)
        places = np.arange(count * n), n * np.arange(count + 1)
        by_equations = scipy.sparse.csr_array((weights, *places), shape=(count, count * n))
        by_equations = scipy.sparse.csr_array(by_equations @ by_rows(by_q))
        by_equations.resize(count, slopes["after"].shape[1])
        changes = slopes["after"][normal] - slopes["before"][normal] - by_equations
        return scipy.sparse.csr_array(scipy.sparse.diags_array(signs) @ changes)

    def opening(
        self, x: np.ndarray, t: float, keys: np.ndarray, lifts: np.ndarray, presses: np.ndarray
    ) -> MapAt:
        """One iteration towards closed joints and open gaps, ``M δ + Cᵀ λ − Nᵀ π = 0``.

        Parameters
        ----------
        keys, lifts : active gaps and their distances
        presses : mask of the gaps whose contact presses; the lift of others is constant: their
            impact is still to come, and its instant depends on their position
        """
        (y, v), n = self._split(x), self.speeds
        z, still = np.zeros(self.smooth + keys.size), np.zeros(n)
        for solved in (False, True):
            smooth, impulses = np.split(z, [self.smooth])
            state = smooth, y, v, t, self.p, 0.0
            value, (by_z, by_q), following, slopes = self.equations.position(*state)
            right, matrix, contacts = value, [(0, 0, by_z)], None
            if keys.size:
                moved = StepState(t, y, self.p, still, smooth[:n], 0.0)
                gaps = self.gaps(moved, keys, impulses[:, None])
                contacts = ContactEquations.of_openings(keys, gaps, lifts, presses)
                right, below = self.joined(value, contacts, impulses)
                matrix += below
            if not solved:
                factors = ProximalFactors.of(matrix, self._weight(impulses.size))
                z = z - factors.solve(right)
        next_by_z, next_by_q = slopes
        return MapAt(z, following, factors, by_q, next_by_z, next_by_q, contacts)

    def consistent(self, x: np.ndarray, t: float) -> MapAt:
        """Projection to the nearest speeds that satisfy the joints."""
        state, z = (*self._split(x), t, self.p, 0.0), np.zeros(self.smooth)
        value, (by_z, _), *_ = self.equations.consistent(z, *state)
        factors = ProximalFactors.of([(0, 0, by_z)], self._weight(0))
        z = -factors.solve(value)
        _, (_, by_q), following, slopes = self.equations.consistent(z, *state)
        return MapAt(z, following, factors, by_q, *slopes)

    def joined(
        self, value: np.ndarray, contacts: ContactEquations, impulses: np.ndarray
    ) -> tuple[np.ndarray, list[Block]]:
        """Residual with contacts, and their blocks of the matrix, of one step or of several that
        follow one another."""
        across, first = Triplets.of(contacts.gaps.directions), value.size
        right = np.concatenate([value, contacts.residual])
        right[: across.shape[1]] -= (across.T @ impulses[:, None])[:, 0] + contacts.struck
        away = replace(across.T, value=-across.value)
        own = [(first, 0, contacts.by_speed), (first, first, contacts.by_impulse)]
        return right, [(0, first, away), *own]

    def _split(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return x[: self.size], x[self.size :]

    def _weight(self, rows: int) -> np.ndarray:
        counts = [self.speeds, self.smooth - self.speeds, rows]
        return np.repeat([0.0, -1.0, 1.0], counts)
