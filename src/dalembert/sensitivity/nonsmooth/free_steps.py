"""Many steps of free bodies without impacts: mean accelerations, with contacts that last."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.mobility import Mobility, delassus
from dalembert.integrators.contact.compiled_newton import separate_solutions
from dalembert.integrators.contact.contact_laws import ContactLaws
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import Delassus
from dalembert.integrators.contact.semismooth_newton import semismooth_newton
from dalembert.sensitivity.nonsmooth.contact_maps import ContactMaps
from dalembert.sensitivity.nonsmooth.gap_values import GapValues
from dalembert.sensitivity.nonsmooth.proximal_factors import diagonal_block
from dalembert.sensitivity.nonsmooth.source_slopes import StepState
from dalembert.sensitivity.nonsmooth.triplets import Sparse

TOGETHER = 8
"""Upper limit of the Newton iterations for all steps together; the remaining steps, which would
shorten the iterations of all, are solved one by one."""


@dataclass(frozen=True, eq=False)
class LastingContacts:
    """Contacts that neither impact nor part in a step.

    Attributes
    ----------
    rows : (n,) numbers of their gaps
    owner : (n,) step of each contact, in ascending order
    impulses : (n, k) initial guess
    sticks : (n,) mask of the contacts with the coefficient of static friction, if there is one
    """

    rows: np.ndarray
    owner: np.ndarray
    impulses: np.ndarray
    sticks: np.ndarray


class FreeSteps:
    """Steps that begin at given states, each with forces linearised about its start.

    Parameters
    ----------
    maps : ContactMaps of a model of free bodies
    state : states at the starts in columns
    h : (K,) lengths

    Attributes
    ----------
    mobility : of the speeds of all steps
    change : of these without impulses, one step after the other
    """

    def __init__(self, maps: ContactMaps, state: StepState, h: np.ndarray):
        self._maps, self._h, self._state = maps, h, state
        arguments = state.before, state.y, state.before, state.t, state.p, h[None]
        value, (matrix, _), *_ = maps.equations.linear(*arguments)
        self.mobility = mobility_of(maps, matrix, h.size)
        self.change = self.mobility(-value)[0]

    @cached_property
    def accelerations(self) -> np.ndarray:
        """(n_v, K) without contacts."""
        return np.asarray(self.change.reshape(self._h.size, -1).T / self._h)

    def with_contacts(self, gaps: GapValues, lasting: LastingContacts) -> np.ndarray:
        """(n_v, K) accelerations with contacts.

        Parameters
        ----------
        gaps : of the same states
        """
        if not lasting.rows.size:
            return self.accelerations
        step, some = self._maps.contact_step, gaps.some(lasting.rows)
        directions, values = some.directions, some.values
        directions.eliminate_zeros()
        laws, linear = ContactLaws.of(values.laws.T, step.groups), 1 + sum(step.groups[:1])
        offsets = np.zeros_like(values.before)
        offsets[:, 0] = -values.before[:, 0]
        offsets[:, 1:linear] = laws.tangential[:, None] * values.before[:, 1:linear]
        change = (directions @ self.change).reshape(values.before.shape)
        change += self.turning(some)
        speeds, friction = values.before + change + offsets, laws.friction.copy()
        static = laws.higher_at_rest & lasting.sticks
        friction[static, :1] = laws.static_friction[static, None]
        first = np.searchsorted(lasting.owner, np.arange(self._h.size + 1))
        problem = FrictionProblem(self._delassus(directions), speeds, friction, step.groups)
        impulses = self._impulses(problem, lasting, first)
        total = self.change + self.mobility(directions.T @ impulses.ravel())[0]
        return np.asarray(total.reshape(self._h.size, -1).T / self._h)

    def turning(self, gaps: GapValues) -> np.ndarray:
        """(n, k) changes of the velocities of gaps of the same states at constant speeds."""
        return gaps.turning((self._state.after - self._state.before).T.ravel())

    def _delassus(self, directions: Sparse) -> Delassus:
        """Operator of contacts of all steps."""
        operator = delassus(directions, self.mobility)
        assert isinstance(operator, Delassus)
        return operator

    def _impulses(
        self, problem: FrictionProblem, lasting: LastingContacts, first: np.ndarray
    ) -> np.ndarray:
        """(n, k) impulses, one step after the other in machine code, else by Newton's method for
        all steps together; steps beyond the tolerance are solved again, one by one."""
        solver, used = self._maps.contact_step.solver, np.flatnonzero(np.diff(first))
        begins = first[used]
        scales = np.maximum.reduceat(np.abs(problem.velocity).max(axis=1), begins)
        scales = np.where(scales > 0, scales, 1.0)
        impulses = self._solved(problem, lasting.impulses, first, used, scales)
        residual = np.abs(impulses - problem.project(impulses, problem.speeds(impulses)))
        residual = np.maximum.reduceat((residual * problem.weights).max(axis=1), begins)
        changes = np.linalg.norm(impulses[:, : problem.linear], axis=1) * problem.mobility[:, 0]
        sizes = np.maximum(scales, np.maximum.reduceat(changes, begins))
        impulses = problem.project(impulses, np.zeros(problem.shape))
        for i in np.flatnonzero(~(residual <= solver.tolerance * sizes)):
            own = slice(*first[used[i] : used[i] + 2])
            single = self._single(problem, int(used[i]), own, float(scales[i]))
            impulses[own] = solver.solve(single, lasting.impulses[own]).impulses
        return impulses

    def _solved(
        self,
        problem: FrictionProblem,
        impulses: np.ndarray,
        first: np.ndarray,
        used: np.ndarray,
        scales: np.ndarray,
    ) -> np.ndarray:
        """Impulses from an initial guess, of the steps ``used`` with reference speeds ``scales``,
        which some of them may not satisfy."""
        solver, operator = self._maps.contact_step.solver, problem.matrix
        assert isinstance(operator, Delassus)
        n = self._state.before.shape[0]
        directions, responses, inertia = (
            scipy.sparse.csr_array((m.data, m.indices % n, m.indptr), shape=(m.shape[0], n))
            for m in (operator.directions, operator.responses, operator.inertia)
        )
        own = replace(
            operator,
            directions=directions,
            responses=responses,
            inertia=inertia,
            orderings=self._maps.contact_step.smooth.coupling.orderings,
        )
        parts = list(zip(first[used], first[used + 1], used, scales, strict=True))
        limits = solver.tolerance, solver.max_iterations
        separate = separate_solutions(replace(problem, matrix=own), parts, impulses, *limits)
        if separate is not None:
            return separate
        scale = np.repeat(scales, np.diff(first)[used])[:, None]
        relative = replace(problem, velocity=problem.velocity / scale)
        tolerance = solver.newton_tolerance
        return scale * semismooth_newton(relative, impulses / scale, tolerance, TOGETHER)

    def _single(
        self, problem: FrictionProblem, k: int, own: slice, scale: float
    ) -> FrictionProblem:
        """Problem of one step."""
        assert isinstance(problem.matrix, Delassus)
        (n, _), width, operator = self._state.before.shape, problem.shape[1], problem.matrix
        rows = width * own.start, width * own.stop, n * k, n
        across, moved = (
            diagonal_block(part, *rows) for part in (operator.directions, operator.responses)
        )
        inertia = diagonal_block(operator.inertia, n * k, n * (k + 1), n * k)
        none, shift = scipy.sparse.csr_array((0, n)), np.zeros(rows[1] - rows[0])
        orderings = self._maps.contact_step.smooth.coupling.orderings
        matrix = Delassus(across, moved, inertia, none, shift, orderings=orderings)
        velocity, friction = problem.velocity[own], problem.friction[own]
        return FrictionProblem(matrix, velocity, friction, problem.groups, scale)


def mobility_of(maps: ContactMaps, matrix: Sparse, count: int) -> Mobility:
    """Mobility of several steps of free bodies that follow one another."""
    none = scipy.sparse.csr_array((0, matrix.shape[0]))
    return Mobility(matrix, none, maps.contact_step.smooth.coupling.repeated(count))
