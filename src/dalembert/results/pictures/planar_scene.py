"""Scene of a planar mechanism."""

from __future__ import annotations

from functools import singledispatchmethod
from typing import Any

import numpy as np

from dalembert.elements.base import Look
from dalembert.elements.look import Belt, Block, Disc, Limit, Mark, Mesh, Rotary, Segment, Travel
from dalembert.elements.planar.body import Body
from dalembert.elements.point import Point
from dalembert.results.pictures.mechanism_scene import MechanismScene
from dalembert.results.pictures.primitives import Primitives, body_names, moving_body, symbol_header


class PlanarPrimitives(Primitives):
    """Primitives as symbols of engineering drawings."""

    dimension = 2

    # primitives ------------------------------------------------------------------------
    @singledispatchmethod
    def draw(self, look: Look, element: Any) -> None:
        super().draw(look, element)

    @draw.register
    def _(self, look: Disc, element: Any) -> None:
        shape = {"center": self.local(look.point), "radius": self.size_of(look.radius)}
        self.shapes[look.point.body.display_name].append({"kind": "disc", **shape})

    @draw.register
    def _(self, look: Block, element: Any) -> None:
        x, y = self.number(look.direction)
        width = 0.12 * self.size
        shape: dict[str, Any] = {"kind": "block", "center": self.local(look.point)}
        shape |= {"width": width, "height": 0.6 * width, "angle": float(np.arctan2(y, x))}
        self.shapes[look.point.body.display_name].append(shape)

    @draw.register
    def _(self, look: Mark, element: Any) -> None:
        point, base = look.point, look.base
        bodies = body_names(point, base)
        if bodies[0] == "ground" and isinstance(base, Point):
            point = base
        symbol = (
            symbol_header(look, element) | self.point_data(point) | {"grounded": "ground" in bodies}
        )
        self.joints.append(symbol | {"on": moving_body(bodies)} | self.reaction(element))

    @draw.register
    def _(self, look: Mesh, element: Any) -> None:
        symbol = symbol_header(look, element) | self.point_data(look.point) | self.reaction(element)
        symbol["mesh"] = [
            self.point_data(p) | {"radius": self.size_of(r)}
            for p, r in ((look.point, look.radius), (look.base, look.base_radius))
            if isinstance(p, Point)
        ]
        self.joints.append(symbol | {"grounded": False, "internal": look.internal})

    @draw.register
    def _(self, look: Rotary, element: Any) -> None:
        pivot = self.pivots.between(look.body_i, look.body_j)
        ends = [b.name if b is not None else "ground" for b in (look.body_i, look.body_j)]
        symbol = (
            symbol_header(look, element)
            | self.point_data(pivot)
            | dict(zip("ij", ends, strict=True))
        )
        self.symbols.append(symbol)

    @draw.register
    def _(self, look: Belt, element: Any) -> None:
        wheels, crossed = self.wheels(look)
        symbol = symbol_header(look, element) | {"wheels": wheels, "crossed": crossed}
        self.joints.append(symbol | wheels[1] | {"grounded": False} | self.reaction(element))

    @draw.register
    def _(self, look: Travel, element: Any) -> None:
        on = look.body.name if look.body is not None else "ground"
        symbol = symbol_header(look, element) | self.point_data(look.point)
        self.symbols.append(symbol | {"on": on, "axis": self.number(look.direction).tolist()})

    @draw.register
    def _(self, look: Limit, element: Any) -> None:
        blocks = [(name, s) for name, shapes in self.shapes.items() for s in shapes]
        reach = {name: s["width"] / 2 for name, s in blocks if s["kind"] == "block"}
        wall = self.pivots.wall(look, self.model.bodies, reach)
        if wall is not None and self.loads:
            self.symbols.append(symbol_header(look, element))
            self.time_dependent.append(
                (self.symbols[-1], ("at_x", "at_y", "normal_x", "normal_y"), wall)
            )


class PlanarScene(MechanismScene):
    """Scene of bars and plates."""

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
        position, angle = (
            self.data.at(q, body=body.name)[self.keep] for q in ("position", "angle")
        )
        return self.pose(position, angle)

    def pose(self, position: np.ndarray, angle: np.ndarray) -> dict[str, list[float]]:
        return {"x": position[:, 0].tolist(), "y": position[:, 1].tolist(), "angle": angle.tolist()}


def _hull(points: list[list[float]]) -> list[list[float]]:
    """Corners of the convex hull, anticlockwise; two end points if the points are collinear."""
    ordered = sorted({(float(x), float(y)) for x, y in points})
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
