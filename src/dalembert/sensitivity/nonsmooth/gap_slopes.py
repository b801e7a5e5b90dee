"""Gaps with some keys, and their derivatives by the variables of a step.

All gaps of a kind are evaluated together by one function of their shapes, so that no graph depends
on the pattern of contacts. With the geometry ``s(t, y, p)``, velocities ``τ = J v + τ₀`` and
``u = B(s) τ``,

    dg = g_s ds,      du = (B τ)_s ds + B dτ,      d(Wᵀ P) = Jᵀ (Bᵀ P)_s ds + d(Jᵀ f),   f = Bᵀ P

Derivatives are applied to changes of ``q`` (``push``), or transposed to weights (``pull``).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np
import scipy

from dalembert.analysis.nonsmooth.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps import GapKind, GapSource
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.model import Model
from dalembert.sensitivity.nonsmooth.slope_function import SlopeFunction, Sparse
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.once import once

SMALLEST = 16
"""Number of columns of the smallest mapped function; larger ones have 2, 4, 8 … times as many."""


@dataclass(frozen=True, eq=False)
class StepState:
    """Arguments of the gaps of a step.

    Attributes
    ----------
    t, y, p : position
    before, after : speeds at the start and at the end
    drift : 1 for velocities, 0 for displacements in their place
    """

    t: float
    y: np.ndarray
    p: np.ndarray
    before: np.ndarray
    after: np.ndarray
    drift: float = 1.0


@dataclass(frozen=True, eq=False)
class GapChanges:
    """Values of gaps, their changes, or weights of these.

    Attributes
    ----------
    distance : (n, …) ``g``
    before, after : (n, k, …) ``u`` for both speeds
    laws : (n, c, …) coefficients: ``FIRST``, and friction of each group
    """

    distance: np.ndarray
    before: np.ndarray
    after: np.ndarray
    laws: np.ndarray

    @classmethod
    def zero(cls, count: int, width: int, laws: int, *columns: int) -> GapChanges:
        """Zeros, ``columns`` of each."""
        shapes = (count,), (count, width), (count, width), (count, laws)
        return cls(*(np.zeros((*shape, *columns)) for shape in shapes))

    def like(self, columns: int) -> GapChanges:
        """Zeros of the same shapes, ``columns`` of each."""
        return GapChanges.zero(*self.before.shape[:2], self.laws.shape[1], columns)

    def add(self, rows: np.ndarray, other: GapChanges) -> None:
        """Add to some rows; gaps with fewer groups of friction have fewer coefficients."""
        for name in ("distance", "before", "after"):
            getattr(self, name)[rows] += getattr(other, name)
        self.laws[rows, : other.laws.shape[1]] += other.laws

    def some(self, rows: np.ndarray) -> GapChanges:
        """Some rows."""
        return GapChanges(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))


@dataclass(frozen=True, eq=False)
class KindSlopes:
    """Gaps of one kind and their derivatives.

    Attributes
    ----------
    kind, entries : the gaps, (n, m) all arguments
    values : of the gaps
    wrench : (n, w) ``Bᵀ P``
    blocks : (n, k, w) ``B``
    distance, before, after, wrenches : derivatives (n, …, m) by the arguments
    """

    kind: GapKind
    entries: np.ndarray
    values: GapChanges
    wrench: np.ndarray
    blocks: np.ndarray
    distance: np.ndarray
    before: np.ndarray
    after: np.ndarray
    wrenches: np.ndarray


@dataclass(frozen=True, eq=False)
class SourceGaps:
    """Gaps of one source at a state, with ``after`` and the impulses constant.

    Attributes
    ----------
    rows : (n,) numbers of the gaps among all
    kinds : list of KindSlopes
    geometry : ``s_q``
    velocities : ``τ_q`` for both speeds, without the first one's own change
    moving : ``J``
    momenta : derivative of ``Jᵀ f``
    first : number of the first speed in ``q``
    shape : components of gap velocities, number of coefficients
    """

    rows: np.ndarray
    kinds: list[KindSlopes]
    geometry: Sparse
    velocities: list[Sparse]
    moving: Sparse
    momenta: Sparse
    first: int
    shape: tuple[int, int]

    def push(self, dq: np.ndarray) -> tuple[GapChanges, np.ndarray]:
        """Changes of the gaps and of ``Wᵀ P`` by those of ``q`` (n_q, c)."""
        (count, n), c = self.moving.shape, dq.shape[1]
        geometry, (before, after) = self.geometry @ dq, (slope @ dq for slope in self.velocities)
        before = before + self.moving @ dq[self.first : self.first + n]
        changes, wrench = GapChanges.zero(self.rows.size, *self.shape, c), np.zeros((count, c))
        for part in self.kinds:
            local, place = geometry[part.entries], part.kind.velocities
            own = GapChanges(
                (part.distance[:, None] @ local)[:, 0],
                part.before @ local + part.blocks @ before[place],
                part.after @ local + part.blocks @ after[place],
                geometry[part.kind.laws],
            )
            changes.add(part.kind.row, own)
            _scatter(wrench, place, part.wrenches @ local)
        return changes, self.moving.T @ wrench + self.momenta @ dq

    def pull(self, weights: GapChanges, momentum: np.ndarray) -> np.ndarray:
        """Weights of ``q`` from those of the gaps and of ``Wᵀ P``."""
        r = momentum.shape[1]
        geometry = np.zeros((self.geometry.shape[0], r))
        speeds = np.zeros((2, self.moving.shape[0], r))
        wrench = self.moving @ momentum
        for part in self.kinds:
            own, place = weights.some(part.kind.row), part.kind.velocities
            local = part.distance[:, :, None] * own.distance[:, None]
            local += part.before.swapaxes(1, 2) @ own.before
            local += part.after.swapaxes(1, 2) @ own.after
            local += part.wrenches.swapaxes(1, 2) @ wrench[place]
            _scatter(geometry, part.entries, local)
            laws = part.kind.laws
            _scatter(geometry, laws, own.laws[:, : laws.shape[1]])
            for total, weight in zip(speeds, (own.before, own.after), strict=True):
                _scatter(total, place, part.blocks.swapaxes(1, 2) @ weight)
        q_bar = self.geometry.T @ geometry + self.momenta.T @ momentum
        for slope, weight in zip(self.velocities, speeds, strict=True):
            q_bar += slope.T @ weight
        q_bar[self.first : self.first + self.moving.shape[1]] += self.moving.T @ speeds[0]
        return np.asarray(q_bar)

    def directions(self) -> Sparse:
        """``W`` (n k, n_v) of the gaps of the source."""
        parts, width = [], self.shape[0]
        for part in self.kinds:
            row = part.kind.row[:, None, None] * width + np.arange(width)[:, None]
            place = np.broadcast_to(part.kind.velocities[:, None], part.blocks.shape)
            used = part.blocks != 0
            row = np.broadcast_to(row, part.blocks.shape)
            parts.append((part.blocks[used], row[used], place[used]))
        shape = self.rows.size * width, self.moving.shape[0]
        if not parts:
            return scipy.sparse.csr_array((shape[0], self.moving.shape[1]))
        values, row, column = (np.concatenate(entries) for entries in zip(*parts, strict=True))
        return (
            scipy.sparse.csr_array(scipy.sparse.coo_array((values, (row, column)), shape=shape))
            @ self.moving
        )


class SourceSlopes:
    """Derivatives of the gaps of one source.

    Parameters
    ----------
    source : GapSource
    e : equations of the model
    """

    def __init__(self, source: GapSource, e: Equations):
        self.source, self.first = source, e.y.numel()
        formulas = source.formulas
        moving = ca.sparsify(ca.jacobian(formulas.velocities, e.v))
        q = ca.vertcat(e.y, e.v, e.t, e.p)
        still = ca.substitute(formulas.velocities, e.v, ca.SX.zeros(e.v.numel()))
        share, wrench = ca.SX.sym("share"), ca.SX.sym("f", formulas.velocities.numel())
        velocities = ca.mtimes(moving, e.v) + share * still
        elsewhere = ca.vertcat(e.y, ca.SX.sym("none", e.v.numel()), e.t, e.p)
        self._geometry = SlopeFunction("geometry", [e.t, e.y, e.p], formulas.geometry, [q])
        self._velocities = SlopeFunction(
            "velocities", [e.t, e.y, e.v, e.p, share], velocities, [elsewhere, e.v]
        )
        self._momenta = SlopeFunction(
            "momenta", [e.t, e.y, e.p, wrench], ca.mtimes(moving.T, wrench), [elsewhere]
        )
        self._kernels: dict[tuple[ca.Function, int, int], Kernel] = {}

    def at(
        self,
        state: StepState,
        rows: np.ndarray,
        keys: np.ndarray,
        impulses: np.ndarray,
        laws: int,
    ) -> SourceGaps:
        """The gaps with some keys.

        Parameters
        ----------
        rows : their numbers among all
        impulses : (n, k), as many components as the velocities have in the result
        laws : number of coefficients
        """
        t, y, p, share = state.t, state.y, state.p, state.drift
        geometry, (by_q,) = self._geometry(t, y, p)
        before, (before_by_q, moving) = self._velocities(t, y, state.before, p, share)
        after, (after_by_q, _) = self._velocities(t, y, state.after, p, share)
        kinds = [
            self._evaluate(kind, geometry, before, after, impulses[kind.row])
            for kind in self.source.kinds(keys)
        ]
        wrench = np.zeros((before.size, 1))
        for part in kinds:
            _scatter(wrench, part.kind.velocities, part.wrench[..., None])
        momenta = self._momenta(t, y, p, wrench)[1][0]
        slopes = [before_by_q, after_by_q]
        shape = impulses.shape[1], laws
        return SourceGaps(rows, kinds, by_q, slopes, moving, momenta, self.first, shape)

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
        key = kind.function, width, size
        if key not in self._kernels:
            self._kernels[key] = Kernel(_gap_slopes(kind.function, width).map(size))
        padded = np.arange(size) % count
        columns = [geometry[entries[padded]].T for entries in kind.arguments]
        columns += [speeds[kind.velocities[padded]].T for speeds in (before, after)]
        results = [
            result.T.reshape(size, -1, result.shape[0])[:count].swapaxes(1, 2)
            for result in self._kernels[key](*columns, impulses[padded].T)
        ]
        distance, speeds, wrench, blocks, by_distance, *slopes = results
        laws = geometry[kind.laws]
        values = GapChanges(distance[:, 0, 0], speeds[..., 0], speeds[..., 1], laws)
        entries = np.hstack(kind.arguments)
        return KindSlopes(kind, entries, values, wrench[..., 0], blocks, by_distance[:, 0], *slopes)


@once
def source_slopes(model: Model) -> list[SourceSlopes]:
    """Derivatives of the gaps of all sources of a model."""
    return [SourceSlopes(source, model.equations) for source in gap_sources(model)]


@cache
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


def _scatter(total: np.ndarray, entries: np.ndarray, values: np.ndarray) -> None:
    """Add values (n, m, c) to the rows ``entries`` (n, m) of an array (rows, c)."""
    flat, rows = entries.ravel(), total.shape[0]
    for column in range(total.shape[1]):
        total[:, column] += np.bincount(flat, values[..., column].ravel(), rows)
