"""Means of gaps over the path of a step, and their derivatives.

    u⁺ + u⁻ = W̄ (v⁺ + v) + 2 w̄,     W̄ = Σ β W(y ⊕ s δ) R,     ḡ = g(y ⊕ δ) − W̄ δ − h w̄

as functions of ``q = (y, v, t, p)`` and of the speeds ``v_δ`` at the end of the path ``δ = h (θ
v_δ + (1−θ) v)``; ``R`` are the shares of the displacement per ``s`` in ``δ``, and ones in the rows
along tangents, ``β`` the weights of means.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.mean_gaps import LOBATTO
from dalembert.model.graph.model import Model
from dalembert.sensitivity.nonsmooth.gap_changes import GapChanges
from dalembert.sensitivity.nonsmooth.gap_matrices import NAMES, MatrixGaps, gap_matrices
from dalembert.sensitivity.nonsmooth.slope_function import SlopeFunction, Sparse
from dalembert.sensitivity.nonsmooth.source_slopes import SourceSlopes, StepState
from dalembert.symbolic.once import once


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
    points = [_point(source, state, path, s, (rows, keys, impulses, laws)) for s in LOBATTO]
    weights, (first_share, share) = list(LOBATTO.values()), path.shares

    def mean(values: list[Any]) -> Any:
        return sum(weight * value for weight, value in zip(weights, values, strict=True))

    slopes = {name: mean([p.slopes[name] for p in points]) for name in points[0].slopes}
    before, after, ending = (
        mean([getattr(p, name) for p in points]) for name in ("before", "after", "ending")
    )
    first, last = points[0], points[-1]
    distance = last.distance - (first_share * before + share * ending)[:, 0]
    changes = first_share * slopes["before"] + share * slopes["ending"]
    slopes["distance"] = last.slopes["distance"] - changes[:: impulses.shape[1]]
    slopes["laws"] = first.slopes["laws"]
    if path.theta == 0.5:
        turns = np.where(kept[:, None], 0.0, before - first.before)
        before, after = before - turns, after + state.end * turns
        own = scipy.sparse.diags_array(np.repeat(~kept, turns.shape[1]).astype(float))
        change = own @ (slopes["before"] - first.slopes["before"])
        slopes["before"] = slopes["before"] - change
        slopes["after"] = slopes["after"] + state.end * change
    matrices = {name: scipy.sparse.csr_array(slopes[name]) for name in NAMES}
    momentum, across = (scipy.sparse.csr_array(slopes[name]) for name in ("momentum", "across"))
    values = GapChanges(distance, before, after, first.laws)
    count = momentum.shape[1] - path.speeds.size
    return MatrixGaps(rows, values, across, matrices, momentum, count)


@dataclass(frozen=True, eq=False)
class _Point:
    """Gaps at one point of a path, with speeds multiplied by the shares there along the normals.

    Attributes
    ----------
    distance, laws : of the gaps
    before, after, ending : velocities for the speeds at the start, at the end, and of the path
    slopes : derivatives by ``q`` and the speeds of the path, and the directions ``across``
    """

    distance: np.ndarray
    laws: np.ndarray
    before: np.ndarray
    after: np.ndarray
    ending: np.ndarray
    slopes: dict[str, Sparse]


def _point(source: SourceSlopes, state: StepState, path: Path, s: float, own: Any) -> _Point:
    """Gaps at ``y ⊕ s δ``; ``own`` are the last arguments of ``SourceSlopes.at``.

    The shares multiply the rows along the normals only.
    """
    rows, keys, impulses, laws = own
    normal = np.zeros(impulses.shape, dtype=bool)
    normal[:, 0] = True
    parts = [
        _part(source, state, path, s, (rows, keys, np.where(own_rows, impulses, 0.0), laws), scaled)
        for own_rows, scaled in ((normal, True), (~normal, False))
    ]
    along, across = parts
    select = [scipy.sparse.diags_array(part.ravel().astype(float)) for part in (normal, ~normal)]
    slopes = {
        name: select[0] @ along.slopes[name] + select[1] @ across.slopes[name]
        for name in ("before", "after", "ending", "across")
    }
    slopes["momentum"] = along.slopes["momentum"] + across.slopes["momentum"]
    slopes["distance"], slopes["laws"] = along.slopes["distance"], along.slopes["laws"]
    before, after, ending = (
        np.where(normal, getattr(along, name), getattr(across, name))
        for name in ("before", "after", "ending")
    )
    return _Point(along.distance, along.laws, before, after, ending, slopes)


def _part(
    source: SourceSlopes, state: StepState, path: Path, s: float, own: Any, scaled: bool
) -> _Point:
    """Gaps at ``y ⊕ s δ`` with the shares ``R``, or with ones in their place."""
    h, v = path.h, state.before
    part, share = path.shares
    delta = part * v + share * path.speeds
    y, (y_by_y, y_by_delta) = path.points.position(state.y, delta, s)
    shares, (by_y, by_delta) = path.points.shares(state.y, delta, s)
    if not scaled:
        shares, by_y, by_delta = np.ones_like(shares), 0 * by_y, 0 * by_delta
    (n_y, n), rest = (y.size, v.size), 1 + state.p.size
    turns = _columns(by_y, by_delta, path.shares, rest)
    width = turns.shape[1]
    scaling = scipy.sparse.diags_array(shares)
    start, ending = (_placed(scaling, place, width) for place in (n_y, width - n))
    moved = [scipy.sparse.diags_array(u) @ turns for u in (v, state.after, path.speeds)]
    others = _placed(scipy.sparse.eye_array(rest), n_y + n, width)
    inner = [_columns(y_by_y, y_by_delta, path.shares, rest), moved[0] + start, others]
    chain = scipy.sparse.csr_array(scipy.sparse.vstack(inner))
    gaps, at_end = (
        source.at(StepState(state.t + s * h, y, state.p, shares * v, shares * u), *own)
        for u in (state.after, path.speeds)
    )
    across, slopes = gaps.directions(), gap_matrices(gaps)
    push = scipy.sparse.diags_array(across.T @ own[2].ravel())
    chained = {
        "distance": slopes["distance"] @ chain,
        "before": slopes["before"] @ chain,
        "after": slopes["after"] @ chain + across @ moved[1],
        "ending": gap_matrices(at_end)["after"] @ chain + across @ (moved[2] + ending),
        "laws": slopes["laws"] @ chain,
        "momentum": scaling @ (slopes["momentum"] @ chain) + push @ turns,
        "across": across @ scaling,
    }
    values = gaps.values
    speeds = values.before, values.after, at_end.values.after
    return _Point(values.distance, values.laws, *speeds, chained)


def _columns(by_y: Sparse, by_delta: Sparse, shares: tuple[float, float], rest: int) -> Sparse:
    """Derivatives by ``q`` and the speeds of the path from those by ``y`` and by ``δ``."""
    none = scipy.sparse.csr_array((by_y.shape[0], rest))
    first, last = (share * by_delta for share in shares)
    return scipy.sparse.csr_array(scipy.sparse.hstack([by_y, first, none, last]))


def _placed(block: Sparse, first: int, width: int) -> Sparse:
    """A block in the columns from ``first`` on."""
    before, after = (
        scipy.sparse.csr_array((block.shape[0], n)) for n in (first, width - first - block.shape[1])
    )
    return scipy.sparse.csr_array(scipy.sparse.hstack([before, block, after]))
