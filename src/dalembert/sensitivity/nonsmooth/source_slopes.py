"""Gaps of a source with some keys, and their derivatives.

All gaps of a kind are evaluated together by one function of their shapes, so that no graph depends
on the pattern of contacts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.gap_source import GapFormulas, GapKind, GapSource
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.model import Model
from dalembert.sensitivity.nonsmooth.gap_changes import GapChanges
from dalembert.sensitivity.nonsmooth.gap_kernels import GapKernels, GapVariables
from dalembert.sensitivity.nonsmooth.gap_slopes import (
    KindSlopes,
    PlaceSlopes,
    SourceGaps,
    scatter,
)
from dalembert.sensitivity.nonsmooth.gap_values import GapValues, directions_of
from dalembert.sensitivity.nonsmooth.slope_function import SlopeFunction
from dalembert.symbolic.once import once


@dataclass(frozen=True, eq=False)
class StepState:
    """Arguments of the gaps of a step, or of several steps in columns.

    Attributes
    ----------
    t, y, p : position
    before, after : speeds at the start and at the end
    drift : 1 for velocities, 0 for displacements in their place
    lead : ``(1−θ) h``, time from the start to the middle of the step
    end : 1 if the speeds ``after`` act at the end of the step, −1 at its start
    """

    t: float | np.ndarray
    y: np.ndarray
    p: np.ndarray
    before: np.ndarray
    after: np.ndarray
    drift: float = 1.0
    lead: float | np.ndarray = 0.0
    end: float = 1.0

    @property
    def count(self) -> int:
        """Number of steps."""
        return self.columns or 1

    @property
    def columns(self) -> int | None:
        """Number of columns; None for the vectors of one step."""
        return None if self.y.ndim == 1 else self.y.shape[1]


class PlaceFunctions:
    """Geometry and velocities of the shapes of a source at one position of a step.

    Parameters
    ----------
    e : equations of the model
    formulas : at that position
    start, lead : symbols of the speeds at the start, and of the time since then
    """

    def __init__(self, e: Equations, formulas: GapFormulas, start: ca.SX, lead: ca.SX):
        q, place = ca.vertcat(e.y, start, e.t, e.p), [e.t, e.y, e.p, start, lead]
        share, wrench = ca.SX.sym("share"), ca.SX.sym("f", formulas.velocities.numel())
        still = ca.substitute(formulas.velocities, e.v, ca.SX.zeros(e.v.numel()))
        moving = ca.sparsify(ca.jacobian(formulas.velocities, e.v))
        velocities = ca.mtimes(moving, e.v) + share * still
        self.geometry = SlopeFunction("geometry", place, formulas.geometry, [q])
        self.velocities = SlopeFunction("velocities", [*place, e.v, share], velocities, [q, e.v])
        momenta = ca.mtimes(moving.T, wrench)
        self.momenta = SlopeFunction("momenta", [*place, wrench], momenta, [q])
        self._place, self._speeds, self._geometry = place, [e.v, share], formulas.geometry
        self._velocities = velocities

    @cached_property
    def sizes(self) -> SlopeFunction:
        """Geometry without derivatives."""
        return SlopeFunction("sizes", self._place, self._geometry, [])

    @cached_property
    def moving(self) -> SlopeFunction:
        """Velocities with derivatives by the speeds."""
        inputs, by = [*self._place, *self._speeds], self._speeds[:1]
        return SlopeFunction("moving", inputs, self._velocities, by)


class SourceSlopes:
    """Derivatives of the gaps of one source.

    Parameters
    ----------
    source : GapSource
    e : equations of the model
    """

    def __init__(self, source: GapSource, e: Equations):
        self.source, self._e, formulas = source, e, source.formulas
        start, lead = ca.SX.sym("start", e.v.numel()), ca.SX.sym("lead")
        self._start = PlaceFunctions(e, formulas, start, lead)
        moved = e.manifold.retract(e.y, e.manifold.halfway_formula(2 * lead * start))
        here, there = ca.vertcat(e.t, e.y), ca.vertcat(e.t + lead, moved)
        geometry, velocities = (
            ca.substitute(part, here, there) for part in (formulas.geometry, formulas.velocities)
        )
        self._middle = PlaceFunctions(e, GapFormulas(geometry, velocities), start, lead)
        self._kernels, places = GapKernels(), (self._start, self._middle)
        self._varying = np.any([place.geometry.rows(0) for place in places], axis=0)
        twists = ca.vertsplit(formulas.velocities)
        self._moving = np.array([not component.is_zero() for component in twists])

    def at(
        self,
        state: StepState,
        rows: np.ndarray,
        keys: np.ndarray,
        impulses: np.ndarray,
        laws: int,
        owner: np.ndarray | None = None,
        first: np.ndarray | None = None,
    ) -> SourceGaps:
        """The gaps with some keys.

        Parameters
        ----------
        rows : their numbers among all
        impulses : (n, k), as many components as the velocities have in the result
        laws : number of coefficients
        owner : (n,) column of the state of each gap; the first one by default
        first : (n,) numbers of the gaps whose tangents at the start those in the middle follow;
            their own by default
        """
        place = state.t, state.y, state.p, state.before, state.lead
        count, end, share = state.count, state.end, state.drift
        middle = self._middle if np.any(state.lead) else self._start
        geometry, (by_q,) = self._start.geometry(*place, count=state.columns)
        ahead, (ahead_by_q,) = geometry, (by_q,)
        if middle is not self._start:
            ahead, (ahead_by_q,) = middle.geometry(*place, count=state.columns)
        before, slopes = self._start.velocities(*place, state.before, share, count=state.columns)
        start = PlaceSlopes(by_q, *slopes)
        both, slopes = middle.velocities(
            *place, state.after + end * state.before, (1 + end) * share, count=state.columns
        )
        sizes = geometry.size // count, before.size // count
        column, kinds = np.zeros(keys.size, dtype=int) if owner is None else owner, []
        first = np.arange(keys.size) if first is None else first
        for kind in self.source.kinds(keys):
            own, variables = self._changing(kind, impulses.shape[1], column[kind.row], *sizes)
            at = (geometry, ahead), (before, both), impulses[kind.row], end
            order = np.searchsorted(kind.row, first[kind.row])
            kinds.append(self._evaluate(own, variables, *at, order))
        wrench = np.zeros((before.size, 1))
        for part in kinds:
            scatter(wrench, part.kind.velocities, part.wrench[..., None])
        columns = wrench.reshape(count, -1).T
        momenta = middle.momenta(*place, columns, count=state.columns)[1][0]
        begin, n, width = self._e.y.numel(), self._e.v.numel(), by_q.shape[1] // count
        speeds = (width * np.arange(count)[:, None] + begin + np.arange(n)).ravel()
        shape = impulses.shape[1], laws
        places = start, PlaceSlopes(ahead_by_q, *slopes)
        return SourceGaps(rows, kinds, *places, momenta, end, speeds, shape)

    def values(
        self,
        state: StepState,
        keys: np.ndarray,
        shape: tuple[int, int],
        owner: np.ndarray,
    ) -> GapValues:
        """The gaps with some keys, without derivatives; zeros are stored for all speeds of their
        shapes.

        Parameters
        ----------
        shape : components of gap velocities, number of coefficients
        owner : (n,) column of the state of each gap
        """
        place, count = (state.t, state.y, state.p, state.before, state.lead), state.count
        end, share, (width, laws) = state.end, state.drift, shape
        middle = self._middle if np.any(state.lead) else self._start
        sizes, _ = self._start.sizes(*place, count=count)
        ahead = sizes if middle is self._start else middle.sizes(*place, count=count)[0]
        before, _ = self._start.moving(*place, state.before, share, count=count)
        speeds = state.after + end * state.before, (1 + end) * share
        both, (moving,) = middle.moving(*place, *speeds, count=count)
        values, parts = GapChanges.zero(keys.size, width, laws), []
        lengths = sizes.size // count, before.size // count
        for one in self.source.kinds(keys):
            kind, variables = self._changing(one, width, owner[one.row], *lengths)
            at_start, in_middle = self._kernels.values(kind.function, variables)
            distance, blocks, normal = at_start(*(sizes[entries] for entries in kind.arguments))
            turned = blocks
            if middle is not self._start:
                place_ahead = (ahead[entries] for entries in kind.arguments)
                (turned,) = in_middle(*place_ahead, normal[..., 0])
            first = (blocks @ before[kind.velocities][..., None])[..., 0]
            last = (turned @ both[kind.velocities][..., None])[..., 0] - end * first
            values.add(kind.row, GapChanges(distance[:, 0, 0], first, last, sizes[kind.laws]))
            parts.append((kind, turned))
        return GapValues(values, directions_of(parts, keys.size * width, moving, zeros=True))

    def _changing(
        self, kind: GapKind, width: int, owner: np.ndarray, geometry: int, velocities: int
    ) -> tuple[GapKind, GapVariables]:
        """Gaps in the columns ``owner`` of states with a number of entries each, without the
        velocities that are zero, and their variables."""
        masks, own = (self._varying, self._moving), owner[:, None]
        variables = GapVariables.of(kind, self.source, width, *masks)
        changing = replace(
            kind,
            arguments=[entries + geometry * own for entries in kind.arguments],
            velocities=kind.velocities[:, list(variables.velocities)] + velocities * own,
            laws=kind.laws + geometry * own,
        )
        return changing, variables

    def _evaluate(
        self,
        kind: GapKind,
        variables: GapVariables,
        geometry: tuple[np.ndarray, np.ndarray],
        velocities: tuple[np.ndarray, np.ndarray],
        impulses: np.ndarray,
        end: float,
        first: np.ndarray,
    ) -> KindSlopes:
        """Gaps of a kind, by the geometry and the velocities at the start and in the middle, and by
        the numbers of those whose tangents they follow."""
        at_start, in_middle = self._kernels.slopes(kind.function, variables)
        sides = [[place[entries] for entries in kind.arguments] for place in geometry]
        start, both = (speeds[kind.velocities] for speeds in velocities)
        results = at_start(*sides[0], start)
        distance, before, blocks, normal, by_distance, by_start, by_normal = results
        results = in_middle(*sides[1], normal[first, :, 0], both, impulses)
        both, wrench, ahead, by_both, by_wrench, *by_first = results
        by_tangents = [by @ by_normal[first] for by in by_first]
        before, laws = before[..., 0], geometry[0][kind.laws]
        values = GapChanges(distance[:, 0, 0], before, both[..., 0] - end * before, laws)
        slopes = by_distance[:, 0], by_start, by_both, by_wrench
        entries = np.hstack(kind.arguments)[:, list(variables.arguments)]
        tangents = entries[first, : by_normal.shape[2]]
        shared = kind, entries, values, wrench[..., 0], blocks, ahead
        return KindSlopes(*shared, *slopes, tangents, *by_tangents)


@once
def source_slopes(model: Model) -> list[SourceSlopes]:
    """Derivatives of the gaps of all sources of a model."""
    return [SourceSlopes(source, model.equations) for source in gap_sources(model)]
