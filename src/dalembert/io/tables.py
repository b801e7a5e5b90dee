"""Tables of a file, generated from the classes that they describe."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, Field, create_model

from dalembert.analysis.events import Event, Events
from dalembert.analysis.rayleigh import Rayleigh
from dalembert.analysis.times import TIMES
from dalembert.elements.base import Constraint, Rows
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.collisions import takes
from dalembert.elements.contact.friction import Friction
from dalembert.elements.contact.laws import NormalLaw
from dalembert.elements.contact.shapes import Shape
from dalembert.elements.curves import Curve
from dalembert.elements.flexible.beam import Beam
from dalembert.elements.flexible.body import Interfaces, Numbers
from dalembert.elements.flexible.shapes import FlexibleStructure
from dalembert.elements.frame import Frame, Frames
from dalembert.elements.laws.base import Law, Product, Sum
from dalembert.elements.point import Point
from dalembert.elements.registry import (
    CONTACT_LAWS,
    CONTACT_PAIRS,
    CURVES,
    FRICTIONS,
    LAWS,
    SHAPES,
    SPACES,
)
from dalembert.elements.rotation import Orientation
from dalembert.elements.springs import ForceLaw
from dalembert.io import fields
from dalembert.io.analysis_tables import EventTable, RayleighTable, density_type
from dalembert.io.choices import Record, one_of, table_or
from dalembert.io.fields import (
    FROM_FILE,
    Amplitudes,
    Densities,
    FileField,
    Frequencies,
    Interval,
    Laws,
    Measured,
    Names,
    Pairs,
    Places,
    Points,
    Quantities,
    Quantity,
    Shapes,
    connected_fields,
    keyed_fields,
)
from dalembert.io.orientations import FrameTable, GeometryTable, InlineFrame, OrientationType
from dalembert.io.strategies import STRATEGIES_OF
from dalembert.io.values import (
    CountOrTimes,
    Entry,
    Flag,
    Integer,
    InterfacesType,
    ListOfRows,
    Number,
    Text,
    list_of,
    short_repr,
)
from dalembert.results.analysis import Analysis
from dalembert.results.structural.result import StructuralResult
from dalembert.text.wording import unknown


def point_type(dimension: int) -> Any:
    """Type of the coordinates of a point."""
    return list_of(Entry, dimension, ", ".join("xyz"[:dimension]))


class InlinePoint(Record):
    """An unnamed point: coordinates in the frame of its body [m]."""

    body: Text
    at: point_type(2)  # type: ignore[valid-type]


INLINE: dict[int, type[Record]] = {2: InlinePoint, 3: InlineFrame}
"""Dimension → table of an unnamed point or frame."""


def name_or_table(classes: Mapping[str, type]) -> Any:
    """Type of a strategy: its name, or a table with its type and options."""

    def check(value: object) -> Any:
        if isinstance(value, str) and value not in classes:
            raise ValueError(unknown("name", value, classes))
        if not isinstance(value, (str, dict, BaseModel)):
            raise ValueError(
                f"expected a name ({', '.join(classes)}) or a table, got {short_repr(value)}"
            )
        return value

    plain: Any = Annotated[Literal[tuple(classes)], Field(title="name")]
    return Annotated[one_of(tables_of(classes), plain=plain), BeforeValidator(check)]


def reference(dimension: int) -> Any:
    """Type of a point or frame, by name or inline."""
    return table_or(INLINE[dimension], Text)


def _connection(connections: list[FileField], dimension: int) -> Any:
    names = ", ".join(f.name for f in connections)
    takes_points = any(f.holds in (Point, Frame) for f in connections)
    return list_of(reference(dimension) if takes_points else Text, len(connections), names)


VALUES: dict[Any, Any] = {
    **dict.fromkeys((Quantity, ForceLaw, Measured), Entry),
    **dict.fromkeys((str, Path, Event, StructuralResult, BodyElement, Beam, Constraint), Text),
    float: Number,
    int: Integer,
    bool: Flag,
    Rows: ListOfRows,
    fields.Coefficients: list[Entry],
    fields.CountOrTimes: CountOrTimes,
    Interval: list_of(Number, 2, "start, end"),
    Names: list[Text],
    FlexibleStructure: Text,
    Interfaces: InterfacesType,
    Numbers: dict[str, Entry],
    Rayleigh: RayleighTable,
    Orientation: OrientationType,
    Frames: dict[str, FrameTable],
    fields.Geometries: list[GeometryTable],
    Events: dict[str, table_or(EventTable, Entry)],  # type: ignore[misc]
    Frequencies: list[Number],
    Amplitudes: dict[str, Number | list_of(Number, 2, "amplitude, phase [rad]")],  # type: ignore[misc]
    Densities: dict[str, density_type()],  # type: ignore[misc]
}
"""File type of a field → pydantic type."""

TIMED: dict[Any, Any] = {
    float: Entry,
    Interval: list_of(Entry, 2, "start, end"),
    fields.CountOrTimes: CountOrTimes,
}
"""File type of a time → pydantic type; times may be formulas of parameters."""


def _quantities(field: FileField) -> Any:
    """Type of a list, or of a single entry where one is enough."""
    listed = list_of(Entry, field.size, least=field.minimum_size)
    return Entry | listed if field.minimum_size == 1 else listed


def value_type(field: FileField, dimension: int = 2) -> Any:
    """Pydantic type of the value of a field.

    Parameters
    ----------
    dimension : number of coordinates of a point
    """
    if field.name in TIMES and field.holds in TIMED and issubclass(field.owner, Analysis):
        return TIMED[field.holds]
    if field.holds in VALUES:
        return VALUES[field.holds]
    makers: dict[Any, Callable[[], Any]] = {
        Quantities: lambda: _quantities(field),
        Points: lambda: dict[str, point_type(dimension)],  # type: ignore[misc]
        **dict.fromkeys((Point, Frame), lambda: reference(dimension)),
        Places: lambda: list[reference(dimension)],  # type: ignore[misc]
        Law: law_type,
        Laws: lambda: list[law_type(*COMBINED[COMBINED.index(field.owner) :])],  # type: ignore[misc]
        Shape: lambda: shape_type(dimension),
        Shapes: lambda: shapes_type(dimension),
        Pairs: lambda: list[table_of("Pair", CONTACT_PAIRS["Pair"], optional_type=True)],  # type: ignore[misc]
        **{kind: partial(registered_type, kind) for kind in REGISTRIES},
    }
    return makers[field.holds]() if field.holds in makers else strategy_type(field.holds)


COMBINED: tuple[type, ...] = (Product, Sum)
"""Laws composed of laws; each may contain those before it."""


@cache
def law_type(*without: type) -> Any:
    """Type of a law except the given ones, or of a number or formula in t."""
    tables = {n: partial(table_of, n, c) for n, c in LAWS.items() if c not in without}
    return one_of(tables, plain=Entry)


REGISTRIES: dict[type, Mapping[str, type]] = {
    Curve: CURVES,
    NormalLaw: CONTACT_LAWS,
    Friction: FRICTIONS,
}
"""Kind of an object that a table describes → its classes."""


@cache
def registered_type(kind: type) -> Any:
    """Type of an object of a kind."""
    return any_of(REGISTRIES[kind])


@cache
def shape_type(dimension: int, collides: bool = False) -> Any:
    """Type of a contact shape, one of collisions if it ``collides``, or the name of a point."""
    space, shapes = SPACES[dimension].name.title(), SHAPES[dimension]
    reason = "not available here, only in Contact"
    others = {n: reason for n, kind in shapes.items() if collides and not takes(kind)}
    tables = {
        name: partial(table_of, name, cls, dimension=dimension, title=f"{space}{name}Shape")
        for name, cls in shapes.items()
        if name not in others
    }
    return one_of(tables, plain=Text, misplaced=others)


@cache
def shapes_type(dimension: int) -> Any:
    """Type of a list of shapes of collisions, or of lists by the names of groups."""
    shape = shape_type(dimension, collides=True)
    return table_or(dict[str, list[shape]], list[shape])  # type: ignore[valid-type]


def any_of(registry: Mapping[str, type], misplaced: Mapping[str, str] | None = None) -> Any:
    """Type of a table that describes an object of one of the registered classes."""
    return one_of(tables_of(registry), misplaced=misplaced)


def tables_of(registry: Mapping[str, type]) -> dict[str, Callable[[], type[BaseModel]]]:
    """Name of a class → function that creates its table."""

    def table(name: str) -> type[BaseModel]:
        return table_of(name, registry[name])

    return {name: partial(table, name) for name in registry}


@cache
def strategy_type(kind: type) -> Any:
    """Type of a strategy of a kind, by its name or with its options."""
    return name_or_table(STRATEGIES_OF[kind])


def table_of(
    name: str,
    cls: Any,
    *,
    optional_type: bool = False,
    dimension: int = 2,
    also: str = "",
    title: str = "",
    more: Mapping[str, Any] | None = None,
) -> type[BaseModel]:
    """The table that describes an object of a registered class.

    Parameters
    ----------
    optional_type : the type is optional
    dimension : number of coordinates of a point
    also : alias of its type
    title : its name in the schema, the type by default
    more : additional or overridden keys: (type, field)
    """
    kind = Literal[(name, also) if also else (name,)]  # type: ignore[valid-type]
    keys: dict[str, Any] = {"type": (kind, name if optional_type else ...)}
    connections = connected_fields(cls)
    if connections:
        text = "connected bodies, points or frames, in order: " + ", ".join(
            f.name for f in connections
        )
        default = ... if any(f.is_needed for f in connections) else None
        keys["connect"] = (_connection(connections, dimension), Field(default, description=text))
    from_file = FROM_FILE.get(name, {})
    if from_file:
        text = (
            f"CSV file with two columns, units in its heading, instead of {' and '.join(from_file)}"
        )
        keys["file"] = (Text, Field(default=None, description=text))
    for field in keyed_fields(cls):
        if field.name in (more or {}):
            continue
        default = ... if field.is_needed and field.name not in from_file else None
        value = value_type(field, dimension)
        keys[field.name] = (value, Field(default, description=about_field(field)))
    keys |= more or {}
    return create_model(title or name, __base__=Record, __doc__=summary_of(cls), **keys)


def about_field(field: FileField) -> str | None:
    """Description of a field, with its unit."""
    metadata = field.field.metadata
    text, unit = metadata.get("description"), metadata.get("unit")
    if field.holds is Points:
        return "name of a point: its coordinates in the body frame [m]"
    if field.holds is Frames:
        return "name of a frame: where it is in the body frame"
    return f"{text} [{unit}]" if text and unit else text


def summary_of(cls: type) -> str:
    """First paragraph of the docstring of a class."""
    return inspect.cleandoc(cls.__doc__ or "").split("\n\n")[0].replace("\n", " ")
