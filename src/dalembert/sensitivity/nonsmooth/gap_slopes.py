"""Derivatives of gaps by the variables of a step, applied to changes or to weights.

With the geometry ``s(t, y, p)``, velocities ``τ = J v + τ₀`` and ``u = B(s) τ``,

    dg = g_s ds,      du = (B τ)_s ds + B dτ,      d(Wᵀ P) = Jᵀ (Bᵀ P)_s ds + d(Jᵀ f),   f = Bᵀ P

Derivatives are applied to changes of ``q`` (``push``), or transposed to weights (``pull``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.gaps.gap_source import GapKind
from dalembert.sensitivity.nonsmooth.gap_changes import GapChanges
from dalembert.sensitivity.nonsmooth.slope_function import Sparse


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
    geometry : ``s_q``
    velocities : ``τ_q`` for both speeds, without the first one's own change
    moving : ``J``
    momenta : derivative of ``Jᵀ f``
    speeds : numbers of the speeds in ``q``
    shape : components of gap velocities, number of coefficients
    """

    rows: np.ndarray
    kinds: list[KindSlopes]
    geometry: Sparse
    velocities: list[Sparse]
    moving: Sparse
    momenta: Sparse
    speeds: np.ndarray
    shape: tuple[int, int]

    def push(self, dq: np.ndarray, path: np.ndarray | None = None) -> tuple[GapChanges, np.ndarray]:
        """Changes of the gaps and of ``Wᵀ P`` by those of ``q`` (n_q, c), on any path."""
        count, c = self.moving.shape[0], dq.shape[1]
        geometry, (before, after) = self.geometry @ dq, (slope @ dq for slope in self.velocities)
        before = before + self.moving @ dq[self.speeds]
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
            scatter(wrench, place, part.wrenches @ local)
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
            scatter(geometry, part.entries, local)
            laws = part.kind.laws
            scatter(geometry, laws, own.laws[:, : laws.shape[1]])
            for total, weight in zip(speeds, (own.before, own.after), strict=True):
                scatter(total, place, part.blocks.swapaxes(1, 2) @ weight)
        q_bar = self.geometry.T @ geometry + self.momenta.T @ momentum
        for slope, weight in zip(self.velocities, speeds, strict=True):
            q_bar += slope.T @ weight
        q_bar[self.speeds] += self.moving.T @ speeds[0]
        return np.asarray(q_bar)

    def pull_path(self, weights: GapChanges, momentum: np.ndarray) -> np.ndarray:
        """Weights of the speeds of a path, on which these gaps do not depend."""
        return np.zeros_like(momentum)

    @property
    def values(self) -> GapChanges:
        """Values of the gaps, in the order of ``rows``."""
        values = GapChanges.zero(self.rows.size, *self.shape)
        for part in self.kinds:
            values.add(part.kind.row, part.values)
        return values

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


@dataclass(frozen=True, eq=False)
class Gaps:
    """Gaps of all sources at a state.

    Attributes
    ----------
    parts : gaps of each source
    values : GapChanges
    directions : (n k, n_v) ``W``
    """

    parts: list[Part]
    values: GapChanges
    directions: Sparse

    @classmethod
    def of(cls, parts: Sequence[Part]) -> Gaps:
        """Gaps of several sources, in the order of their rows."""
        count = sum(part.rows.size for part in parts)
        own = [part.values for part in parts]
        values = GapChanges.zero(count, own[0].before.shape[1], own[0].laws.shape[1])
        for part, gaps in zip(parts, own, strict=True):
            values.add(part.rows, gaps)
        directions = [part.directions() for part in parts]
        joined = directions[0] if len(parts) == 1 else scipy.sparse.vstack(directions)
        across = scipy.sparse.csr_array(joined)
        order = np.argsort(np.concatenate([part.rows for part in parts]))
        if (np.diff(order) != 1).any():
            width = values.before.shape[1]
            across = across[(order[:, None] * width + np.arange(width)).ravel()]
        across.sort_indices()
        return cls(list(parts), values, across)

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
