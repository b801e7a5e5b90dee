"""The drawing of a mechanism in the plane."""

from __future__ import annotations

import numpy as np

from dalembert.elements.look import Segment
from dalembert.elements.planar.body import Body
from dalembert.results.pictures.drawing import Drawing
from dalembert.results.pictures.planar_sketch import PlanarSketch


class PlanarDrawing(Drawing):
    """Bars and plates."""

    kind = PlanarSketch

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

    def poses(self, body: Body) -> dict[str, list[float]]:
        place, turn = (self.data.at(q, body=body.name)[self.keep] for q in ("position", "angle"))
        return self.pose(place, turn)

    def pose(self, place: np.ndarray, turn: np.ndarray) -> dict[str, list[float]]:
        return {"x": place[:, 0].tolist(), "y": place[:, 1].tolist(), "angle": turn.tolist()}


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
