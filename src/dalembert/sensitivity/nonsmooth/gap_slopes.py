"""Derivatives of gaps by the variables of a step, applied to changes or to weights.

With the geometry ``s(t, y, p)`` and velocities ``τ = J v + τ₀`` of the shapes, at the start of the
step and in its middle, ``u⁻ = B(s) τ⁻`` and ``u⁺ + u⁻ = B(s_m, s) τ_m`` of the speeds ``v⁺ + v``,

    dg = g_s ds,      d(B τ) = (B τ)_s ds + B dτ
    d(Wᵀ P) = Jᵀ (Bᵀ P)_s ds + d(Jᵀ f),   f = Bᵀ P      in the middle

where the tangents follow those at the start.

Derivatives are applied to changes of ``q`` (``push``), or transposed to weights (``pull``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from dalembert.analysis.nonsmooth.gaps.gap_source import GapKind
from dalembert.sensitivity.nonsmooth.gap_changes import GapChanges
from dalembert.sensitivity.nonsmooth.gap_values import GapValues, directions_of
from dalembert.sensitivity.nonsmooth.triplets import Sparse, by_rows


@dataclass(frozen=True, eq=False)
class KindSlopes:
    """Gaps of one kind and their derivatives.

    Attributes
    ----------
    kind, entries : the gaps with the velocities that are not zero, (n, m) arguments that vary
    values : of the gaps
    wrench : (n, w) ``Bᵀ P``
    start, blocks : (n, k, w) ``B`` at the start and in the middle
    distance, before : derivatives (n, …, m) of ``g`` and ``u⁻`` by the arguments at the start
    both, wrenches : of ``B τ_m`` and ``f`` by those in the middle
    first : (n, m) arguments that determine the tangents; none in the plane
    both_first, wrenches_first : as ``both`` and ``wrenches``, by these at the start
    """

    kind: GapKind
    entries: np.ndarray
    values: GapChanges
    wrench: np.ndarray
    start: np.ndarray
    blocks: np.ndarray
    distance: np.ndarray
    before: np.ndarray
    both: np.ndarray
    wrenches: np.ndarray
    first: np.ndarray
    both_first: np.ndarray
    wrenches_first: np.ndarray


@dataclass(frozen=True, eq=False)
class PlaceSlopes:
    """Shapes of a source at one position of a step.

    Attributes
    ----------
    geometry : ``s_q``
    velocities : ``τ_q`` at constant speeds
    moving : ``J``
    """

    geometry: Sparse
    velocities: Sparse
    moving: Sparse

    @property
    def by_rows(self) -> PlaceSlopes:
        """The same compressed by rows."""
        return PlaceSlopes(by_rows(self.geometry), by_rows(self.velocities), by_rows(self.moving))


class Part(Protocol):
    """Gaps of one source; ``rows`` are their numbers among all."""

    @property
    def rows(self) -> np.ndarray: ...

    @property
    def values(self) -> GapChanges: ...

    def push(
        self, dq: np.ndarray, path: np.ndarray | None = None
    ) -> tuple[GapChanges, np.ndarray]: ...

    def pull(self, weights: GapChanges, momentum: np.ndarray) -> np.ndarray: ...

    def pull_path(self, weights: GapChanges, momentum: np.ndarray) -> np.ndarray: ...

    def directions(self) -> Sparse: ...


@dataclass(frozen=True, eq=False)
class SourceGaps:
    """Gaps of one source at a state, with ``after`` and the impulses constant.

    Attributes
    ----------
    rows : (n,) numbers of the gaps among all
    kinds : list of KindSlopes
    start, middle : PlaceSlopes
    momenta : derivative of ``Jᵀ f``
    end : as in ``StepState``: velocities after are ``B τ_m − end u⁻``, where ``τ_m`` are those of
        the speeds ``after + end v``
    speeds : numbers of the speeds in ``q``
    shape : components of gap velocities, number of coefficients
    """

    rows: np.ndarray
    kinds: list[KindSlopes]
    start: PlaceSlopes
    middle: PlaceSlopes
    momenta: Sparse
    end: float
    speeds: np.ndarray
    shape: tuple[int, int]

    def push(self, dq: np.ndarray, path: np.ndarray | None = None) -> tuple[GapChanges, np.ndarray]:
        """Changes of the gaps and of ``Wᵀ P`` by those of ``q`` (n_q, c), on any path."""
        (count, _), c = self.middle.moving.shape, dq.shape[1]
        dv = dq[self.speeds]
        geometry, ahead = self.start.geometry @ dq, self.middle.geometry @ dq
        before = self.start.velocities @ dq + self.start.moving @ dv
        both = self.middle.velocities @ dq + self.end * (self.middle.moving @ dv)
        changes, wrench = GapChanges.zero(self.rows.size, *self.shape, c), np.zeros((count, c))
        for part in self.kinds:
            local, moved = geometry[part.entries], ahead[part.entries]
            tangents = geometry[part.first]
            place = part.kind.velocities
            first = part.before @ local + part.start @ before[place]
            own = GapChanges(
                (part.distance[:, None] @ local)[:, 0],
                first,
                part.both @ moved
                + part.both_first @ tangents
                + part.blocks @ both[place]
                - self.end * first,
                geometry[part.kind.laws],
            )
            changes.add(part.kind.row, own)
            scatter(wrench, place, part.wrenches @ moved + part.wrenches_first @ tangents)
        return changes, self.middle.moving.T @ wrench + self.momenta @ dq

    def pull(self, weights: GapChanges, momentum: np.ndarray) -> np.ndarray:
        """Weights of ``q`` from those of the gaps and of ``Wᵀ P``."""
        places, r = (self.start, self.middle), momentum.shape[1]
        geometry, ahead = (np.zeros((place.geometry.shape[0], r)) for place in places)
        before, both = (np.zeros((place.moving.shape[0], r)) for place in places)
        wrench = self.middle.moving @ momentum
        for part in self.kinds:
            own, place = weights.some(part.kind.row), part.kind.velocities
            first = own.before - self.end * own.after
            local = part.distance[:, :, None] * own.distance[:, None]
            local += part.before.swapaxes(1, 2) @ first
            moved = part.both.swapaxes(1, 2) @ own.after
            moved += part.wrenches.swapaxes(1, 2) @ wrench[place]
            tangents = part.both_first.swapaxes(1, 2) @ own.after
            tangents += part.wrenches_first.swapaxes(1, 2) @ wrench[place]
            scatter(geometry, part.entries, local)
            scatter(geometry, part.first, tangents)
            scatter(ahead, part.entries, moved)
            laws = part.kind.laws
            scatter(geometry, laws, own.laws[:, : laws.shape[1]])
            scatter(before, place, part.start.swapaxes(1, 2) @ first)
            scatter(both, place, part.blocks.swapaxes(1, 2) @ own.after)
        q_bar = self.start.geometry.T @ geometry + self.middle.geometry.T @ ahead
        q_bar += self.momenta.T @ momentum
        q_bar += self.start.velocities.T @ before + self.middle.velocities.T @ both
        moving = self.start.moving.T @ before + self.end * (self.middle.moving.T @ both)
        q_bar[self.speeds] += moving
        return np.asarray(q_bar)

    def pull_path(self, weights: GapChanges, momentum: np.ndarray) -> np.ndarray:
        """Weights of the speeds of a path, on which these gaps do not depend."""
        return np.zeros_like(momentum)

    @property
    def by_rows(self) -> SourceGaps:
        """The same with matrices compressed by rows."""
        start, middle = self.start.by_rows, self.middle.by_rows
        return replace(self, start=start, middle=middle, momenta=by_rows(self.momenta))

    @property
    def values(self) -> GapChanges:
        """Values of the gaps, in the order of ``rows``."""
        values = GapChanges.zero(self.rows.size, *self.shape)
        for part in self.kinds:
            values.add(part.kind.row, part.values)
        return values

    def directions(self) -> Sparse:
        """``W_m`` (n k, n_v) of the gaps of the source."""
        kinds = [(part.kind, part.blocks) for part in self.kinds]
        return directions_of(kinds, self.rows.size * self.shape[0], by_rows(self.middle.moving))


@dataclass(frozen=True, eq=False)
class Gaps(GapValues):
    """Gaps of all sources at a state, and their derivatives.

    Attributes
    ----------
    parts : gaps of each source
    """

    parts: list[Part]

    @classmethod
    def of(cls, parts: Sequence[Part]) -> Gaps:
        """Gaps of several sources, in the order of their rows."""
        own = [(part.rows, GapValues(part.values, part.directions())) for part in parts]
        joined = GapValues.joined(own)
        return cls(joined.values, joined.directions, list(parts))

    def push(self, dq: np.ndarray, path: np.ndarray | None = None) -> tuple[GapChanges, np.ndarray]:
        """Changes of the gaps and of ``Wᵀ P`` by those of ``q`` (n_q, c), and of the speeds
        (n_v, c) at the end of the path of means, 0 by default."""
        changes, momentum = self.values.like(dq.shape[1]), np.zeros(0)
        for part in self.parts:
            change, own = part.push(dq, path)
            changes.add(part.rows, change)
            momentum = own if not momentum.size else momentum + own
        return changes, momentum

    def pull(self, weights: GapChanges, momentum: np.ndarray) -> np.ndarray:
        """Weights of ``q`` from those of the gaps and of ``Wᵀ P``."""
        pulled = [part.pull(weights.some(part.rows), momentum) for part in self.parts]
        return np.asarray(sum(pulled[1:], pulled[0]))

    def pull_path(self, weights: GapChanges, momentum: np.ndarray) -> np.ndarray:
        """Weights of the speeds at the end of the path of means."""
        pulled = [part.pull_path(weights.some(part.rows), momentum) for part in self.parts]
        return np.asarray(sum(pulled[1:], pulled[0]))


def scatter(total: np.ndarray, entries: np.ndarray, values: np.ndarray) -> None:
    """Add values (n, m, c) to the rows ``entries`` (n, m) of an array (rows, c)."""
    flat, rows = entries.ravel(), total.shape[0]
    for column in range(total.shape[1]):
        total[:, column] += np.bincount(flat, values[..., column].ravel(), rows)
