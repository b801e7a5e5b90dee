"""Contents of a drawing: lines, circles, slots and texts in one unit of length."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from dalembert.budget import LARGEST
from dalembert.errors import ModelError
from dalembert.io.omission import Omission

MOST = 4000
"""Upper limit of the number of corners, circles and texts, all pairs of which are compared."""
VISITED = 20 * MOST
"""Upper limit of the number of entities of all kinds, with those of inserted blocks and clones."""
CURVES = (
    "is a curve, which no bar is; connect its pins by straight lines, or give the curve to a "
    "PointOnCurve joint"
)
"""Reason of the omission of a curve."""


@dataclass(frozen=True, eq=False)
class Entity:
    """Part of a drawing.

    Attributes
    ----------
    place : file and entity, such as ``leg.dxf: LINE 2F on layer 'crank'``
    words : names of its layer, groups and classes, the outermost first
    name : its own name, if a person wrote one
    group : layer or group whose connected lines are one body; empty for none
    """

    place: str
    words: tuple[str, ...] = ()
    name: str = ""
    group: str = ""


@dataclass(frozen=True, eq=False)
class Line(Entity):
    """Straight lines through corners.

    Attributes
    ----------
    corners : (n, 2) in the unit of the drawing; a closed line does not repeat the first
    closed : whether the last corner is joined to the first
    """

    corners: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    closed: bool = False

    @property
    def segments(self) -> np.ndarray:
        """(m, 2, 2) start and end of each piece."""
        following = np.roll(self.corners, -1, axis=0)
        pairs = np.stack([self.corners, following], axis=1)
        return pairs if self.closed else pairs[:-1]

    @property
    def length(self) -> float:
        return float(np.linalg.norm(np.diff(self.segments, axis=1), axis=2).sum())


@dataclass(frozen=True, eq=False)
class Circle(Entity):
    """A circle; a point has the radius zero.

    Attributes
    ----------
    center : (2,)
    radius : in the unit of the drawing
    filled : whether its interior is hatched or coloured
    """

    center: np.ndarray = field(default_factory=lambda: np.zeros(2))
    radius: float = 0.0
    filled: bool = False


@dataclass(frozen=True, eq=False)
class Slot(Entity):
    """Straight slot between two rounded ends, by its centre line.

    Attributes
    ----------
    ends : (2, 2) centres of the rounded ends
    width : of the slot; zero for a line
    """

    ends: np.ndarray = field(default_factory=lambda: np.zeros((2, 2)))
    width: float = 0.0


@dataclass(frozen=True, eq=False)
class Label(Entity):
    """A text.

    Attributes
    ----------
    position : (2,) of its middle
    text : its content
    """

    position: np.ndarray = field(default_factory=lambda: np.zeros(2))
    text: str = ""


@dataclass(frozen=True, eq=False)
class Arrow(Entity):
    """A mark of motion on a layer for motors: its points."""

    points: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))


@dataclass
class Drawing:
    """Entities of a file.

    Attributes
    ----------
    path : the file
    unit : of all coordinates, such as ``"mm"``
    entities : in the order of the file
    omissions : entities that are not converted
    """

    path: Path
    unit: str = "mm"
    entities: list[Entity] = field(default_factory=list)
    omissions: list[Omission] = field(default_factory=list)
    size: int = 0

    def add(self, entity: Entity) -> None:
        """Add an entity with finite coordinates.

        Raises
        ------
        ModelError
            A coordinate is not finite, or there are too many entities.
        """
        for value in vars(entity).values():
            if isinstance(value, (np.ndarray, float)) and not (np.abs(value) < LARGEST).all():
                wrong = np.asarray(value).ravel()
                number = wrong[~(np.abs(wrong) < LARGEST)][0]
                raise ModelError(f"the coordinate {number} is no usable number", entity.place)
        self.entities.append(entity)
        self.size += len(entity.corners) if isinstance(entity, Line) else 1
        if self.size > MOST:
            raise ModelError(
                f"the drawing has more than {MOST} corners of lines, circles and texts; delete or "
                "hide what is not part of the mechanism",
                str(self.path),
            )

    def omit(self, place: str, content: str, reason: str) -> None:
        """Record an entity that is not converted."""
        self.omissions.append(Omission(place, content, reason))

    def convert(self, convert: Callable[[Entity], Sequence[Entity]]) -> None:
        """Replace each entity."""
        self.entities = [new for entity in self.entities for new in convert(entity)]

    def lines(self) -> Iterator[Line]:
        return (entity for entity in self.entities if isinstance(entity, Line))

    def circles(self) -> Iterator[Circle]:
        return (entity for entity in self.entities if isinstance(entity, Circle))
