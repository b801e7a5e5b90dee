"""Boundary of a planar region as segments of straight edges and circles, which can be divided."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

SHARP = np.pi / 3
"""Angle of a corner below which triangles at it may be flat."""


@dataclass(frozen=True)
class Edge:
    """Straight edge between two vertices.

    Attributes
    ----------
    ends : numbers of the first coordinates of the vertices
    start, end : their places (2,) [m]
    group : name of the group of its nodes
    """

    ends: tuple[int, int]
    start: np.ndarray
    end: np.ndarray
    group: str

    def at(self, share: float) -> np.ndarray:
        """Place at a share of the length."""
        return np.asarray((1 - share) * self.start + share * self.end)


@dataclass(frozen=True)
class Circle:
    """Circle; the region lies outside.

    Attributes
    ----------
    number : of the first coordinate of its centre
    center : (2,) [m]
    radius : [m]
    group : name of the group of its nodes
    """

    number: int
    center: np.ndarray
    radius: float
    group: str

    def direction(self, share: float) -> np.ndarray:
        """Unit vector from the centre to a share of the circumference."""
        return np.array([np.cos(2 * np.pi * share), np.sin(2 * np.pi * share)])

    def at(self, share: float) -> np.ndarray:
        """Place at a share of the circumference."""
        return np.asarray(self.center + self.radius * self.direction(share))


Piece = Edge | Circle


class Boundary:
    """Segments of the pieces of a boundary.

    Parameters
    ----------
    loops : closed loops of pieces: the outline, then the holes
    size : length of segments [m]

    Attributes
    ----------
    points : (count, 2) ends of segments [m]
    ends : (segments, 2) numbers of their points
    segments : piece, and shares of its length at both ends, of each segment
    """

    def __init__(self, loops: Sequence[Sequence[Piece]], size: float):
        places: list[np.ndarray] = []
        ends: list[tuple[int, int]] = []
        self.segments: list[tuple[Piece, float, float]] = []
        self.sharp: set[int] = set()
        self.corners: set[int] = set()
        for loop in loops:
            first = len(places)
            for piece in loop:
                if isinstance(piece, Edge):
                    self.corners.add(len(places))
                    count = max(1, round(float(np.linalg.norm(piece.end - piece.start)) / size))
                else:
                    count = max(12, int(np.ceil(2 * np.pi * piece.radius / size)))
                for k in range(count):
                    ends.append((len(places), len(places) + 1))
                    places.append(piece.at(k / count))
                    self.segments.append((piece, k / count, (k + 1) / count))
            ends[-1] = (ends[-1][0], first)
        self.points = np.array(places)
        self.ends = np.array(ends)
        self._find_sharp_corners()

    def _find_sharp_corners(self) -> None:
        before = {int(j): int(i) for i, j in self.ends}
        after = {int(i): int(j) for i, j in self.ends}
        for corner in self.corners:
            u = self.points[after[corner]] - self.points[corner]
            v = self.points[before[corner]] - self.points[corner]
            cosine = u @ v / (np.linalg.norm(u) * np.linalg.norm(v))
            if np.arccos(np.clip(cosine, -1, 1)) < SHARP:
                self.sharp.add(corner)

    def divide(self, numbers: Sequence[int]) -> None:
        """Divide segments in two; new points come last."""
        points, ends = list(self.points), self.ends.tolist()
        for k in numbers:
            (i, j), (piece, s, e) = ends[k], self.segments[k]
            middle = self._middle(i, j, s, e)
            new = len(points)
            points.append(piece.at(middle))
            ends[k] = [i, new]
            ends.append([new, j])
            self.segments[k] = (piece, s, middle)
            self.segments.append((piece, middle, e))
        self.points, self.ends = np.array(points), np.array(ends)

    def _middle(self, i: int, j: int, s: float, e: float) -> float:
        """Share at which a segment is divided: at a power of two of the length from a corner."""
        at_i, at_j = i in self.corners, j in self.corners
        if at_i == at_j:
            return (s + e) / 2
        length = float(np.linalg.norm(self.points[j] - self.points[i]))
        part = float(2.0 ** round(math.log2(length / 2)) / length)
        part = part if 0.3 < part < 0.7 else 0.5
        return s + part * (e - s) if at_i else e - part * (e - s)

    def divisible(self, k: int, size: float) -> bool:
        """Whether a segment is long enough to be divided."""
        i, j = self.ends[k]
        return float(np.linalg.norm(self.points[j] - self.points[i])) > size / 64

    def at_sharp_corner(self, triangles: np.ndarray) -> np.ndarray:
        """Whether triangles lie at a corner with a small angle."""
        return np.asarray(np.isin(triangles, list(self.sharp)).any(axis=1))

    def contains(self, places: np.ndarray) -> np.ndarray:
        """Whether places (k, 2) lie in the region: a ray crosses its boundary an odd number of
        times."""
        crossings = np.zeros(len(places), dtype=int)
        x, y = places.T
        for (x0, y0), (x1, y1) in self.points[self.ends]:
            if y0 == y1:
                continue
            spans = (y0 > y) != (y1 > y)
            crossings += spans & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
        return np.asarray(crossings % 2 == 1)

    def distance(self, places: np.ndarray, limit: float) -> np.ndarray:
        """(k,) distances of places (k, 2) from the boundary, at most ``limit`` [m]."""
        result = np.full(len(places), limit)
        for a, b in self.points[self.ends]:
            low, high = np.minimum(a, b) - limit, np.maximum(a, b) + limit
            near = np.flatnonzero(((places > low) & (places < high)).all(axis=1))
            along = np.clip((places[near] - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
            away = np.linalg.norm(places[near] - a - along[:, None] * (b - a), axis=1)
            result[near] = np.minimum(result[near], away)
        return result

    def encroached(self, places: np.ndarray) -> list[np.ndarray]:
        """Numbers of the segments in whose diametral circle each of the places (k, 2) lies."""
        a, b = self.points[self.ends[:, 0]], self.points[self.ends[:, 1]]
        middle, square = (a + b) / 2, ((b - a) ** 2).sum(axis=1) / 4
        return [
            np.flatnonzero(((middle - place) ** 2).sum(axis=1) < square * (1 - 1e-9))
            for place in places
        ]
