"""Shapes of lines: slots with rounded ends, circles of two arcs, rectangles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.io.imports.sketches.drawing import CURVES, Circle, Drawing, Entity, Line, Slot

ROUND = 1e-3
"""Relative deviation of a half circle, a right angle, or of equal sides."""

SAME = 1e-6
"""Relative difference of centres and radii of arcs of one circle, and of axes of an ellipse."""


@dataclass(frozen=True, eq=False)
class Arc:
    """An arc of a circle.

    Attributes
    ----------
    center : (2,)
    radius : in the unit of the drawing
    span : angle [rad]
    kind : of its entity
    data : place, layers and name
    """

    center: np.ndarray
    radius: float
    span: float
    kind: str
    data: dict[str, Any]


def add_circles_of_arcs(drawing: Drawing, arcs: Sequence[Arc]) -> None:
    """Add the circles that arcs form together, as programs write them that know no circles.

    Other arcs are omissions.
    """
    remaining = list(arcs)
    while remaining:
        first, near = remaining[0], SAME * remaining[0].radius
        alike = [
            arc
            for arc in remaining
            if abs(arc.radius - first.radius) <= near
            and np.linalg.norm(arc.center - first.center) <= near
        ]
        remaining = [arc for arc in remaining if not any(arc is other for other in alike)]
        if sum(arc.span for arc in alike) >= 2 * np.pi * (1 - SAME):
            drawing.add(Circle(**first.data, center=first.center, radius=first.radius))
            continue
        for arc in alike:
            drawing.omit(arc.data["place"], arc.kind, CURVES)


def outline(
    corners: np.ndarray,
    closed: bool,
    bulges: np.ndarray | None,
    width: float,
    data: dict[str, Any],
) -> Entity:
    """The slot, circle or line through corners.

    Parameters
    ----------
    corners : (n, 2)
    bulges : (n,) tangent of a quarter of the arc from each corner to the next; 1 for a half circle
    width : of a line drawn as an area, such as a ring
    data : place, layers and name
    """
    if closed and len(corners) > 1 and np.array_equal(corners[0], corners[-1]):
        corners, bulges = corners[:-1], None if bulges is None else bulges[:-1]
    is_half = np.zeros(len(corners), bool) if bulges is None else np.abs(np.abs(bulges) - 1) < ROUND
    if closed and len(corners) == 2 and is_half.all():
        middle, radius = corners.mean(axis=0), float(np.linalg.norm(corners[1] - corners[0])) / 2
        is_filled = width >= (2 - ROUND) * radius
        return Circle(**data, center=middle, radius=radius + width / 2, filled=is_filled)
    if closed and len(corners) == 4 and bulges is not None and list(is_half) in ALTERNATE:
        following = np.roll(corners, -1, axis=0)
        ends = ((corners + following) / 2)[is_half]
        across = float(np.linalg.norm((following - corners)[is_half], axis=1).mean())
        if not bulges[~is_half].any() and bulges[is_half].prod() > 0:
            return Slot(**data, ends=ends, width=across)
    return Line(**data, corners=corners, closed=closed)


ALTERNATE = ([True, False, True, False], [False, True, False, True])


def rectangle(line: Line) -> tuple[np.ndarray, np.ndarray] | None:
    """(2,) middle and (2, 2) vectors from it to a long and a short side; None for another shape."""
    corners = line.corners
    if len(corners) > 1 and np.allclose(corners[0], corners[-1], rtol=0, atol=1e-12):
        corners = corners[:-1]
    elif not line.closed:
        return None
    if len(corners) != 4:
        return None
    a, b = corners[1] - corners[0], corners[2] - corners[1]
    lengths = np.linalg.norm(a), np.linalg.norm(b)
    is_parallelogram = np.linalg.norm(corners[0] - corners[1] + corners[2] - corners[3])
    if min(lengths) == 0 or is_parallelogram > ROUND * max(lengths):
        return None
    if abs(a @ b) > 10 * ROUND * lengths[0] * lengths[1]:
        return None
    sides = np.array([a, b] if lengths[0] >= lengths[1] else [b, a]) / 2
    return corners.mean(axis=0), sides
