"""The drawing of a mechanism in the plane: its bodies, what ties them, and how they move."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.elements.look import Segment
from dalembert.elements.planar.body import Body
from dalembert.elements.point import Point
from dalembert.results.labelled import LabelledRecording
from dalembert.results.sketch import Sketch


def motion_scene(
    motion: LabelledRecording, keep: np.ndarray, *, loads: bool = True
) -> dict[str, Any]:
    """Drawing and poses at the instants ``keep``.

    Parameters
    ----------
    loads : applied forces and moments, and stops, are drawn too
    """
    return _Scene(motion, keep, loads).build()


class _Scene:
    def __init__(self, motion: LabelledRecording, keep: np.ndarray, loads: bool):
        self.model, self.keep, self.data = motion.model, keep, motion.data
        self.sketch = Sketch(motion, keep, loads)
        self.points: dict[str, list[tuple[float, ...]]] = {n: [] for n in self.sketch.shapes}

    def build(self) -> dict[str, Any]:
        sketch = self.sketch
        self.collect_points()
        self.size = sketch.size = self.extent()
        for element in sketch.elements:
            for look in element.look():
                sketch.draw(look, element)
        for body in self.model.bodies:
            self.outline(body)
        sketch.fill_in()
        gravity = self.model.parts.gravity
        return {
            "gravity": None if gravity is None else sketch.number(gravity.sx).tolist(),
            "bodies": [self.body(b) for b in self.model.bodies],
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

    def collect_points(self) -> None:
        for body in self.model.bodies:
            self.points[body.name] = [tuple(self.sketch.local(p)) for p in body.points.values()]
        for element in self.sketch.elements:
            for point in vars(element).values():
                if isinstance(point, Point):
                    spot = tuple(self.sketch.local(point))
                    if spot not in self.points[point.body.name]:
                        self.points[point.body.name].append(spot)

    def extent(self) -> float:
        """Size of the mechanism, for symbols without a size of their own."""
        local = [np.linalg.norm(p) for points in self.points.values() for p in points]
        position = self.data["position"].values[self.keep[:1]].reshape(-1, 2)
        spread = np.ptp(position, axis=0).max() if position.size else 0.0
        return float(max([spread, *local])) or 1.0

    def outline(self, body: Body) -> None:
        """What the body looks like itself; else a plate over its points."""
        looks, shapes = body.look(), self.sketch.shapes[body.name]
        points = [list(p) for p in self.points[body.name]]
        for look in looks:
            self.sketch.draw(look, body)
            if isinstance(look, Segment):
                points += [self.sketch.local(look.point_i), self.sketch.local(look.point_j)]
        corners = _hull(points) if points else []
        if len(corners) > 2:
            shapes.insert(0, {"kind": "polygon", "points": corners})
        elif not looks and len(corners) == 2:
            shapes.insert(0, {"kind": "bar", "from": corners[0], "to": corners[1]})
        elif not looks and points and not shapes and np.linalg.norm(points) > 1e-9 * self.size:
            shapes.append({"kind": "bar", "from": [0.0, 0.0], "to": points[0]})
            shapes.append({"kind": "particle", "center": [0.0, 0.0]})

    def body(self, body: Body) -> dict:
        at = self.data.sel(body=body.name)
        return {
            "name": body.name,
            "x": at["position"].values[self.keep, 0].tolist(),
            "y": at["position"].values[self.keep, 1].tolist(),
            "angle": at["angle"].values[self.keep].tolist(),
            "shapes": self.sketch.shapes[body.name],
        }


def _hull(points: list[list[float]]) -> list[list[float]]:
    """Corners of the convex hull, anticlockwise; only the two ends of points in a line."""
    ordered = sorted({(float(x), float(y)) for x, y in points})
    size = max(np.ptp(np.array(ordered), axis=0).max(), 1e-300)

    def chain(path: list) -> list:
        kept: list = []
        for p in path:
            while len(kept) > 1:
                (ax, ay), (bx, by) = kept[-2:]
                if (bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax) > 1e-12 * size**2:
                    break
                kept.pop()
            kept.append(p)
        return kept

    return [list(p) for p in chain(ordered)[:-1] + chain(ordered[::-1])[:-1]]
