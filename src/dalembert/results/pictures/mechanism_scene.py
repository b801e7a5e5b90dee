"""MechanismScene of a mechanism: bodies, flexible bodies, connections and poses."""

from __future__ import annotations

import itertools
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.flexible.floating import FloatingFrame
from dalembert.elements.flexible.shapes import FloatingShapes
from dalembert.elements.look import Bars, Beams, Coils
from dalembert.elements.point import Point
from dalembert.results.labelled import LabelledRecording
from dalembert.results.pictures.primitives import Primitives
from dalembert.results.sources import InitialPicture, Track
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
            "gravity": None if gravity is None else primitives.number(gravity.sx),
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
            "joints": primitives.joints + self.contacts(),
            "links": primitives.links,
            "symbols": primitives.symbols,
            "points": [
                {"name": p.name, **primitives.point_data(p)}
                for b in self.model.bodies
                for p in b.points.values()
            ],
        }

    def contacts(self) -> list[dict[str, Any]]:
        """Symbols of the contacts of motions that record them."""
        motion = self.primitives.motion
        if motion.drawn_contacts(int(self.keep[0])) is None:
            return []
        from dalembert.results.pictures.contact_symbols import contact_symbols

        return contact_symbols(motion, self.keep, self.primitives.dimension)

    def deformed(self) -> list[dict[str, Any]]:
        """Sections and segments of flexible bodies, as bodies of the scene."""
        primitives, bodies = self.primitives, []
        for section in primitives.sections:
            rotation = section.pose_angle if section.dimension == 2 else section.orientation
            pose = self.tracks([section.place, rotation])
            header = {"name": section.display_name, "of": section.name, **self.pose(*pose)}
            bodies.append(header | {"shapes": primitives.shapes[section.display_name]})
        for body in self.model.bodies:
            if isinstance(body, FloatingFrame):
                bodies += self.segments(body)
        return bodies

    def segments(self, body: FloatingFrame) -> list[dict[str, Any]]:
        """Segments of a flexible body as bars, with x along them."""
        shapes = self.model.shapes(body, self.primitives.motion.parameters)
        poses, bodies = segment_poses(body, shapes), []
        tracks = self.tracks([sx for position, rotation, _ in poses for sx in (position, rotation)])
        if body.numbers is not None:
            tracks = [Track(track.values, None) for track in tracks]
        for k, (_, _, length) in enumerate(poses):
            position, rotation = tracks[2 * k : 2 * k + 2]
            end = np.eye(1, self.primitives.dimension)[0] * length
            bar = {"kind": "bar", "from": [0.0] * len(end), "to": end.tolist()}
            header = {"name": f"{body.name}/{k + 1}", "of": body.name}
            entries = header | self.pose(position, rotation) | {"shapes": [bar]}
            bodies.append(entries if body.numbers is None else InitialPicture(body.name, entries))
        return bodies

    def tracks(self, formulas: list[ca.SX]) -> list[Track]:
        """Formulas over time, in one pass over the states."""
        columns = self.primitives.motion.columns([Expression(sx) for sx in formulas])
        tables = (values[self.keep].reshape(len(self.keep), -1) for values in columns)
        return [Track(table, sx) for table, sx in zip(tables, formulas, strict=True)]

    def pose(self, position: Track, rotation: Track) -> dict[str, list[float]]:
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
        named = [point for body in self.model.bodies for point in body.points.values()]
        attached = [
            point
            for element in self.primitives.elements
            for point in vars(element).values()
            if isinstance(point, Point)
        ]
        self.primitives.locate([*named, *attached])
        for point in named:
            self.points[point.body.display_name].append(tuple(self.primitives.local(point)))
        for point in attached:
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


def segment_poses(body: FloatingFrame, shapes: FloatingShapes) -> list[tuple[ca.SX, ca.SX, float]]:
    """Positions, angles or Euler parameters with x along the segment, and lengths of segments."""
    drawing, d = StructuralDrawing(shapes.structure, shapes.p), body.dimension
    origin, table = body.locate(ca.SX.zeros(d)), shapes.structure.degrees.table[:, :d]

    def place(node: int) -> ca.SX:
        displacements = ca.DM(shapes.displacements[table[node]])
        return drawing.rest[node, :d] - shapes.origin + ca.mtimes(displacements, body.amplitudes)

    poses = []
    for i, j in _edges(drawing):
        start, rest = place(i), drawing.rest[j, :d] - drawing.rest[i, :d]
        rotation = _segment_rotation(body, place(j) - start, rest)
        poses.append((origin + body.turned(start), rotation, float(np.linalg.norm(rest))))
    return poses


def _segment_rotation(body: Any, direction: ca.SX, rest: np.ndarray) -> ca.SX:
    """Angle, or Euler parameters (4,), that rotate the x axis into a direction of the frame.

    ``rest`` is the direction without deformation; angles are relative to it.
    """
    if body.dimension == 2:
        across = rest[0] * direction[1] - rest[1] * direction[0]
        bend = ca.atan2(across, ca.dot(ca.DM(rest), direction))
        return body.pose_angle + float(np.arctan2(rest[1], rest[0])) + bend
    unit = body.turned(direction / ca.norm_2(direction))
    half = ca.vertcat(1 + unit[0], 0, -unit[2], unit[1])
    half = ca.if_else(half[0] < 1e-12, ca.vertcat(0, 0, 0, 1), half)
    return half / ca.norm_2(half)


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
