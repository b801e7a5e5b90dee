"""Primitives as they stand in space.

What has an axis shows the z axis of its frame; a point of a planar body, that of the plane. Other
points have none.
"""

from __future__ import annotations

from functools import singledispatchmethod
from typing import Any

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.frame import Frame
from dalembert.elements.look import Belt, Block, Disc, Limit, Mark, Mesh, Rotary, Travel
from dalembert.elements.point import Point
from dalembert.elements.spatial.shape import Cuboid, Drum, Orb, Pill, Round, Surface
from dalembert.results.pictures.sketch import Place, Sketch, ends_of, held, named

ROUND = {Drum: "cylinder", Pill: "capsule"}


class SpatialSketch(Sketch):
    """Solids and symbols about axes."""

    dimension = 3

    def seat(self, point: Point) -> Place:
        """A point, with its axis if it has one."""
        axis = None if point.body.dimension == 3 else [0.0, 0.0, 1.0]
        if isinstance(point, Frame):
            axis = self.number(point.local_axes[:, 2]).tolist()
        return self.place(point) | {"axis": axis}

    # primitives ------------------------------------------------------------------------
    @singledispatchmethod
    def draw(self, look: Look, element: Any) -> None:
        super().draw(look, element)

    @draw.register
    def _(self, look: Cuboid, element: Any) -> None:
        shape = {"center": self.local(look.center), "size": self.number(look.size).tolist()}
        self.shapes[look.center.body.display_name].append({"kind": "box", **shape})

    @draw.register
    def _(self, look: Orb, element: Any) -> None:
        shape = {"center": self.local(look.center), "radius": self.size_of(look.radius)}
        self.shapes[look.center.body.display_name].append({"kind": "sphere", **shape})

    @draw.register(Drum)
    @draw.register(Pill)
    def _(self, look: Round, element: Any) -> None:
        shape: dict[str, Any] = {"from": self.local(look.point_i), "to": self.local(look.point_j)}
        shape |= {"kind": ROUND[type(look)], "radius": self.size_of(look.radius)}
        self.shapes[look.point_i.body.display_name].append(shape)

    @draw.register
    def _(self, look: Surface, element: Any) -> None:
        corners = self.size_of(look.scale) * look.corners
        shape = {"vertices": corners.ravel().tolist(), "faces": look.triangles.ravel().tolist()}
        self.shapes[look.body.display_name].append({"kind": "mesh", **shape})

    @draw.register
    def _(self, look: Disc, element: Any) -> None:
        seat = self.seat(look.point)
        shape = {"center": seat["point"], "axis": seat["axis"] or [0.0, 0.0, 1.0]}
        shape["radius"] = self.size_of(look.radius)
        self.shapes[look.point.body.display_name].append({"kind": "disc", **shape})

    @draw.register
    def _(self, look: Block, element: Any) -> None:
        axis = self.number(self.widened(look.direction)).tolist()
        shape = {"kind": "block", "center": self.local(look.point), "axis": axis}
        self.shapes[look.point.body.display_name].append(shape)

    @draw.register
    def _(self, look: Mark, element: Any) -> None:
        point, base = look.point, look.base
        bodies = ends_of(point, base)
        described = named(look, element) | self.seat(point) | {"grounded": "ground" in bodies}
        described["on"] = held(bodies)
        if isinstance(base, Point):
            described["base"] = self.seat(base)
        if bodies[0] == "ground" and isinstance(base, Point):
            described |= self.seat(base) | {"base": self.seat(point)}
        self.joints.append(described | self.reaction(element))

    @draw.register
    def _(self, look: Mesh, element: Any) -> None:
        described = named(look, element) | self.seat(look.point) | {"grounded": False}
        described["mesh"] = [
            self.seat(p) | {"radius": self.size_of(r)}
            for p, r in ((look.point, look.radius), (look.base, look.base_radius))
            if isinstance(p, Point)
        ]
        self.joints.append(described | {"internal": look.internal} | self.reaction(element))

    @draw.register
    def _(self, look: Rotary, element: Any) -> None:
        pivot = self.pivots.between(look.body_i, look.body_j)
        self.symbols.append(named(look, element) | self.seat(pivot))

    @draw.register
    def _(self, look: Belt, element: Any) -> None:
        wheels, crossed = self.wheels(look)
        described = named(look, element) | {"wheels": wheels, "crossed": crossed}
        self.joints.append(described | wheels[1] | {"grounded": False} | self.reaction(element))

    @draw.register
    def _(self, look: Travel, element: Any) -> None:
        on = look.body.name if look.body is not None else "ground"
        axis = self.number(self.widened(look.direction)).tolist()
        described = named(look, element) | self.place(look.point)
        self.symbols.append(described | {"on": on, "axis": axis})

    @draw.register
    def _(self, look: Limit, element: Any) -> None:
        """A wall across a straight way; where a body turns, a mark on its axis."""
        moving = [b for b in self.model.bodies if ca.jacobian(look.coordinate, b.pose).nnz()]
        if not (moving and self.loads):
            return
        found = self.pivots.wall(look, self.model.bodies, {})
        pivot = self.pivots.between(moving[0] if len(moving) > 1 else None, moving[-1])
        described = named(look, element) | (
            self.seat(pivot) if found is None else {"body": "ground", "point": [0.0, 0.0, 0.0]}
        )
        self.symbols.append(described)
        if found is not None:
            parts = [self.widened(part) for part in ca.vertsplit(found, found.numel() // 2)]
            for name, part in zip(("at", "normal"), parts, strict=True):
                self.later.append((described, self.components(name, part), part))

    def moment(self, sx: ca.SX) -> ca.SX:
        return sx if sx.numel() == 3 else ca.vertcat(0, 0, sx)
