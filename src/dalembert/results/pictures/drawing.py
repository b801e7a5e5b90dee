"""The drawing of a mechanism: its bodies, what ties them, and how they move."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.elements.flexible.floating import FloatingFrame
from dalembert.elements.point import Point
from dalembert.results.labelled import LabelledRecording
from dalembert.results.pictures.deformed import pieces, section_poses
from dalembert.results.pictures.sketch import Sketch


class Drawing:
    """Collects what is drawn; how bodies lie and look is said for the plane and for space.

    Parameters
    ----------
    motion : what is drawn
    keep : instants
    loads : applied forces and moments, and stops, are drawn too
    """

    kind: type[Sketch]

    def __init__(self, motion: LabelledRecording, keep: np.ndarray, loads: bool):
        self.model, self.keep, self.data = motion.model, keep, motion.contents
        self.sketch = self.kind(motion, keep, loads)
        self.points: dict[str, list[tuple[float, ...]]] = {n: [] for n in self.sketch.shapes}

    def build(self) -> dict[str, Any]:
        """The scene of a page."""
        sketch = self.sketch
        self.collect_points()
        self.size = sketch.size = self.extent()
        for element in sketch.elements:
            for look in element.look():
                sketch.draw(look, element)
        for body in self.model.bodies:
            if not (body.node or isinstance(body, FloatingFrame)):
                self.outline(body)
        sketch.fill_in()
        gravity = self.model.parts.gravity
        return {
            "gravity": None if gravity is None else sketch.number(gravity.sx).tolist(),
            "bodies": [
                {"name": b.name, "node": b.node, **self.poses(b), "shapes": sketch.shapes[b.name]}
                for b in self.model.bodies
            ]
            + self.deformed(),
            "ground": {"shapes": sketch.shapes["ground"]},
            "joints": sketch.joints,
            "links": sketch.links,
            "symbols": sketch.symbols,
            "points": [
                {"name": p.name, **sketch.place(p)}
                for b in self.model.bodies
                for p in b.points.values()
            ],
        }

    def deformed(self) -> list[dict[str, Any]]:
        """Sections and pieces of flexible bodies, as bodies that belong to them."""
        sketch, found = self.sketch, []
        for section in sketch.sections:
            pose = section_poses(sketch.motion, self.keep, section)
            described = {"name": section.display_name, "of": section.name, **self.pose(*pose)}
            found.append(described | {"shapes": sketch.shapes[section.display_name]})
        for body in self.model.bodies:
            if isinstance(body, FloatingFrame):
                for k, (pose, length) in enumerate(pieces(sketch.motion, self.keep, body)):
                    ends = np.zeros((2, sketch.dimension))
                    ends[1, 0] = length
                    bar = {"kind": "bar", "from": ends[0].tolist(), "to": ends[1].tolist()}
                    described = {"name": f"{body.name}/{k + 1}", "of": body.name}
                    found.append(described | self.pose(*pose) | {"shapes": [bar]})
        return found

    def pose(self, place: np.ndarray, turn: np.ndarray) -> dict[str, list[float]]:
        """Columns of places and turns."""
        raise NotImplementedError

    def poses(self, body: Any) -> dict[str, list[float]]:
        """Columns of a body's pose."""
        raise NotImplementedError

    def outline(self, body: Any) -> None:
        """Draw what a body looks like itself, or what its points suggest."""
        raise NotImplementedError

    def collect_points(self) -> None:
        """Places on each body, named ones first."""
        for body in self.model.bodies:
            for point in body.points.values():
                self.points[point.body.display_name].append(tuple(self.sketch.local(point)))
        for element in self.sketch.elements:
            for point in vars(element).values():
                if isinstance(point, Point):
                    spot = tuple(self.sketch.local(point))
                    if spot not in self.points[point.body.display_name]:
                        self.points[point.body.display_name].append(spot)

    def extent(self) -> float:
        """Size of the mechanism, for symbols without a size of their own."""
        local = [np.linalg.norm(p) for points in self.points.values() for p in points]
        position = self.data["position"][self.keep[:1]]
        position = position.reshape(-1, position.shape[-1])
        spread = np.ptp(position, axis=0).max() if position.size else 0.0
        return float(max([spread, *local])) or 1.0
