"""Orientations and frames of a file: tables that mirror ``da.rotation`` and ``body.frame``."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, create_model

from dalembert.elements import rotation
from dalembert.elements.rotation import Orientation
from dalembert.elements.spatial.geometry import Geometry
from dalembert.io.choices import Record, one_of
from dalembert.io.formulas import Formulas
from dalembert.io.values import Entry, Number, Text, list_of

Direction: Any = list_of(Entry, 3, "x, y, z")
Rows: Any = list_of(Direction, 3, "rows")


class AxisAngle(Record):
    """Rotation about an axis."""

    type: Literal["axis_angle"]
    axis: Direction
    angle: Entry = Field(description="[rad]")


class EulerAngles(Record):
    """Successive rotations about body axes."""

    type: Literal["euler"]
    sequence: Text = Field(description="axes such as zxz")
    angles: list[Entry] = Field(description="as many [rad]")


class BryantAngles(Record):
    """Successive rotations about the body's x, y and z axes [rad]."""

    type: Literal["bryant"]
    x: Entry
    y: Entry
    z: Entry


class FromMatrix(Record):
    """Rotation matrix, whose columns are the axes of the rotated frame."""

    type: Literal["from_matrix"]
    rows: Rows


Read = Callable[[Any], Any]
ORIENTATIONS: dict[str, tuple[type[Record], Callable[[Any, Read], Orientation]]] = {
    "axis_angle": (
        AxisAngle,
        lambda table, read: rotation.axis_angle([read(a) for a in table.axis], read(table.angle)),
    ),
    "euler": (
        EulerAngles,
        lambda table, read: rotation.euler(table.sequence, *map(read, table.angles)),
    ),
    "bryant": (
        BryantAngles,
        lambda table, read: rotation.bryant(read(table.x), read(table.y), read(table.z)),
    ),
    "from_matrix": (
        FromMatrix,
        lambda table, read: rotation.from_matrix([list(map(read, row)) for row in table.rows]),
    ),
}
"""Type of an orientation → its table, and the function that constructs it."""
OrientationType: Any = one_of({name: table for name, (table, _) in ORIENTATIONS.items()})


class FrameTable(Record):
    """A frame of a body, in its axes."""

    at: Direction = Field(default=(0.0, 0.0, 0.0), description="origin [m]")
    axis: Direction = Field(default=None, description="z axis")
    x: Direction = Field(default=None, description="x axis, in addition to axis")
    rotation: OrientationType = Field(default=None, description="orientation, instead of axis")


InlineFrame = create_model(
    "InlineFrame",
    __base__=FrameTable,
    __doc__="A point or frame that needs no name, in the axes of its body.",
    body=(Text, Field(description="name of a body")),
)


class GeometryTable(Record):
    """A solid that pictures show, in the axes of its body."""

    type: Literal["Box", "Sphere", "Ellipsoid", "Cylinder", "Capsule", "Mesh"]
    at: list_of(Number, 3, "x, y, z") = Field(  # type: ignore[valid-type]
        default=(0.0, 0.0, 0.0), description="centre, or origin of the mesh [m]"
    )
    axis: list_of(Number, 3, "x, y, z") = Field(  # type: ignore[valid-type]
        default=None, description="z axis, that of a cylinder or capsule"
    )
    x: list_of(Number, 3, "x, y, z") = Field(  # type: ignore[valid-type]
        default=None, description="x axis, in addition to axis"
    )
    size: list_of(Number, 3, "x, y, z") = Field(  # type: ignore[valid-type]
        default=None, description="lengths of a box, diameters of an ellipsoid [m]"
    )
    radius: Number = Field(default=None, description="[m]")
    length: Number = Field(default=None, description="between the centres of the ends [m]")
    file: Text = Field(default=None, description="STL, OBJ, PLY or glTF file of a mesh")
    scale: list_of(Number, 3, "x, y, z") = Field(  # type: ignore[valid-type]
        default=(1.0, 1.0, 1.0), description="length of the unit of the file [m]"
    )


def read_geometry(table: GeometryTable, folder: Path) -> Geometry:
    """The solid that a table describes."""
    keywords: dict[str, Any] = {key: getattr(table, key) for key in table.model_fields_set}
    if table.file is not None:
        keywords["file"] = folder / table.file
    return Geometry(**keywords)


def read_orientation(table: Any, formulas: Formulas) -> Orientation:
    """The orientation that a table describes."""
    return ORIENTATIONS[table.type][1](table, formulas.read)


def read_frame(table: FrameTable, formulas: Formulas) -> dict[str, Any]:
    """Keyword arguments of ``body.frame``."""
    keywords: dict[str, Any] = {"place": [formulas.read(entry) for entry in table.at]}
    for key in ("axis", "x"):
        if getattr(table, key) is not None:
            keywords[key] = [formulas.read(entry) for entry in getattr(table, key)]
    if table.rotation is not None:
        keywords["rotation"] = read_orientation(table.rotation, formulas)
    return keywords
