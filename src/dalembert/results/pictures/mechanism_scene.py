"""MechanismScene of a mechanism: bodies, flexible bodies, connections and poses."""

from __future__ import annotations

import itertools
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.flexible.floating import FloatingFrame
from dalembert.elements.look import Bars, Beams, Coils
from dalembert.elements.point import Point
from dalembert.results.labelled import LabelledRecording
from dalembert.results.pictures.primitives import Primitives
from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.symbolic.formulas.expression import Expression


class MechanismScene:
    """Scene of a mechanism; subclasses define poses and outlines in the plane and in space.

    Parameters
    ----------
    motion : motion that is drawn
    keep : instants
    loads : whether applied forces, moments and stops are drawn
    """

    kind: type[Primitives]

    def __init__(self, motion: LabelledRecording, keep: np.ndarray, loads: bool):
        self.model, self.keep, self.data = motion.model, keep, motion.contents
        self.primitives = self.kind(motion, keep, loads)
        self.points: dict[str, list[tuple[float, ...]]] = {n: [] for n in self.primitives.shapes}

    def build(self) -> dict[str, Any]:
        """The scene of a page."""
        primitives = self.primitives
        self.collect_points()
        self.size = primitives.size = self.extent()
        for element in primitives.elements:
            for look in element.look():
                primitives.draw(look, element)
        for body in self.model.bodies:
            if not (body.node or isinstance(body, FloatingFrame)):
                self.outline(body)
        primitives.fill_in()
        gravity = self.model.parts.gravity
        return {
            "gravity": None if gravity is None else primitives.number(gravity.sx).tolist(),
            "bodies": [
                {
                    "name": b.name,
                    "node": b.node,
                    **self.poses(b),
                    "shapes": primitives.shapes[b.name],
                }
                for b in self.model.bodies
            ]
            + self.deformed(),
            "ground": {"shapes": primitives.shapes["ground"]},
            "joints": primitives.joints,
            "links": primitives.links,
            "symbols": primitives.symbols,
            "points": [
                {"name": p.name, **primitives.point_data(p)}
                for b in self.model.bodies
                for p in b.points.values()
            ],
        }

    def deformed(self) -> list[dict[str, Any]]:
        """Sections and segments of flexible bodies, as bodies of the scene."""
        primitives, bodies = self.primitives, []
        for section in primitives.sections:
            pose = section_poses(primitives.motion, self.keep, section)
            header = {"name": section.display_name, "of": section.name, **self.pose(*pose)}
            bodies.append(header | {"shapes": primitives.shapes[section.display_name]})
        for body in self.model.bodies:
            if isinstance(body, FloatingFrame):
                for k, (pose, length) in enumerate(
                    segment_poses(primitives.motion, self.keep, body)
                ):
                    ends = np.zeros((2, primitives.dimension))
                    ends[1, 0] = length
                    bar = {"kind": "bar", "from": ends[0].tolist(), "to": ends[1].tolist()}
                    header = {"name": f"{body.name}/{k + 1}", "of": body.name}
                    bodies.append(header | self.pose(*pose) | {"shapes": [bar]})
        return bodies

    def pose(self, position: np.ndarray, angle: np.ndarray) -> dict[str, list[float]]:
        """Columns of positions and rotations."""
        raise NotImplementedError

    def poses(self, body: Any) -> dict[str, list[float]]:
        """Columns of a body's pose."""
        raise NotImplementedError

    def outline(self, body: Any) -> None:
        """Draw a body by its own look or by its points."""
        raise NotImplementedError

    def collect_points(self) -> None:
        """Collect the points of each body, named ones first."""
        for body in self.model.bodies:
            for point in body.points.values():
                self.points[point.body.display_name].append(tuple(self.primitives.local(point)))
        for element in self.primitives.elements:
            for point in vars(element).values():
                if isinstance(point, Point):
                    coordinates = tuple(self.primitives.local(point))
                    if coordinates not in self.points[point.body.display_name]:
                        self.points[point.body.display_name].append(coordinates)

    def extent(self) -> float:
        """Size of the mechanism, for symbols of relative size."""
        local = [np.linalg.norm(p) for points in self.points.values() for p in points]
        position = self.data["position"][self.keep[:1]]
        position = position.reshape(-1, position.shape[-1])
        spread = np.ptp(position, axis=0).max() if position.size else 0.0
        return float(max([spread, *local])) or 1.0


MAX_PIECES = 12
"""Upper limit of the segments between two corners."""
Pose = tuple[np.ndarray, np.ndarray]
"""(K, d) positions and (K,) angles, or (K, 4) Euler parameters."""


def section_poses(motion: LabelledRecording, keep: np.ndarray, section: Any) -> Pose:
    """Poses of a section."""
    rotation = section.pose_angle if section.dimension == 2 else section.orientation
    position, rotations = motion.columns([Expression(section.place), Expression(rotation)])
    return position[keep], rotations[keep]


def segment_poses(
    motion: LabelledRecording, keep: np.ndarray, body: FloatingFrame
) -> list[tuple[Pose, float]]:
    """Poses of the segments, with x along the segment, and their lengths."""
    shapes, d = motion.model.shapes(body, motion.parameters), body.dimension
    drawing = StructuralDrawing(shapes.structure, shapes.p)
    edges = _edges(drawing)
    axes = np.stack(
        [motion.values(Expression(body.turned(ca.SX(e))))[keep] for e in np.eye(d)], axis=2
    )
    origin, amplitudes = motion.columns(
        [Expression(body.locate(ca.SX.zeros(d))), Expression(body.amplitudes)]
    )
    amplitudes = amplitudes[keep].reshape(len(keep), -1)
    table = shapes.structure.degrees.table[:, :d]
    poses = []
    for i, j in edges:
        ends = []
        for node in (i, j):
            local = drawing.rest[node, :d] - shapes.origin
            local = local + amplitudes @ shapes.displacements[table[node]].T
            ends.append(origin[keep] + np.einsum("kij,kj->ki", axes, local))
        length = float(np.linalg.norm(drawing.rest[j] - drawing.rest[i]))
        poses.append(((ends[0], _axis_rotation(ends[1] - ends[0])), length))
    return poses


def _axis_rotation(direction: np.ndarray) -> np.ndarray:
    """Angles (K,), or Euler parameters (K, 4), that rotate the x axis into a direction."""
    if direction.shape[1] == 2:
        return np.unwrap(np.arctan2(direction[:, 1], direction[:, 0]))
    unit = direction / np.linalg.norm(direction, axis=1, keepdims=True)
    half = np.column_stack([1 + unit[:, 0], 0 * unit[:, 0], -unit[:, 2], unit[:, 1]])
    backwards = half[:, 0] < 1e-12
    half[backwards] = (0.0, 0.0, 0.0, 1.0)
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(half, scalar_first=True).as_quat(scalar_first=True)


def _edges(drawing: StructuralDrawing) -> list[tuple[int, int]]:
    """Node numbers of the ends of the segments."""
    lines = [
        look.vertices for look in drawing.model.look() if isinstance(look, Bars | Beams | Coils)
    ]
    pairs = np.concatenate([np.zeros((0, 2), dtype=int), *lines, drawing.outline()])
    neighbours: dict[int, list[int]] = {}
    for i, j in pairs.tolist():
        neighbours.setdefault(i, []).append(j)
        neighbours.setdefault(j, []).append(i)
    rest = drawing.rest
    corners = {n for n, adjacent in neighbours.items() if _is_corner(rest, n, adjacent)}
    corners |= set() if corners else set(list(neighbours)[:1])
    edges, visited = [], set()
    for corner in sorted(corners):
        for first in neighbours[corner]:
            chain = _chain(corner, first, neighbours, corners)
            if frozenset(chain[:2]) not in visited:
                visited |= {frozenset(p) for p in itertools.pairwise(chain)}
                index = np.linspace(0, len(chain) - 1, min(len(chain), MAX_PIECES + 1)).round()
                nodes = [chain[int(k)] for k in index]
                edges += list(itertools.pairwise(nodes))
    return edges


def _is_corner(rest: np.ndarray, node: int, adjacent: list[int]) -> bool:
    """Whether lines end, meet or bend at a node."""
    if len(adjacent) != 2:
        return True
    first, second = (rest[k] - rest[node] for k in adjacent)
    cosine = first @ second / max(np.linalg.norm(first) * np.linalg.norm(second), 1e-300)
    return bool(cosine > -0.9)


def _chain(
    corner: int, first: int, neighbours: dict[int, list[int]], corners: set[int]
) -> list[int]:
    """Nodes from a corner to the next one."""
    chain = [corner, first]
    while chain[-1] not in corners:
        ahead = [n for n in neighbours[chain[-1]] if n != chain[-2]]
        chain.append(ahead[0])
    return chain
