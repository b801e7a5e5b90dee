"""The drawing of a mechanism in space."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.elements.point import AXES
from dalembert.elements.spatial.body import Body
from dalembert.elements.spatial.inertia_tensor import tensor
from dalembert.results.pictures.drawing import Drawing
from dalembert.results.pictures.spatial_sketch import SpatialSketch
from dalembert.symbolic.rotation import EULER_PARAMETERS

LEAST = 0.02
"""Least thickness of the ellipsoid of a body, relative to its length."""
MOST = 0.2
"""Largest radius of it, relative to the mechanism's length; larger ones are drawn smaller."""
BULKY = 0.4
"""Thickness of that ellipsoid, relative to a bar, from which on it is drawn beside the bar."""


class SpatialDrawing(Drawing):
    """Solids, or rods and ellipsoids in their place."""

    kind = SpatialSketch

    def poses(self, body: Any) -> dict[str, list[float]]:
        def at(quantity: str) -> np.ndarray:
            return self.data.at(quantity, body=body.name)[self.keep]

        place, turn = at("position"), np.full((len(self.keep), 4), np.nan)
        if "euler_parameters" in self.data:
            turn = at("euler_parameters")
        if not body.rotates:
            turn = np.tile([1.0, 0.0, 0.0, 0.0], (len(self.keep), 1))
        elif body.dimension == 2:
            half = at("angle") / 2
            turn = np.stack([np.cos(half), 0 * half, 0 * half, np.sin(half)], axis=1)
        return self.pose(place, turn)

    def pose(self, place: np.ndarray, turn: np.ndarray) -> dict[str, list[float]]:
        if place.shape[1] == 2:  # of what moves in a plane
            half, still = turn / 2, np.zeros(len(turn))
            place = np.column_stack([place, still])
            turn = np.column_stack([np.cos(half), still, still, np.sin(half)])
        columns = [*place.T, *turn.T]
        return dict(zip((*AXES, *EULER_PARAMETERS), (c.tolist() for c in columns), strict=True))

    def outline(self, body: Any) -> None:
        """What the body looks like itself; else what its points and its inertia suggest."""
        looks, shapes = body.look(), self.sketch.shapes[body.name]
        for look in looks:
            self.sketch.draw(look, body)
        if looks:
            return
        bare = not shapes
        center, points = self.center(body), [np.array(p) for p in self.points[body.name]]
        apart = [p for p in points if np.linalg.norm(p - center) > 1e-6 * self.size]
        if len(points) > 2 and self.flat(points):
            shapes.append({"kind": "plate", "points": [p.tolist() for p in points]})
        elif len(points) > 1 and self.flat([*points, center], 1):
            first, last = _ends(points)
            shapes.append({"kind": "bar", "from": first.tolist(), "to": last.tolist()})
            lump = self.lump(body, center)
            bulk = sorted(lump.get("size", [0.0, 0.0]))[-2]
            if bare and bulk > BULKY * np.linalg.norm(last - first):
                shapes.append(lump)
        else:
            for p in apart:
                shapes.append({"kind": "bar", "from": center.tolist(), "to": p.tolist()})
            if bare:
                shapes.append(self.lump(body, center))

    def center(self, body: Any) -> np.ndarray:
        """The mass centre in the body frame."""
        return self.sketch.number(body.center_of_mass.sx) if isinstance(body, Body) else np.zeros(3)

    def flat(self, points: list[np.ndarray], dimension: int = 2) -> bool:
        """They lie in a plane, or on a line, and in nothing of fewer dimensions."""
        spread = np.linalg.svd(np.array(points) - np.mean(points, axis=0), compute_uv=False)
        rank = int((spread > 1e-6 * self.size).sum())
        return rank == dimension

    def lump(self, body: Any, center: np.ndarray) -> dict[str, Any]:
        """A body's mass as the solid ellipsoid of the same inertia; a ball where there is none."""
        mass = self.sketch.size_of(body.mass.sx)
        if not (isinstance(body, Body) and body.rotates and mass > 0):
            return {"kind": "particle", "center": center.tolist()}
        moments, axes = np.linalg.eigh(self.sketch.number(tensor(body.inertia.sx)).reshape(3, 3))
        squares = 2.5 * (moments.sum() - 2 * moments) / mass
        radii = np.sqrt(np.maximum(squares, (LEAST * self.size) ** 2))
        radii *= min(1.0, MOST * self.size / radii.max())
        if np.linalg.det(axes) < 0:
            axes[:, 0] *= -1
        from scipy.spatial.transform import Rotation

        turn = Rotation.from_matrix(axes).as_quat(scalar_first=True)
        shape = {"kind": "ellipsoid", "center": center.tolist(), "size": (2 * radii).tolist()}
        return shape | {"turn": turn.tolist()}


def _ends(points: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """The two ends of points in a line."""
    along = [float((p - points[0]) @ (points[1] - points[0])) for p in points]
    return points[int(np.argmin(along))], points[int(np.argmax(along))]
