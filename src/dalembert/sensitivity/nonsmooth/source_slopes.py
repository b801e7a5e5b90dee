"""Gaps of a source with some keys, and their derivatives.

All gaps of a kind are evaluated together by one function of their shapes, so that no graph depends
on the pattern of contacts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache, partial

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.gap_source import GapKind, GapSource
from dalembert.analysis.nonsmooth.turned_speeds import turned_speeds
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.model import Model
from dalembert.sensitivity.nonsmooth.gap_changes import GapChanges
from dalembert.sensitivity.nonsmooth.gap_slopes import KindSlopes, SourceGaps, scatter
from dalembert.sensitivity.nonsmooth.slope_function import SlopeFunction
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.once import once

SMALLEST, LARGEST = 16, 512
"""Numbers of columns of the smallest and the largest mapped function; those between have 2, 4, 8 …
times as many as the smallest."""
CACHED = 64
"""Upper limit of the number of functions whose derivatives are cached."""


@dataclass(frozen=True, eq=False)
class StepState:
    """Arguments of the gaps of a step, or of several steps in columns.

    Attributes
    ----------
    t, y, p : position
    before, after : speeds at the start and at the end
    drift : 1 for velocities, 0 for displacements in their place
    lead : ``(1−θ) h``, by which bodies turn with the speeds ``before`` for the directions ``W E``
    """

    t: float | np.ndarray
    y: np.ndarray
    p: np.ndarray
    before: np.ndarray
    after: np.ndarray
    drift: float = 1.0
    lead: float | np.ndarray = 0.0

    @property
    def count(self) -> int:
        """Number of steps."""
        return 1 if self.y.ndim == 1 else self.y.shape[1]


class SourceSlopes:
    """Derivatives of the gaps of one source.

    Parameters
    ----------
    source : GapSource
    e : equations of the model
    """

    def __init__(self, source: GapSource, e: Equations):
        self.source, self._e = source, e
        formulas = source.formulas
        q = ca.vertcat(e.y, e.v, e.t, e.p)
        still = ca.substitute(formulas.velocities, e.v, ca.SX.zeros(e.v.numel()))
        share, wrench = ca.SX.sym("share"), ca.SX.sym("f", formulas.velocities.numel())
        start, lead = ca.SX.sym("start", e.v.numel()), ca.SX.sym("lead")
        turned = turned_speeds(e.manifold, lead * start, e.v)
        moving = ca.mtimes(ca.jacobian(formulas.velocities, e.v), ca.jacobian(turned, e.v))
        moving = ca.sparsify(moving)
        velocities = ca.mtimes(moving, e.v) + share * still
        elsewhere = ca.vertcat(e.y, start, e.t, e.p)
        self._geometry = SlopeFunction("geometry", [e.t, e.y, e.p], formulas.geometry, [q])
        self._velocities = SlopeFunction(
            "velocities", [e.t, e.y, e.v, e.p, share, start, lead], velocities, [elsewhere, e.v]
        )
        self._momenta = SlopeFunction(
            "momenta",
            [e.t, e.y, e.p, wrench, start, lead],
            ca.mtimes(moving.T, wrench),
            [elsewhere],
        )
        self._kernels: dict[tuple[ca.Function, int, int], Kernel] = {}

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
        t, y, p, share, count = state.t, state.y, state.p, state.drift, state.count
        geometry, (by_q,) = self._geometry(t, y, p, count=count)
        velocities, turn = partial(self._velocities, count=count), (state.before, state.lead)
        before, (before_by_q, moving) = velocities(t, y, state.before, p, share, *turn)
        after, (after_by_q, _) = velocities(t, y, state.after, p, share, *turn)
        features = self.source.kinds(keys)
        if owner is not None:
            sizes = geometry.size // count, before.size // count
            features = [_in_columns(kind, owner[kind.row], *sizes) for kind in features]
        kinds = [
            self._evaluate(kind, geometry, before, after, impulses[kind.row]) for kind in features
        ]
        wrench = np.zeros((before.size, 1))
        for part in kinds:
            scatter(wrench, part.kind.velocities, part.wrench[..., None])
        columns = wrench.reshape(count, -1).T
        momenta = self._momenta(t, y, p, columns, *turn, count=count)[1][0]
        slopes = [before_by_q, after_by_q]
        first, n, width = self._e.y.numel(), self._e.v.numel(), by_q.shape[1] // count
        speeds = (width * np.arange(count)[:, None] + first + np.arange(n)).ravel()
        shape = impulses.shape[1], laws
        return SourceGaps(rows, kinds, by_q, slopes, moving, momenta, speeds, shape)

    def _evaluate(
        self,
        kind: GapKind,
        geometry: np.ndarray,
        before: np.ndarray,
        after: np.ndarray,
        impulses: np.ndarray,
    ) -> KindSlopes:
        count, width = impulses.shape
        size = SMALLEST << max(0, int(np.ceil(np.log2(count / SMALLEST))))
        size = min(size, LARGEST)
        key = kind.function, width, size
        if key not in self._kernels:
            self._kernels[key] = Kernel(_gap_slopes(kind.function, width).map(size))
        padded = np.arange(-(-count // size) * size) % count
        columns = [geometry[entries[padded]] for entries in kind.arguments]
        columns += [speeds[kind.velocities[padded]] for speeds in (before, after)]
        columns.append(impulses[padded])
        parts = [
            self._kernels[key](*(column[begin : begin + size].T for column in columns))
            for begin in range(0, padded.size, size)
        ]
        results = [
            np.concatenate([part.T.reshape(size, -1, part.shape[0]) for part in output])
            for output in zip(*parts, strict=True)
        ]
        results = [result[:count].swapaxes(1, 2) for result in results]
        distance, speeds, wrench, blocks, by_distance, *slopes = results
        laws = geometry[kind.laws]
        values = GapChanges(distance[:, 0, 0], speeds[..., 0], speeds[..., 1], laws)
        entries = np.hstack(kind.arguments)
        return KindSlopes(kind, entries, values, wrench[..., 0], blocks, by_distance[:, 0], *slopes)


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


@lru_cache(CACHED)
def _gap_slopes(function: ca.Function, width: int) -> ca.Function:
    """``(arguments, τ⁻, τ⁺, P) → g, (u⁻, u⁺), f, B``, and derivatives of ``g``, ``u⁻``, ``u⁺`` and
    ``f`` by the arguments."""
    arguments = [ca.SX.sym("s", function.numel_in(k)) for k in range(function.n_in())]
    distance, blocks, *_ = function.call(arguments)
    rows = min(width, blocks.shape[0])
    blocks = ca.vertcat(blocks[:rows, :], ca.SX.zeros(width - rows, blocks.shape[1]))
    before, after = (ca.SX.sym(name, blocks.shape[1]) for name in ("before", "after"))
    impulse = ca.SX.sym("P", width)
    speeds = [ca.mtimes(blocks, twist) for twist in (before, after)]
    wrench, geometry = ca.mtimes(blocks.T, impulse), ca.vertcat(*arguments)
    slopes = [ca.jacobian(value, geometry) for value in (distance, *speeds, wrench)]
    outputs = [distance, ca.horzcat(*speeds), wrench, blocks, *slopes]
    inputs = [*arguments, before, after, impulse]
    dense = [ca.densify(output) for output in outputs]
    return ca.Function("gap_slopes", inputs, dense, {"cse": True})
