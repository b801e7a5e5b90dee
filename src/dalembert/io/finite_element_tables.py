"""Tables of nodes, finite elements, meshes, supports and loads in model files."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field, PlainValidator, WithJsonSchema, create_model

from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.nodal import ROTATIONS, TRANSLATIONS
from dalembert.elements.fem.registry import ELEMENTS
from dalembert.io.choices import Record, one_of
from dalembert.io.fields import Quantity, keyed_fields
from dalembert.io.tables import about_field, summary_of, value_type
from dalembert.io.values import (
    Entry,
    Flag,
    Integer,
    Number,
    Text,
    list_of,
    number_or_formula,
    short_repr,
)

ROTATION_NAMES = ROTATIONS[3]
_VALUE = {"type": ["number", "string"]}
_VALUES = {"type": "array", "items": _VALUE}


def _coordinates(value: Any) -> list[float | str]:
    coordinates = value if isinstance(value, list) else [value]
    if not 1 <= len(coordinates) <= 3:
        raise ValueError(f"expected 1 to 3 coordinates, got {len(coordinates)}")
    return [number_or_formula(v) for v in coordinates]


def _values_by_group(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(group): number_or_formula(v) for group, v in value.items()}
    if isinstance(value, list):
        return [number_or_formula(v) for v in value]
    return number_or_formula(value)


def _names(value: Any) -> list[str]:
    names = value if isinstance(value, list) else [value]
    if not names or not all(isinstance(name, str) for name in names):
        raise ValueError(f"expected the name of nodes, or a list of names, got {short_repr(value)}")
    return names


Place = Annotated[
    Any,
    PlainValidator(_coordinates),
    WithJsonSchema(
        {
            "anyOf": [_VALUE, _VALUES | {"minItems": 1, "maxItems": 3}],
            "description": "coordinates [m], numbers or formulas",
        }
    ),
]
ValuesByGroup = Annotated[
    Any,
    PlainValidator(_values_by_group),
    WithJsonSchema(
        {"anyOf": [_VALUE, _VALUES, {"type": "object", "additionalProperties": _VALUE}]}
    ),
]
"""One number for all, a list with one for each, or a table with one for each group."""
NodeNames = Annotated[
    Any,
    PlainValidator(_names),
    WithJsonSchema({"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}]}),
]
Vertex = Annotated[
    Any,
    PlainValidator(lambda value: _vertex(value)),
    WithJsonSchema(_VALUES | {"minItems": 2, "maxItems": 2}),
]
_OUTLINE = {"type": "array", "items": _VALUES | {"minItems": 2, "maxItems": 2}, "minItems": 3}
Outline = Annotated[
    Any,
    PlainValidator(lambda value: [_vertex(place) for place in _listed(value)]),
    WithJsonSchema(_OUTLINE),
]
Hole = Annotated[
    Any,
    PlainValidator(lambda value: _hole(value)),
    WithJsonSchema(
        {
            "anyOf": [
                _OUTLINE,
                {
                    "type": "object",
                    "properties": {
                        "center": _VALUES | {"minItems": 2, "maxItems": 2},
                        "radius": _VALUE,
                    },
                    "required": ["center", "radius"],
                    "additionalProperties": False,
                },
            ]
        }
    ),
]
Named: Any = dict[str, Number]
Coordinates: Any = list[Number]
Places: Any = list[Place]
Cells: Any = list[list[Integer]]


class NodeChoice(Record):
    """Nodes by name, optionally selected by position."""

    nodes: NodeNames = Field(
        description="a node, a mesh, a group of a mesh as mesh.group, or a list of these"
    )
    where: Named = Field(default=None, description="nodes at x, y, z [m]")
    nearest: Coordinates = Field(default=None, description="node nearest to a position [m]")


class ElementChoice(Record):
    """Elements and meshes by name."""

    elements: NodeNames = Field(description="an element, a mesh, or a list of these")


class Acceleration(Record):
    """A field of gravity that loads all masses."""

    acceleration: Place = Field(description="along x, y, z [m/s²]")
    case: Text = Field(default="", description="name of the load case")


def _with_directions(
    name: str, doc: str, prefixes: dict[str, str], base: type[Record] = NodeChoice, **more: Any
) -> Any:
    keys: dict[str, Any] = dict(more)
    for key, text in prefixes.items():
        keys[key] = (Entry, Field(default=None, description=text))
    return create_model(name, __base__=base, __doc__=doc, **keys)


DISPLACEMENTS = {d: f"displacement along {d[1]} [m]" for d in TRANSLATIONS} | {
    d: f"rotation about {d[1]} [rad]" for d in ROTATION_NAMES
}
FORCES = {d.replace("u", "f", 1): f"force along {d[1]} [N]" for d in TRANSLATIONS} | {
    d.replace("r", "m", 1): f"moment about {d[1]} [N m]" for d in ROTATION_NAMES
}
VELOCITIES = {d.replace("u", "v", 1): f"velocity along {d[1]} [m/s]" for d in TRANSLATIONS} | {
    f"v{d}": f"angular velocity about {d[1]} [rad/s]" for d in ROTATION_NAMES
}
LINE_FORCES = {f"q{x}": f"force per length along {x} [N/m]" for x in "xyz"}
TEMPERATURES = {"temperature": "change [K]"} | {
    f"temperature_gradient{end}": "rise across a beam [K/m]" for end in ("", "_y", "_z")
}
TRACTIONS = {f"t{x}": f"traction along {x} [Pa]" for x in "xyz"} | {
    "pressure": "against the material [Pa]"
}
CASE: Any = (Text, Field(default="", description="name of the load case"))

SupportTable = _with_directions(
    "Support", "Prescribed displacements; without any, all are zero.", DISPLACEMENTS
)
LoadTable = _with_directions(
    "Load",
    "Forces and moments on each of some nodes.",
    FORCES,
    case=CASE,
    fixed_axes=(
        Flag,
        Field(
            default=False,
            description="moments in space act about fixed axes, as they do in mechanisms",
        ),
    ),
)
LineLoadTable = _with_directions(
    "LineLoad", "Forces per length on bars and beams.", LINE_FORCES, ElementChoice, case=CASE
)
TemperatureTable = _with_directions(
    "Temperature",
    "Changes of temperature of elements, in addition to their own.",
    TEMPERATURES,
    ElementChoice,
    case=CASE,
)
TractionTable = _with_directions(
    "Traction",
    "A traction on the edges or faces of a mesh all of whose nodes are selected.",
    TRACTIONS,
    elements=(Text, Field(description="name of the mesh")),
    case=CASE,
)
InitialTable = _with_directions(
    "Initial", "Motion at the beginning of a transient.", DISPLACEMENTS | VELOCITIES
)


class RectangleTable(Record):
    """A rectangle from the origin, divided evenly."""

    size: list_of(Number, 2, "lengths along x, y") = Field(description="lengths [m]")  # type: ignore[valid-type]
    counts: list_of(Integer, 2, "cells along x, y") = Field(description="numbers of cells")  # type: ignore[valid-type]


class BoxTable(Record):
    """A box from the origin, divided evenly into hexahedra."""

    size: list_of(Number, 3, "lengths along x, y, z") = Field(description="lengths [m]")  # type: ignore[valid-type]
    counts: list_of(Integer, 3, "cells along x, y, z") = Field(description="numbers of cells")  # type: ignore[valid-type]


class LineTable(Record):
    """A straight line, divided evenly."""

    start: list[Number] = Field(description="position of the first node [m]")
    end: list[Number] = Field(description="position of the last node [m]")
    count: Integer = Field(description="number of lines")


def _hole(value: Any) -> Any:
    if isinstance(value, dict):
        return CircleTable.model_validate(value)
    return [_vertex(place) for place in _listed(value)]


def _vertex(value: Any) -> list[float | str]:
    if not isinstance(value, list) or len(value) != 2:
        raise ValueError(f"expected two coordinates, got {short_repr(value)}")
    return [number_or_formula(v) for v in value]


def _listed(value: Any) -> list[Any]:
    if not isinstance(value, list) or len(value) < 3:
        raise ValueError(f"expected at least three vertices, got {short_repr(value)}")
    return value


class CircleTable(Record):
    """A circular hole."""

    center: Vertex = Field(description="place of the centre [m]")
    radius: Entry = Field(description="[m]")


class PolygonTable(Record):
    """A region with a polygonal outline and holes, divided into triangles."""

    vertices: Outline = Field(description="places of the vertices of the outline, in order [m]")
    size: Number = Field(description="length of the edges of triangles [m]")
    holes: list[Hole] = Field(
        default=[], description="lists of vertices, or circles with center and radius [m]"
    )


class MeshSource(Record):
    """Source of the points and cells of a mesh; exactly one is given."""

    file: Text = Field(
        default=None, description="mesh file in the folder of the model, in a format of meshio"
    )
    points: Places = Field(default=None, description="positions of the nodes [m], with cells")
    cells: Cells = Field(default=None, description="numbers of the nodes of each element, from 0")
    rectangle: RectangleTable = None  # type: ignore[assignment]
    box: BoxTable = None  # type: ignore[assignment]
    line: LineTable = None  # type: ignore[assignment]
    polygon: PolygonTable = None  # type: ignore[assignment]


def element_table(name: str, cls: type[StructuralElement]) -> type[BaseModel]:
    """The table of one element."""
    nodes = list_of(Text, cls.node_count, "names of nodes")
    connect = (nodes, Field(description="its nodes, in order"))
    return _table(name, name, cls, Record, connect=connect)


def mesh_table(name: str, cls: type[StructuralElement]) -> type[BaseModel]:
    """The table of a mesh whose cells become elements of one class."""
    return _table(f"{name}Mesh", name, cls, MeshSource, many=True)


def _table(
    title: str, name: str, cls: Any, base: type, many: bool = False, **more: Any
) -> type[BaseModel]:
    keys: dict[str, Any] = {"type": (Literal[name], ...), **more}  # type: ignore[valid-type]
    for field in keyed_fields(cls):
        kind = ValuesByGroup if many and field.holds is Quantity else value_type(field)
        default = ... if field.is_needed else None
        keys[field.name] = (kind, Field(default, description=about_field(field)))
    return create_model(title, __base__=base, __doc__=summary_of(cls), **keys)


ELEMENT = one_of({name: partial(element_table, name, cls) for name, cls in ELEMENTS.items()})
"""Any finite element between nodes."""
MESH = one_of({name: partial(mesh_table, name, cls) for name, cls in ELEMENTS.items()})
"""Any mesh."""
