"""Corners that leave faces before they would touch them.

The linear part of the gap between a corner and a face closes although the corner is past the end of
the face by then: teeth that move past each other, or the rear corner of a box that slides over an
edge.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

SLACK = 0.25
"""Share of a step by which a corner may come to the end of a face later than to the face [-]."""
LATEST = 3.0
"""Upper limit of the time in which the gap closes, by the step [-]; later impacts do not act."""
ROUNDING = 1e-9
"""Closing of a gap in a step that counts as rest, by the size of the face [-]."""


@dataclass(frozen=True, eq=False)
class CornersOverFaces:
    """n corners, each over its own face with up to e sides, or a planar side with two ends.

    Attributes
    ----------
    height, size : (n,) of the corners, and of the faces [m]
    past : (e, n) distances along the face by which corners are beyond its sides, negative inside
        [m]; −∞ where there are fewer
    convex : (e, n) whether the surface is convex there
    """

    height: np.ndarray
    size: np.ndarray
    past: np.ndarray
    convex: np.ndarray

    @classmethod
    def of_sides(
        cls, place: np.ndarray, side: np.ndarray, radius: np.ndarray, convex: np.ndarray
    ) -> CornersOverFaces:
        """Planar corners with ``place`` (n, 2) from the starts of ``side`` (n, 2)."""
        length = np.hypot(*side.T)
        tangent = side / length[:, None]
        along = (place * tangent).sum(axis=1)
        height = place[:, 0] * tangent[:, 1] - place[:, 1] * tangent[:, 0] - radius
        return cls(height, length, np.array([-along, along - length]), convex)

    @classmethod
    def of_loops(cls, place: np.ndarray, loops: np.ndarray, counts: np.ndarray) -> CornersOverFaces:
        """Corners at ``place`` (n, 3) over faces with corners ``loops`` (n, l, 3) of ``counts``
        (n,)."""
        number = np.arange(loops.shape[1])
        last = number[None] == counts[:, None] - 1
        following = np.where(last[..., None], loops[:, :1], np.roll(loops, -1, axis=1))
        edges = following - loops
        normal = np.cross(edges[:, 0], edges[:, 1])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        outward = np.cross(edges, normal[:, None])
        length = np.linalg.norm(outward, axis=2)
        relative = place[:, None] - loops
        beyond = np.einsum("nlk,nlk->nl", outward, relative) / np.where(length > 0, length, 1.0)
        past = np.where(number < counts[:, None], beyond, -np.inf).T
        height = np.einsum("nk,nk->n", normal, relative[:, 0])
        return cls(height, length.max(axis=1), past, np.ones(past.shape, dtype=bool))


def leaving(start: CornersOverFaces, end: CornersOverFaces) -> np.ndarray:
    """(e, n) mask of the corners that are past convex sides of their faces when their gaps close,
    if they move on as from ``start`` to ``end`` in a step, but for ``SLACK`` of this motion."""
    closing = start.height - end.height
    closes = (start.height > 0) & (closing > ROUNDING * start.size)
    share = np.divide(start.height, closing, out=np.zeros(closing.size), where=closes)
    closes &= share < LATEST
    inside = np.isfinite(start.past)
    past = np.where(inside, start.past, 0.0)
    moved = np.where(inside, end.past, 0.0) - past
    mask: np.ndarray = closes & start.convex & (moved > 0) & (past + (share + SLACK) * moved > 0)
    return mask
