"""MechanismScene of a planar mechanism."""

from __future__ import annotations

from functools import singledispatchmethod
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Element, Look
from dalembert.elements.look import Block, Segment
from dalembert.elements.planar.body import Body
from dalembert.results.pictures.mechanism_scene import MechanismScene
from dalembert.results.pictures.primitives import Primitives
from dalembert.results.sources import Track


class PlanarPrimitives(Primitives):
    """Primitives by symbols of engineering drawings."""

    dimension = 2

    # primitives ------------------------------------------------------------------------
    @singledispatchmethod
    def draw(self, look: Look, element: Element) -> None:
        super().draw(look, element)

    @draw.register
    def _(self, look: Block, element: Element) -> None:
        x, y = ca.vertsplit(look.direction)
        width = 0.12 * self.size
        shape: dict[str, Any] = {"kind": "block", "center": self.local(look.point)}
        shape |= {"width": width, "height": 0.6 * width, "angle": self.size_of(ca.atan2(y, x))}
        self.shapes[look.point.body.display_name].append(shape)


class PlanarScene(MechanismScene):
    """MechanismScene by bars and plates."""

    kind = PlanarPrimitives

    def outline(self, body: Body) -> None:
        """Draw the body by its own look, else as a plate over its points."""
        looks, shapes = body.look(), self.primitives.shapes[body.name]
        points = [list(p) for p in self.points[body.name]]
        for look in looks:
            self.primitives.draw(look, body)
            if isinstance(look, Segment):
                points += [self.primitives.local(look.point_i), self.primitives.local(look.point_j)]
        corners = _hull(points) if points else []
        if len(corners) > 2:
            shapes.insert(0, {"kind": "polygon", "points": corners})
        elif not looks and len(corners) == 2:
            shapes.insert(0, {"kind": "bar", "from": corners[0], "to": corners[1]})
        elif not looks and points and not shapes and np.linalg.norm(points) > 1e-9 * self.size:
            shapes.append({"kind": "bar", "from": [0.0, 0.0], "to": points[0]})
            shapes.append({"kind": "particle", "center": [0.0, 0.0]})

    def poses(self, body: Body) -> dict[str, list[float]]:
        recorded = self.primitives.recorded
        return self.pose(*(recorded(q, body=body.name) for q in ("position", "angle")))

    def pose(self, position: Track, rotation: Track) -> dict[str, list[float]]:
        return position.named("xy") | rotation.named(["angle"])


def _hull(points: list[list[float]]) -> list[list[float]]:
    """Corners of the convex hull, anticlockwise; two end points if the points are collinear."""
    ordered = sorted({(x, y) for x, y in points})
    size = max(np.ptp(np.array(ordered), axis=0).max(), 1e-300)

    def chain(path: list) -> list:
        corners: list = []
        for p in path:
            while len(corners) > 1:
                (ax, ay), (bx, by) = corners[-2:]
                if (bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax) > 1e-12 * size**2:
                    break
                corners.pop()
            corners.append(p)
        return corners

    return [list(p) for p in chain(ordered)[:-1] + chain(ordered[::-1])[:-1]]
