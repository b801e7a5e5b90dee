"""Orientations and frames of a file: tables that mirror ``da.rotation`` and ``body.frame``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

from pydantic import Field, create_model

from dalembert.elements import rotation
from dalembert.elements.rotation import Orientation
from dalembert.io.choices import Record, one_of
from dalembert.io.formulas import Formulas
from dalembert.io.values import Entry, Text, list_of

Direction: Any = list_of(Entry, 3, "x, y, z")
Rows: Any = list_of(Direction, 3, "rows")


class AxisAngle(Record):
    """Turn about an axis."""

    type: Literal["axis_angle"]
    axis: Direction
    angle: Entry = Field(description="[rad]")


class EulerAngles(Record):
    """Turns about body axes one after the other."""

    type: Literal["euler"]
    sequence: Text = Field(description="axes such as zxz")
    angles: list[Entry] = Field(description="as many [rad]")


class BryantAngles(Record):
    """Turns about the body's x, y and z axes, one after the other [rad]."""

    type: Literal["bryant"]
    x: Entry
    y: Entry
    z: Entry


class FromMatrix(Record):
    """By a rotation matrix, whose columns are the axes of the turned frame."""

    type: Literal["from_matrix"]
    rows: Rows


Read = Callable[[Any], Any]
MADE: dict[str, tuple[type[Record], Callable[[Any, Read], Orientation]]] = {
    "axis_angle": (
        AxisAngle,
        lambda given, read: rotation.axis_angle([read(a) for a in given.axis], read(given.angle)),
    ),
    "euler": (
        EulerAngles,
        lambda given, read: rotation.euler(given.sequence, *map(read, given.angles)),
    ),
    "bryant": (
        BryantAngles,
        lambda given, read: rotation.bryant(read(given.x), read(given.y), read(given.z)),
    ),
    "from_matrix": (
        FromMatrix,
        lambda given, read: rotation.from_matrix([list(map(read, row)) for row in given.rows]),
    ),
}
"""Way to say it → its table, and what makes the orientation of one."""
OrientationType: Any = one_of({name: table for name, (table, _) in MADE.items()})


class FrameTable(Record):
    """A frame of a body, in its axes."""

    at: Direction = Field(default=(0.0, 0.0, 0.0), description="its origin [m]")
    axis: Direction = Field(default=None, description="its z axis")
    x: Direction = Field(default=None, description="its x axis, beside axis")
    rotation: OrientationType = Field(default=None, description="its orientation, without axis")


InlineFrame = create_model(
    "InlineFrame",
    __base__=FrameTable,
    __doc__="A point or frame that needs no name, in the axes of its body.",
    body=(Text, Field(description="name of a body")),
)


def read_orientation(given: Any, formulas: Formulas) -> Orientation:
    """The orientation that a table describes."""
    return MADE[given.type][1](given, formulas.read)


def read_frame(given: FrameTable, formulas: Formulas) -> dict[str, Any]:
    """Keywords of a frame."""
    made: dict[str, Any] = {"place": [formulas.read(entry) for entry in given.at]}
    for key in ("axis", "x"):
        if getattr(given, key) is not None:
            made[key] = [formulas.read(entry) for entry in getattr(given, key)]
    if given.rotation is not None:
        made["rotation"] = read_orientation(given.rotation, formulas)
    return made
