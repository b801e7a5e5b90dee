"""Means of gaps over the path of a step, and their derivatives.

    u⁺ + u⁻ = W̄ (v⁺ + v) + 2 w̄,     W̄ = Σ β W(y ⊕ s δ) R,     ḡ = g(y ⊕ δ) − W̄ δ − h w̄

as functions of ``q = (y, v, t, p)`` and of the speeds ``v_δ`` at the end of the path ``δ = h (θ
v_δ + (1−θ) v)``; ``R`` are the shares of the displacement per ``s`` in ``δ``, and ones in the rows
along tangents, ``β`` the weights of means.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.mean_gaps import LOBATTO
from dalembert.model.graph.model import Model
from dalembert.sensitivity.nonsmooth.gap_changes import GapChanges
from dalembert.sensitivity.nonsmooth.gap_matrices import NAMES, MatrixGaps, gap_matrices
from dalembert.sensitivity.nonsmooth.slope_function import SlopeFunction
from dalembert.sensitivity.nonsmooth.source_slopes import SourceSlopes, StepState
from dalembert.sensitivity.nonsmooth.triplets import Sparse
from dalembert.symbolic.once import once

SPEEDS = "before", "after", "ending"
"""Velocities at the nodes of the speeds at the start, at the end and of the path."""


@dataclass(frozen=True, eq=False)
class Path:
    """Path of a step.

    Attributes
    ----------
    speeds : (n_v,) ``v_δ``
    h : step [s]
    theta : ``θ``
    points : PathPoints of the model
    """

    speeds: np.ndarray
    h: float
    theta: float
    points: PathPoints

    @property
    def shares(self) -> tuple[float, float]:
        """Durations by which ``δ`` contains the speeds ``v`` and ``v_δ`` [s]."""
        return (1 - self.theta) * self.h, self.theta * self.h


class PathPoints:
    """Points ``y ⊕ s δ`` and shares ``R`` of a model, with derivatives by ``y`` and ``δ``."""

    def __init__(self, model: Model):
        e = model.equations
        share, moved, shares = e.manifold.path
        inputs, by = [e.manifold.y, e.manifold.delta, share], [e.manifold.y, e.manifold.delta]
        self.position = SlopeFunction("path", inputs, moved, by)
        self.shares = SlopeFunction("shares", inputs, shares, by)


@once
def path_points(model: Model) -> PathPoints:
    """Points of paths of a model."""
    return PathPoints(model)


def path_gaps(
    source: SourceSlopes,
    state: StepState,
    path: Path,
    rows: np.ndarray,
    keys: np.ndarray,
    impulses: np.ndarray,
    laws: int,
    kept: np.ndarray,
) -> MatrixGaps:
    """Means of the gaps with some keys; arguments as in ``SourceSlopes.at``.

    Velocities before are those at the start by the midpoint rule, except of ``kept`` gaps, where
    they are means, too.
    """
    points = _NodeGaps(source, state, path, keys, impulses, laws)
    nodes, (first_share, share) = np.array(list(LOBATTO.values())), path.shares
    mean, last = points.sum_of(nodes), points.count - 1
    values = points.values
    before, after, ending = (
        (mean @ part.ravel()).reshape(impulses.shape)
        for part in (values.before, values.after, points.ending)
    )
    slopes = {name: mean @ points.slopes[name] for name in ("before", "after")}
    distance = points.at(last, values.distance) - (first_share * before + share * ending)[:, 0]
    changes = first_share * slopes["before"] + share * (mean @ points.slopes["ending"])
    normal = changes[:: impulses.shape[1]]
    slopes["distance"] = points.at(last, points.slopes["distance"]) - normal
    slopes["laws"] = points.at(0, points.slopes["laws"])
    if path.theta == 0.5:
        first = points.sum_of(np.eye(1, nodes.size)[0])
        start = (first @ values.before.ravel()).reshape(before.shape)
        turns = np.where(kept[:, None], 0.0, before - start)
        before, after = before - turns, after + state.end * turns
        own = scipy.sparse.diags_array(np.repeat(~kept, turns.shape[1]).astype(float))
        change = own @ (slopes["before"] - first @ points.slopes["before"])
        slopes["before"] = slopes["before"] - change
        slopes["after"] = slopes["after"] + state.end * change
    matrices = {name: scipy.sparse.csr_array(slopes[name]) for name in NAMES}
    across = scipy.sparse.csr_array(mean @ points.across)
    momentum = scipy.sparse.csr_array(points.momentum(nodes))
    means = GapChanges(distance, before, after, points.at(0, values.laws))
    count = momentum.shape[1] - path.speeds.size
    return MatrixGaps(rows, means, across, matrices, momentum, count)


class _Nodes:
    """Nodes of a path, with the shares there, and again with ones in their place; all follow one
    another, and so do derivatives by ``q`` and the speeds of the path.

    Attributes
    ----------
    fractions : (1, m) of the path
    y, shares : positions and shares, one node after the other
    scaling : the shares as diagonal blocks on top of each other
    turns : derivatives of the shares times the speeds that they multiply, without these
    changes : derivatives of the speeds at the start, at the end and of the path, times the shares;
        those at the end do not change on their own
    chain : derivatives of ``q`` at the nodes, with speeds times the shares
    """

    def __init__(self, state: StepState, path: Path):
        self.fractions = np.tile(list(LOBATTO), 2)[None]
        count, v, n, rest = self.fractions.size, state.before, state.before.size, 1 + state.p.size
        part, share = path.shares
        place = state.y, part * v + share * path.speeds, self.fractions
        self.y, by = path.points.position(*place, count=count)
        shares, own_by = path.points.shares(*place, count=count)
        scaled = np.repeat([1.0, 0.0], shares.size // 2)
        self.shares = np.where(scaled > 0, shares, 1.0)
        turns = scipy.sparse.diags_array(scaled) @ _columns(own_by, path.shares, rest, count)
        self.turns, width = turns, turns.shape[1]
        diagonal = np.tile(np.arange(n), count), np.arange(shares.size + 1)
        self.scaling = scipy.sparse.csr_array((self.shares, *diagonal), shape=(shares.size, n))
        speeds = v, state.after, path.speeds
        before, after, own = (scipy.sparse.diags_array(np.tile(u, count)) @ turns for u in speeds)
        before = before + _placed(self.scaling, state.y.size, width)
        self.changes = before, after, own + _placed(self.scaling, width - n, width)
        ones = scipy.sparse.vstack([scipy.sparse.eye_array(rest)] * count)
        others = _placed(ones, state.y.size + n, width)
        self.chain = _interleaved([_columns(by, path.shares, rest, count), before, others], count)

    def states(self, state: StepState, path: Path, after: np.ndarray) -> StepState:
        """Arguments of the gaps at the nodes, in columns, with velocities of the speeds ``after``
        only."""
        t, y = state.t + self.fractions * path.h, self._columns(self.y)
        before, own = (self._columns(self.shares) * u[:, None] for u in (state.before, after))
        return StepState(t, y, state.p, before, own, end=0.0)

    def _columns(self, values: np.ndarray) -> np.ndarray:
        return values.reshape(self.fractions.size, -1).T


class _NodeGaps:
    """Gaps at ``_Nodes``: those with speeds times the shares count along the normals, those with
    ones along tangents.

    Attributes
    ----------
    count : number of nodes
    values : GapChanges, of speeds at the start and at the end
    ending : velocities of the path
    slopes : derivatives of ``values``, and of ``ending``
    across : directions
    """

    def __init__(
        self,
        source: SourceSlopes,
        state: StepState,
        path: Path,
        keys: np.ndarray,
        impulses: np.ndarray,
        laws: int,
    ):
        nodes, (n, k) = _Nodes(state, path), impulses.shape
        self.count, self._shape, self._speeds = len(LOBATTO), (n, k), state.before.size
        normal = np.arange(k) == 0
        pressing = np.array([np.where(own, impulses, 0.0) for own in (normal, ~normal)])
        pressing = np.repeat(pressing, self.count, axis=0).reshape(-1, k)
        owner = np.repeat(np.arange(2 * self.count), n)
        first = np.tile(np.arange(n), 2 * self.count)
        own = np.arange(owner.size), np.tile(keys, 2 * self.count), pressing, laws, owner, first
        speeds = state.before, state.after, path.speeds
        parts = [source.at(nodes.states(state, path, u), *own) for u in speeds]
        before, after, self.ending = (part.values.after for part in parts)
        self.values = replace(parts[0].values, before=before, after=after)
        across, matrices = parts[1].directions(), [gap_matrices(part) for part in parts]
        slopes = matrices[1]
        self.slopes = {name: slopes[name] @ nodes.chain for name in ("distance", "laws")}
        for name, change, own_slopes in zip(SPEEDS, nodes.changes, matrices, strict=True):
            self.slopes[name] = own_slopes["after"] @ nodes.chain + across @ change
        self.across = across @ nodes.scaling
        momenta = scipy.sparse.diags_array(nodes.shares) @ (slopes["momentum"] @ nodes.chain)
        pushes = scipy.sparse.diags_array(across.T @ pressing.ravel())
        self._momenta = momenta + pushes @ nodes.turns

    def at(self, node: int, values: Any) -> Any:
        """Values, or rows of a matrix, of one node, with speeds multiplied by the shares."""
        size = values.shape[0] // (2 * self.count)
        return values[node * size : (node + 1) * size]

    def sum_of(self, weights: np.ndarray) -> Sparse:
        """Matrix that sums the rows of the components of all nodes with weights."""
        n, k = self._shape
        own = np.zeros((2, self.count, n, k))
        own[0, ..., 0], own[1, ..., 1:] = weights[:, None], weights[:, None, None]
        row = np.broadcast_to(np.arange(n * k).reshape(n, k), own.shape)
        places = row[own != 0], np.flatnonzero(own)
        return scipy.sparse.csr_array((own[own != 0], places), shape=(n * k, own.size))

    def momentum(self, weights: np.ndarray) -> Sparse:
        """Derivatives of ``Wᵀ P``, summed over the nodes with weights."""
        row = scipy.sparse.csr_array(np.tile(weights, 2)[None])
        return scipy.sparse.kron(row, scipy.sparse.eye_array(self._speeds)) @ self._momenta


def _columns(by: list[Sparse], shares: tuple[float, float], rest: int, count: int) -> Sparse:
    """Derivatives by ``q``, with ``rest`` entries after the speeds, and the speeds of the path from
    those by ``y`` and by ``δ``, which are ``count`` diagonal blocks."""
    by_y, by_delta = (_stacked(blocks, count) for blocks in by)
    none = scipy.sparse.csr_array((by_y.shape[0], rest))
    first, last = (share * by_delta for share in shares)
    return scipy.sparse.hstack([by_y, first, none, last], "csr")


def _stacked(blocks: Sparse, count: int) -> Sparse:
    """Diagonal blocks on top of each other."""
    width = blocks.shape[1] // count
    parts = blocks.data, blocks.indices % width, blocks.indptr
    return scipy.sparse.csr_array(parts, shape=(blocks.shape[0], width))


def _interleaved(parts: list[Sparse], count: int) -> Sparse:
    """Parts that are ``count`` stacked blocks each: the first blocks of all, then the second …"""
    rows = [np.arange(part.shape[0]).reshape(count, -1) for part in parts]
    starts = np.cumsum([0, *(part.shape[0] for part in parts[:-1])])
    order = np.hstack([start + own for start, own in zip(starts, rows, strict=True)])
    return scipy.sparse.vstack(parts, "csr")[order.ravel()]


def _placed(block: Sparse, first: int, width: int) -> Sparse:
    """A block in the columns from ``first`` on."""
    before, after = (
        scipy.sparse.csr_array((block.shape[0], n)) for n in (first, width - first - block.shape[1])
    )
    return scipy.sparse.hstack([before, block, after], "csr")
