"""Triangulated surfaces and lines of the shapes of a scene."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

BAR, PARTICLE, SLIDER, PLATE = 0.012, 0.03, 0.12, 0.01
"""Radius of bars and particles, length of sliders, thickness of plates, relative to the size."""
AROUND, RINGS = 24, 8
"""Corners of circles; rings of a hemisphere."""
Shape = Mapping[str, Any]


@dataclass(frozen=True)
class Surface:
    """A triangulated surface.

    Attributes
    ----------
    vertices : (n, 3)
    triangles : (m, 3) vertices, anticlockwise from outside
    """

    vertices: np.ndarray
    triangles: np.ndarray

    def moved(self, place: Any, axes: np.ndarray | None = None) -> Surface:
        """The surface in other axes (3, 3) at a place."""
        vertices = self.vertices if axes is None else self.vertices @ axes.T
        return Surface(vertices + np.asarray(place, dtype=float), self.triangles)

    @property
    def volume(self) -> float:
        """Enclosed volume; zero for a sheet in a plane through its centre."""
        corners = (self.vertices - self.vertices.mean(axis=0))[self.triangles]
        return float(np.linalg.det(corners).sum() / 6)


def surface_of(shape: Shape, size: float) -> Surface | None:
    """Surface of a shape of a scene; None for a line."""
    build = SURFACES.get(shape["kind"])
    return None if build is None else build(shape, size)


def line_of(shape: Shape) -> np.ndarray | None:
    """(n, 3) points of a line or curve of a scene; None for a solid."""
    if shape["kind"] == "line":
        return np.array([padded(shape["from"]), padded(shape["to"])])
    if shape["kind"] == "curve":
        points = np.array([padded(point) for point in shape["points"]])
        return np.vstack([points, points[:1]]) if shape["closed"] else points
    return None


def padded(point: Any) -> np.ndarray:
    """(3,) a point of the plane or of space."""
    values = np.asarray([float(x) for x in point])
    return np.pad(values, (0, 3 - values.size))


# primitives -----------------------------------------------------------------------------------
def box(size: Any) -> Surface:
    """A box about the origin, with flat sides."""
    x, y, z = np.asarray(size, dtype=float) / 2
    return prism(np.array([[-x, -y], [x, -y], [x, y], [-x, y]]), 2 * z)


def prism(outline: np.ndarray, height: float) -> Surface:
    """A prism over a convex outline (n, 2), anticlockwise, symmetric about the x-y plane."""
    n, half = len(outline), height / 2
    low, high = (np.column_stack([outline, np.full(n, z)]) for z in (-half, half))
    k = np.arange(n)
    after = (k + 1) % n
    fan = np.array([[0, i, i + 1] for i in range(1, n - 1)])
    sides = np.vstack([low, high])
    walls = np.vstack(
        [np.column_stack([k, after, after + n]), np.column_stack([k, after + n, k + n])]
    )
    vertices = np.vstack([sides, low, high])  # caps have own vertices, so that edges are sharp
    triangles = np.vstack([walls, fan[:, ::-1] + 2 * n, fan + 3 * n])
    return Surface(vertices, triangles)


def revolved(profile: np.ndarray) -> Surface:
    """A surface about the z axis from a profile (n, 2) of radii and heights, upwards."""
    angle = 2 * np.pi * np.arange(AROUND) / AROUND
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    levels = [np.column_stack([r * ring, np.full(AROUND, z)]) for r, z in profile]
    triangles = []
    k = np.arange(AROUND)
    after = (k + 1) % AROUND
    for level in range(len(profile) - 1):
        a, b = level * AROUND, (level + 1) * AROUND
        triangles += [np.column_stack([k + a, after + a, after + b])]
        triangles += [np.column_stack([k + a, after + b, k + b])]
    surface = Surface(np.vstack(levels), np.vstack(triangles))
    corners = surface.vertices[surface.triangles]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    return Surface(surface.vertices, surface.triangles[area > 1e-14 * area.max(initial=0.0)])


def sphere(radius: float) -> Surface:
    """A ball about the origin."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, 2 * RINGS + 1)
    return revolved(radius * np.column_stack([np.cos(angle), np.sin(angle)]))


def drum(start: np.ndarray, end: np.ndarray, radius: float, rounded: bool = False) -> Surface:
    """A cylinder between two points, or a capsule."""
    length = float(np.linalg.norm(end - start))
    if rounded:
        angle = np.linspace(0, np.pi / 2, RINGS + 1)
        cap = radius * np.column_stack([np.cos(angle), np.sin(angle)])
        upper = cap + np.array([0.0, length])
        profile = np.vstack([cap[::-1] * [1, -1], upper])
    else:
        r = radius
        profile = np.array([[0, 0], [r, 0], [r, 0], [r, length], [r, length], [0, length]])
    return revolved(profile).moved(start, axes_along(end - start))


def axes_along(direction: np.ndarray) -> np.ndarray:
    """(3, 3) axes whose z axis has a direction."""
    length = float(np.linalg.norm(direction))
    if length == 0:
        return np.eye(3)
    z = direction / length
    across = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(across, z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


# shapes of scenes -----------------------------------------------------------------------------
def _bar(shape: Shape, size: float) -> Surface:
    return drum(padded(shape["from"]), padded(shape["to"]), BAR * size, rounded=True)


def _round(shape: Shape, size: float) -> Surface:
    ends = padded(shape["from"]), padded(shape["to"])
    return drum(*ends, float(shape["radius"]), shape["kind"] == "capsule")


def _particle(shape: Shape, size: float) -> Surface:
    return sphere(PARTICLE * size).moved(padded(shape["center"]))


def _sphere(shape: Shape, size: float) -> Surface:
    return sphere(float(shape["radius"])).moved(padded(shape["center"]))


def _ellipsoid(shape: Shape, size: float) -> Surface:
    unit = sphere(1.0)
    radii = np.asarray([float(x) for x in shape["size"]]) / 2
    axes = Rotation.from_quat(shape["turn"], scalar_first=True).as_matrix()
    return Surface(unit.vertices * radii, unit.triangles).moved(padded(shape["center"]), axes)


def _box(shape: Shape, size: float) -> Surface:
    return box([float(x) for x in shape["size"]]).moved(padded(shape["center"]))


def _disc(shape: Shape, size: float) -> Surface:
    center, axis = padded(shape["center"]), padded(shape["axis"])
    half = axis / np.linalg.norm(axis) * PLATE * size
    return drum(center - half, center + half, float(shape["radius"]))


def _block(shape: Shape, size: float) -> Surface:
    if "axis" in shape:
        length = SLIDER * size
        sides = [0.5 * length, 0.5 * length, length]
        return box(sides).moved(padded(shape["center"]), axes_along(padded(shape["axis"])))
    c, s = np.cos(float(shape["angle"])), np.sin(float(shape["angle"]))
    axes = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    sides = [float(shape["width"]), float(shape["height"]), float(shape["height"])]
    return box(sides).moved(padded(shape["center"]), axes)


def _plate(shape: Shape, size: float) -> Surface:
    """A thin plate over the convex hull of points in one plane."""
    points = np.array([padded(point) for point in shape["points"]])
    center = points.mean(axis=0)
    _, _, directions = np.linalg.svd(points - center)
    axes = directions.T
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    flat = ((points - center) @ axes)[:, :2]
    hull = ConvexHull(flat).vertices
    return prism(flat[hull], PLATE * size).moved(center, axes)


def _mesh(shape: Shape, size: float) -> Surface:
    vertices = np.asarray([float(x) for x in shape["vertices"]]).reshape(-1, 3)
    return Surface(vertices, np.asarray(shape["faces"], dtype=int).reshape(-1, 3))


SURFACES: dict[str, Callable[[Shape, float], Surface]] = {
    "bar": _bar,
    "block": _block,
    "box": _box,
    "capsule": _round,
    "cylinder": _round,
    "disc": _disc,
    "ellipsoid": _ellipsoid,
    "mesh": _mesh,
    "particle": _particle,
    "plate": _plate,
    "polygon": _plate,
    "sphere": _sphere,
}
"""Kind of a shape → function of the shape and the size of the mechanism."""
