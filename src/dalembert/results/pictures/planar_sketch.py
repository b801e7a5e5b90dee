"""Primitives as they are seen in the plane, along the third axis."""

from __future__ import annotations

from functools import singledispatchmethod
from typing import Any

import numpy as np

from dalembert.elements.base import Look
from dalembert.elements.look import Belt, Block, Disc, Limit, Mark, Mesh, Rotary, Travel
from dalembert.elements.point import Point
from dalembert.results.pictures.sketch import Sketch, ends_of, held, named


class PlanarSketch(Sketch):
    """Symbols of engineering drawings."""

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
        wide = 0.12 * self.size
        shape: dict[str, Any] = {"kind": "block", "center": self.local(look.point)}
        shape |= {"width": wide, "height": 0.6 * wide, "angle": float(np.arctan2(y, x))}
        self.shapes[look.point.body.display_name].append(shape)

    @draw.register
    def _(self, look: Mark, element: Any) -> None:
        point, base = look.point, look.base
        bodies = ends_of(point, base)
        if bodies[0] == "ground" and isinstance(base, Point):
            point = base
        described = named(look, element) | self.place(point) | {"grounded": "ground" in bodies}
        self.joints.append(described | {"on": held(bodies)} | self.reaction(element))

    @draw.register
    def _(self, look: Mesh, element: Any) -> None:
        described = named(look, element) | self.place(look.point) | self.reaction(element)
        described["mesh"] = [
            self.place(p) | {"radius": self.size_of(r)}
            for p, r in ((look.point, look.radius), (look.base, look.base_radius))
            if isinstance(p, Point)
        ]
        self.joints.append(described | {"grounded": False, "internal": look.internal})

    @draw.register
    def _(self, look: Rotary, element: Any) -> None:
        pivot = self.pivots.between(look.body_i, look.body_j)
        ends = [b.name if b is not None else "ground" for b in (look.body_i, look.body_j)]
        described = named(look, element) | self.place(pivot) | dict(zip("ij", ends, strict=True))
        self.symbols.append(described)

    @draw.register
    def _(self, look: Belt, element: Any) -> None:
        wheels, crossed = self.wheels(look)
        described = named(look, element) | {"wheels": wheels, "crossed": crossed}
        self.symbols.append(described)
        self.joints.append(described | wheels[1] | {"grounded": False} | self.reaction(element))

    @draw.register
    def _(self, look: Travel, element: Any) -> None:
        on = look.body.name if look.body is not None else "ground"
        described = named(look, element) | self.place(look.point)
        self.symbols.append(described | {"on": on, "axis": self.number(look.direction).tolist()})

    @draw.register
    def _(self, look: Limit, element: Any) -> None:
        blocks = [(name, s) for name, shapes in self.shapes.items() for s in shapes]
        reach = {name: s["width"] / 2 for name, s in blocks if s["kind"] == "block"}
        found = self.pivots.wall(look, self.model.bodies, reach)
        if found is not None and self.loads:
            self.symbols.append(named(look, element))
            self.later.append((self.symbols[-1], ("x", "y", "normal_x", "normal_y"), found))
