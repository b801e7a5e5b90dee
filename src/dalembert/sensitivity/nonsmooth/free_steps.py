"""Many steps of free bodies without impacts: mean accelerations, with contacts that last."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.mobility import Mobility
from dalembert.integrators.contact.contact_laws import ContactLaws
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import Delassus
from dalembert.sensitivity.nonsmooth.contact_maps import ContactMaps
from dalembert.sensitivity.nonsmooth.gap_slopes import Gaps
from dalembert.sensitivity.nonsmooth.proximal_factors import diagonal_block
from dalembert.sensitivity.nonsmooth.slope_function import Sparse
from dalembert.sensitivity.nonsmooth.source_slopes import StepState


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
    state : states at the starts in columns; ``after`` is not used
    h : (K,) lengths
    """

    def __init__(self, maps: ContactMaps, state: StepState, h: np.ndarray):
        self._maps, self._h, self._v = maps, h, state.before
        arguments = state.before, state.y, state.before, state.t, state.p, h[None]
        value, (matrix, _), *_ = maps.equations.linear(*arguments)
        self._mobility = mobility_of(maps, matrix, h.size)
        self._change = self._mobility(-value)[0]

    @cached_property
    def accelerations(self) -> np.ndarray:
        """(n_v, K) without contacts."""
        return np.asarray(self._change.reshape(self._h.size, -1).T / self._h)

    def with_contacts(self, gaps: Gaps, lasting: LastingContacts) -> np.ndarray:
        """(n_v, K) accelerations with contacts.

        Parameters
        ----------
        gaps : at the starts, ``before`` with the speeds there
        """
        if not lasting.rows.size:
            return self.accelerations
        step, width = self._maps.contact_step, gaps.values.before.shape[1]
        rows = (lasting.rows[:, None] * width + np.arange(width)).ravel()
        directions, values = gaps.directions[rows], gaps.values.some(lasting.rows)
        laws, linear = ContactLaws.of(values.laws.T, step.groups), 1 + sum(step.groups[:1])
        offsets = np.zeros_like(values.before)
        offsets[:, 0] = -values.before[:, 0]
        offsets[:, 1:linear] = laws.tangential[:, None] * values.before[:, 1:linear]
        change = (directions @ self._change).reshape(values.before.shape)
        speeds, friction = values.before + change + offsets, laws.friction.copy()
        static = laws.higher_at_rest & lasting.sticks
        friction[static, :1] = laws.static_friction[static, None]
        impulses = self._impulses(directions, speeds, friction, lasting)
        total = self._change + self._mobility(directions.T @ impulses.ravel())[0]
        return np.asarray(total.reshape(self._h.size, -1).T / self._h)

    def _impulses(
        self,
        directions: Sparse,
        speeds: np.ndarray,
        friction: np.ndarray,
        lasting: LastingContacts,
    ) -> np.ndarray:
        """(n, k) impulses, step by step."""
        step, (n, count) = self._maps.contact_step, self._v.shape
        responses, (_, width) = self._mobility.responses(directions), speeds.shape
        first, impulses = (
            np.searchsorted(lasting.owner, np.arange(count + 1)),
            np.zeros_like(speeds),
        )
        none, orderings = scipy.sparse.csr_array((0, n)), step.smooth.coupling.orderings
        for k in np.flatnonzero(np.diff(first)):
            own, begin, end = slice(*first[k : k + 2]), *(width * first[k : k + 2])
            across, moved = (
                diagonal_block(part, begin, end, n * k, n) for part in (directions, responses)
            )
            inertia = diagonal_block(self._mobility.matrix, n * k, n * (k + 1), n * k)
            shift = np.zeros(end - begin)
            matrix = Delassus(across, moved, inertia, none, shift, orderings=orderings)
            scale = float(np.abs(speeds[own]).max()) or 1.0
            problem = FrictionProblem(matrix, speeds[own], friction[own], step.groups, scale)
            impulses[own] = step.solver.solve(problem, lasting.impulses[own]).impulses
        return impulses


def mobility_of(maps: ContactMaps, matrix: Sparse, count: int) -> Mobility:
    """Mobility of several steps of free bodies that follow one another."""
    none = scipy.sparse.csr_array((0, matrix.shape[0]))
    return Mobility(matrix, none, maps.contact_step.smooth.coupling.repeated(count))
