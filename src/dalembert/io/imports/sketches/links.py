"""Links of a drawing: lines that are rigidly joined, and the pins on them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dalembert.io.imports.sketches.drawing import Drawing, Line
from dalembert.io.imports.sketches.pins import Pin


@dataclass(eq=False)
class Link:
    """A rigid part: its lines, moved to the centres of pins, and its pins.

    Attributes
    ----------
    lines : of the link
    pins : on it
    corners : those of these pins at corners or ends of lines
    """

    lines: list[Line]
    pins: list[Pin]
    corners: list[Pin]
    is_ground: bool = False
    name: str = ""
    slots: list = field(default_factory=list)

    @property
    def place(self) -> str:
        return self.lines[0].place

    @property
    def segments(self) -> np.ndarray:
        """(m, 2, 2) ends of its straight pieces."""
        return np.concatenate([line.segments for line in self.lines])

    @property
    def is_bar(self) -> bool:
        """Whether it is one straight piece."""
        return len(self.segments) == 1

    def remove(self, pin: Pin) -> None:
        """Detach a pin that is not at a corner."""
        if pin in self.pins and pin not in self.corners:
            self.pins.remove(pin)

    def moments(self) -> tuple[float, np.ndarray, float]:
        """Length, (2,) centroid, and ``∫ |s|² dl`` about it, of uniform slender bars."""
        starts, ends = self.segments[:, 0], self.segments[:, 1]
        lengths = np.linalg.norm(ends - starts, axis=1)
        middles, total = (starts + ends) / 2, float(lengths.sum())
        center = lengths @ middles / total
        arms = ((middles - center) ** 2).sum(axis=1)
        return total, center, float((lengths**3 / 12 + lengths * arms).sum())


def distances(points: np.ndarray, segments: np.ndarray, low: float = 0.0) -> np.ndarray:
    """(n, m) distances of points from segments, or from their middle parts.

    Parameters
    ----------
    low : share that is cut off at both ends
    """
    starts, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    squares = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    share = np.einsum("nmi,mi->nm", points[:, None] - starts, along) / squares
    nearest = starts + np.clip(share, low, 1 - low)[..., None] * along
    return np.asarray(np.linalg.norm(points[:, None] - nearest, axis=2))


class Joining:
    """Search of the pins on lines, and of lines that are rigidly joined.

    Parameters
    ----------
    drawing : gets omissions
    lines : of parts and of the ground
    pins : of the drawing
    tolerance : distance below which places coincide
    """

    def __init__(self, drawing: Drawing, lines: list[Line], pins: list[Pin], tolerance: float):
        self.drawing, self.pins, self.tolerance = drawing, pins, tolerance
        self.lines: list[Line] = []
        self.on: list[tuple[list[Pin], list[Pin]]] = []
        seen: dict[tuple, Line] = {}
        for line in lines:
            moved, at_corners = self._moved(line)
            if moved.length <= tolerance or len(moved.segments) == 0:
                self.drawing.omit(line.place, "line", "has no length within the tolerance")
                continue
            rounded = np.round(moved.corners / max(tolerance, 1e-300)).astype(np.int64)
            key = (*sorted(map(tuple, rounded.tolist())), line.closed, line.group)
            if key in seen:
                other = seen[key].place.partition(": ")[2]
                self.drawing.omit(line.place, "line", f"is drawn twice, here and by {other}")
                continue
            seen[key] = line
            self.lines.append(moved)
            self.on.append((at_corners, self._between(moved, at_corners)))

    def _moved(self, line: Line) -> tuple[Line, list[Pin]]:
        """The line with ends in circles moved to their centres, and pins at its corners."""
        corners, at_corners = line.corners.copy(), []
        if self.pins:
            centers = np.array([pin.center for pin in self.pins])
            radii = np.array([pin.radius for pin in self.pins])
            for k, corner in enumerate(line.corners):
                away = np.linalg.norm(centers - corner, axis=1)
                inside = np.where(away <= radii + self.tolerance, away, np.inf)
                if np.isfinite(inside.min()):
                    pin = self.pins[int(inside.argmin())]
                    corners[k] = pin.center
                    at_corners.append(pin)
        moved = Line(**(vars(line) | {"corners": corners}))
        for pin in dict.fromkeys(at_corners):
            beside = float(distances(pin.center[None], _extended(line.segments, pin.radius)).min())
            if beside > 2 * self.tolerance:
                text = f"line, {beside:.3g} {self.drawing.unit} beside the centre of its pin"
                self.drawing.omit(line.place, text, "is moved to the centre of the circle")
        return moved, list(dict.fromkeys(at_corners))

    def _between(self, line: Line, at_corners: list[Pin]) -> list[Pin]:
        """Pins between the corners of a line."""
        others = [pin for pin in self.pins if pin not in at_corners]
        if not others:
            return []
        centers = np.array([pin.center for pin in others])
        away = distances(centers, line.segments).min(axis=1)
        return [p for p, d in zip(others, away, strict=True) if d <= max(p.radius, self.tolerance)]

    def links(self) -> list[Link]:
        """Lines that share a corner without a pin, or a named group, become one link."""
        parent = list(range(len(self.lines)))

        def root(k: int) -> int:
            while parent[k] != k:
                parent[k] = parent[parent[k]]
                k = parent[k]
            return k

        for first, second in [*self._touching(), *self._grouped()]:
            parent[root(first)] = root(second)
        sets: dict[int, list[int]] = {}
        for k in range(len(self.lines)):
            sets.setdefault(root(k), []).append(k)
        return [self._link(members) for members in sets.values()]

    def _link(self, members: list[int]) -> Link:
        corners = list(dict.fromkeys(pin for k in members for pin in self.on[k][0]))
        between = [pin for k in members for pin in self.on[k][1]]
        pins = list(dict.fromkeys([*corners, *between]))
        return Link([self.lines[k] for k in members], pins, corners)

    def _touching(self) -> list[tuple[int, int]]:
        """Pairs of lines of which one ends at the other, without a pin."""
        pairs = []
        pieces = [line.segments for line in self.lines]
        if not pieces:
            return []
        segments = np.concatenate(pieces)
        owners = np.repeat(np.arange(len(pieces)), [len(piece) for piece in pieces])
        centers = np.array([pin.center for pin in self.pins]).reshape(-1, 2)
        for k, line in enumerate(self.lines):
            ends = line.corners if line.closed else line.corners[[0, -1]]
            free = np.array([c for c in ends if not (c == centers).all(axis=1).any()])
            if len(free):
                touched = distances(free, segments).min(axis=0) <= self.tolerance
                pairs += [(k, int(other)) for other in owners[touched] if other != k]
        return pairs

    def _grouped(self) -> list[tuple[int, int]]:
        """Pairs of lines of one group that share a pin."""
        first: dict[tuple[str, Pin], int] = {}
        pairs = []
        for k, line in enumerate(self.lines):
            for pin in (*self.on[k][0], *self.on[k][1]) if line.group else ():
                pairs.append((k, first.setdefault((line.group, pin), k)))
        return pairs


def _extended(segments: np.ndarray, length: float) -> np.ndarray:
    """Segments continued at both ends by a length."""
    along = segments[:, 1] - segments[:, 0]
    sizes = np.linalg.norm(along, axis=1, keepdims=True)
    units = np.divide(along, sizes, out=np.zeros_like(along), where=sizes > 0) * 2 * length
    return np.stack([segments[:, 0] - units, segments[:, 1] + units], axis=1)
