"""Gaps of a source with some keys, and their derivatives.

All gaps of a kind are evaluated together by one function of their shapes, so that no graph depends
on the pattern of contacts.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.gap_source import GapFormulas, GapKind, GapSource
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.model import Model
from dalembert.sensitivity.nonsmooth.blocked_kernel import BlockedKernel
from dalembert.sensitivity.nonsmooth.gap_changes import GapChanges
from dalembert.sensitivity.nonsmooth.gap_slopes import (
    KindSlopes,
    PlaceSlopes,
    SourceGaps,
    scatter,
)
from dalembert.sensitivity.nonsmooth.gap_values import GapValues, directions_of
from dalembert.sensitivity.nonsmooth.slope_function import SlopeFunction
from dalembert.symbolic.once import once

CACHED = 64
"""Upper limit of the number of functions whose derivatives are cached."""
GapFunctions = Callable[[ca.Function, int], tuple[ca.Function, ...]]
"""Functions of gaps with a number of components, by the function of their kind."""


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
        return 1 if self.y.ndim == 1 else self.y.shape[1]


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
        self._kernels: dict[tuple[GapFunctions, ca.Function, int], list[BlockedKernel]] = {}

    def at(
        self,
        state: StepState,
        rows: np.ndarray,
        keys: np.ndarray,
        impulses: np.ndarray,
        laws: int,
        owner: np.ndarray | None = None,
    ) -> SourceGaps:
        """The gaps with some keys.

        Parameters
        ----------
        rows : their numbers among all
        impulses : (n, k), as many components as the velocities have in the result
        laws : number of coefficients
        owner : (n,) column of the state of each gap; the first one by default
        """
        place = state.t, state.y, state.p, state.before, state.lead
        count, end, share = state.count, state.end, state.drift
        middle = self._middle if np.any(state.lead) else self._start
        geometry, (by_q,) = self._start.geometry(*place, count=count)
        ahead, (ahead_by_q,) = geometry, (by_q,)
        if middle is not self._start:
            ahead, (ahead_by_q,) = middle.geometry(*place, count=count)
        before, slopes = self._start.velocities(*place, state.before, share, count=count)
        start = PlaceSlopes(by_q, *slopes)
        both, slopes = middle.velocities(
            *place, state.after + end * state.before, (1 + end) * share, count=count
        )
        features = self.source.kinds(keys)
        if owner is not None:
            sizes = geometry.size // count, before.size // count
            features = [_in_columns(kind, owner[kind.row], *sizes) for kind in features]
        kinds = [
            self._evaluate(kind, (geometry, ahead), (before, both), impulses[kind.row], end)
            for kind in features
        ]
        wrench = np.zeros((before.size, 1))
        for part in kinds:
            scatter(wrench, part.kind.velocities, part.wrench[..., None])
        columns = wrench.reshape(count, -1).T
        momenta = middle.momenta(*place, columns, count=count)[1][0]
        first, n, width = self._e.y.numel(), self._e.v.numel(), by_q.shape[1] // count
        speeds = (width * np.arange(count)[:, None] + first + np.arange(n)).ravel()
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
        for one in self.source.kinds(keys):
            kind = _in_columns(one, owner[one.row], sizes.size // count, before.size // count)
            (kernel,) = self._kernels_of(_gap_values, kind.function, width)
            distance, blocks = kernel(*(sizes[entries] for entries in kind.arguments))
            turned = blocks
            if middle is not self._start:
                turned = kernel(*(ahead[entries] for entries in kind.arguments))[1]
            first = (blocks @ before[kind.velocities][..., None])[..., 0]
            last = (turned @ both[kind.velocities][..., None])[..., 0] - end * first
            values.add(kind.row, GapChanges(distance[:, 0, 0], first, last, sizes[kind.laws]))
            parts.append((kind, turned))
        return GapValues(values, directions_of(parts, keys.size * width, moving, zeros=True))

    def _kernels_of(
        self, functions: GapFunctions, function: ca.Function, width: int
    ) -> list[BlockedKernel]:
        """Kernels of functions of the gaps of one kind."""
        key = functions, function, width
        if key not in self._kernels:
            self._kernels[key] = [BlockedKernel(own) for own in functions(function, width)]
        return self._kernels[key]

    def _evaluate(
        self,
        kind: GapKind,
        geometry: tuple[np.ndarray, np.ndarray],
        velocities: tuple[np.ndarray, np.ndarray],
        impulses: np.ndarray,
        end: float,
    ) -> KindSlopes:
        """Gaps of a kind, by the geometry and the velocities at the start and in the middle."""
        width = impulses.shape[1]
        results = []
        kernels = self._kernels_of(_gap_slopes, kind.function, width)
        for kernel, place, speeds, rest in zip(
            kernels, geometry, velocities, ([], [impulses]), strict=True
        ):
            columns = [place[entries] for entries in kind.arguments]
            results.append(kernel(*columns, speeds[kind.velocities], *rest))
        distance, start, blocks, by_distance, by_start = results[0]
        both, wrench, ahead, by_both, by_wrench = results[1]
        before = start[..., 0]
        laws = geometry[0][kind.laws]
        values = GapChanges(distance[:, 0, 0], before, both[..., 0] - end * before, laws)
        slopes = by_distance[:, 0], by_start, by_both, by_wrench
        entries = np.hstack(kind.arguments)
        return KindSlopes(kind, entries, values, wrench[..., 0], blocks, ahead, *slopes)


def _in_columns(kind: GapKind, owner: np.ndarray, geometry: int, velocities: int) -> GapKind:
    """Gaps in the columns ``owner`` of states with a number of entries each."""
    own = owner[:, None]
    return replace(
        kind,
        arguments=[entries + geometry * own for entries in kind.arguments],
        velocities=kind.velocities + velocities * own,
        laws=kind.laws + geometry * own,
    )


@once
def source_slopes(model: Model) -> list[SourceSlopes]:
    """Derivatives of the gaps of all sources of a model."""
    return [SourceSlopes(source, model.equations) for source in gap_sources(model)]


def _formulas(function: ca.Function, width: int) -> tuple[list[ca.SX], ca.SX, ca.SX]:
    """Arguments, ``g`` and ``B`` with ``width`` rows."""
    arguments = [ca.SX.sym("s", function.numel_in(k)) for k in range(function.n_in())]
    distance, blocks, *_ = function.call(arguments)
    rows = min(width, blocks.shape[0])
    zeros = ca.SX.zeros(width - rows, blocks.shape[1])
    return arguments, distance, ca.vertcat(blocks[:rows, :], zeros)


@lru_cache(CACHED)
def _gap_values(function: ca.Function, width: int) -> tuple[ca.Function]:
    """``arguments → g, B``."""
    arguments, *results = _formulas(function, width)
    results = [ca.densify(part) for part in results]
    return (ca.Function("gap_values", arguments, results, {"cse": True}),)


@lru_cache(CACHED)
def _gap_slopes(function: ca.Function, width: int) -> tuple[ca.Function, ca.Function]:
    """``(arguments, τ) → g, B τ, B`` and derivatives of ``g`` and ``B τ`` by the arguments; and
    ``(arguments, τ, P) → B τ, f, B`` and derivatives of ``B τ`` and ``f``."""
    arguments, distance, blocks = _formulas(function, width)
    twist, impulse = ca.SX.sym("twist", blocks.shape[1]), ca.SX.sym("P", width)
    speeds, wrench = ca.mtimes(blocks, twist), ca.mtimes(blocks.T, impulse)
    geometry = ca.vertcat(*arguments)
    by_distance, by_speeds, by_wrench = (
        ca.jacobian(value, geometry) for value in (distance, speeds, wrench)
    )
    start = [*arguments, twist], [distance, speeds, blocks, by_distance, by_speeds]
    middle = [*arguments, twist, impulse], [speeds, wrench, blocks, by_speeds, by_wrench]
    first, second = (
        ca.Function("gap_slopes", inputs, [ca.densify(part) for part in outputs], {"cse": True})
        for inputs, outputs in (start, middle)
    )
    return first, second
