"""Schema of model files (TOML or JSON), which mirrors the Python names."""

from __future__ import annotations

from functools import cache, partial
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field, PlainValidator, WithJsonSchema, create_model

from dalembert.elements.registry import SPACES, Space
from dalembert.io.choices import Record, one_of, table_or
from dalembert.io.curve_tables import CurveTable
from dalembert.io.decisions.design_tables import (
    RANDOM,
    CombinedTable,
    OptimizeTable,
    ParetoTable,
    ReliabilityTable,
    RobustTable,
    SynthesisTable,
    ToleranceTable,
)
from dalembert.io.decisions.task_tables import (
    CompareTable,
    HistoryTable,
    IdentifyTable,
    InvertTable,
    ReportTable,
    SensitivityTable,
    SweepTable,
    TrajectoryTable,
)
from dalembert.io.orientations import FrameTable
from dalembert.io.strategies import ANALYSES, RESPONSES
from dalembert.io.structures.structure_tables import ELEMENT, MESH, NodalLoadTable, SupportTable
from dalembert.io.tables import any_of, point_type, table_of
from dalembert.io.values import Entry, OwnBound, OwnNumber, Text, list_of, short_repr

FORMAT = 1


def _format(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"expected format = {FORMAT}, got {short_repr(value)}")
    if value != FORMAT:
        cure = "update dalembert to read it" if value > FORMAT else f"write format = {FORMAT}"
        raise ValueError(f"format {value} is unknown, this version reads {FORMAT}; {cure}")
    return value


class ParameterTable(Record):
    """A number that runs and designs may change."""

    value: OwnNumber
    unit: Text = ""
    bounds: list_of(OwnBound, 2, "lower, upper") = None  # type: ignore[valid-type]
    description: Text = ""


class DerivedTable(Record):
    """A formula of parameters under a name."""

    formula: Entry
    unit: Text = ""
    description: Text = ""


class GroundTable(Record):
    """Named points [m] and frames of the ground."""

    points: dict[str, Any] = Field(default_factory=dict)
    frames: dict[str, FrameTable] = Field(default_factory=dict)


_PARAMETER = table_or(ParameterTable, OwnNumber)
_DERIVED = table_or(DerivedTable, Entry)


def _combined(value: Any) -> CombinedTable:
    return value if isinstance(value, CombinedTable) else CombinedTable(formula=value)


_COMBINED = Annotated[table_or(CombinedTable, Text), AfterValidator(_combined)]  # type: ignore[valid-type]
CASE: dict[str, Any] = {
    "case": (
        Text,
        Field(default=None, description="name of a case; of the run of this file by default"),
    )
}
"""Key of a response: the case that it belongs to."""
_ANALYSIS = any_of(ANALYSES)
_RESPONSE = one_of({n: partial(table_of, n, cls, more=CASE) for n, cls in RESPONSES.items()})


class CaseTable(Record):
    """Another load case of a design: a run of this model, or of the model in another file."""

    model: Text = Field(
        default=None, description="model file in the same folder, with its own `[analysis]`"
    )
    analysis: _ANALYSIS = Field(  # type: ignore[valid-type]
        default=None, description="another analysis of this model, as `[analysis]`"
    )
    inputs: dict[str, Text] = Field(
        default_factory=dict,
        description="parameter of that model → name of a response of this file, its value",
    )


class ModelDocument(Record):
    """Keys of every model file."""

    sections: ClassVar[tuple[str, ...]]
    """Tables whose entries share one namespace."""
    analyses: ClassVar[dict[str, type]]
    """Name → analysis available to the file."""
    usual_analysis: ClassVar[str | None] = None
    """Default analysis."""

    schema_location: Text = Field(default=None, alias="$schema", description="for editors")
    format: Annotated[int, PlainValidator(_format), WithJsonSchema({"const": FORMAT})]
    name: Text = Field(default=None, description="name of the model; the file name by default")
    description: Text = ""
    parameters: dict[str, _PARAMETER] = Field(default_factory=dict)  # type: ignore[valid-type]
    tables: dict[str, CurveTable] = Field(
        default_factory=dict, description="interpolated functions"
    )
    sensitivity: SensitivityTable = Field(default_factory=SensitivityTable)
    combined: dict[str, _COMBINED] = Field(default_factory=dict)  # type: ignore[valid-type]
    robust: dict[str, RobustTable] = Field(default_factory=dict)
    optimize: OptimizeTable = None  # type: ignore[assignment]
    pareto: ParetoTable = None  # type: ignore[assignment]
    random: list[RANDOM] = Field(default_factory=list)  # type: ignore[valid-type]
    reliability: ReliabilityTable = None  # type: ignore[assignment]
    tolerance: ToleranceTable = None  # type: ignore[assignment]
    identify: IdentifyTable = None  # type: ignore[assignment]
    sweep: SweepTable = None  # type: ignore[assignment]


class Document(ModelDocument):
    """A model file of dalembert: a mechanism and its tasks."""

    sections = (
        *("parameters", "tables", "derived", "histories", "bodies", "beams", "elements", "meshes"),
        *("joints", "drivers", "forces"),
    )
    analyses = ANALYSES
    space: ClassVar[Space]
    """Default space of its elements."""

    kind: Literal["mechanism"] = Field(
        default="mechanism", description='"mechanism"; a structure has tables of its own'
    )
    dimension: int = Field(
        default=2, description="number of coordinates of points; 2 for planar mechanisms"
    )
    gravity: list[Any] | None = Field(
        default=None, description="acceleration of gravity [m/s^2]; none by default"
    )
    derived: dict[str, _DERIVED] = Field(default_factory=dict)  # type: ignore[valid-type]
    histories: dict[str, HistoryTable] = Field(
        default_factory=dict, description="unknown functions of time, by name"
    )
    ground: GroundTable = Field(default_factory=GroundTable)
    bodies: dict[str, Any] = Field(default_factory=dict)
    beams: dict[str, Any] = Field(default_factory=dict)
    elements: dict[str, ELEMENT] = Field(  # type: ignore[valid-type]
        default_factory=dict, description="finite elements between nodes"
    )
    meshes: dict[str, MESH] = Field(  # type: ignore[valid-type]
        default_factory=dict, description="finite elements, every node of which is a body"
    )
    supports: list[SupportTable] = Field(  # type: ignore[valid-type]
        default_factory=list, description="prescribed displacements of nodes"
    )
    loads: list[NodalLoadTable] = Field(  # type: ignore[valid-type]
        default_factory=list, description="forces and moments on nodes"
    )
    joints: dict[str, Any] = Field(default_factory=dict)
    drivers: dict[str, Any] = Field(default_factory=dict)
    forces: dict[str, Any] = Field(default_factory=dict)
    initial: dict[str, Entry] = Field(
        default_factory=dict, description="exact initial values of measures"
    )
    analysis: _ANALYSIS = None  # type: ignore[valid-type]
    responses: dict[str, _RESPONSE] = Field(default_factory=dict)  # type: ignore[valid-type]
    cases: dict[str, CaseTable] = Field(default_factory=dict)
    invert: InvertTable = None  # type: ignore[assignment]
    synthesis: SynthesisTable = None  # type: ignore[assignment]
    trajectory: TrajectoryTable = None  # type: ignore[assignment]
    compare: CompareTable = Field(default_factory=CompareTable)
    report: ReportTable = Field(default_factory=ReportTable)


def element_of(space: Space, section: str) -> Any:
    """Type of an element of one section; elements of another space are ``planar.Revolute``.

    Bodies are rigid bodies, and beams are beams, unless they state a type.
    """
    usual = {"bodies": "Body", "beams": "Beam"}.get(section)
    tables = {
        name: partial(
            table_of,
            name,
            cls,
            optional_type=name == usual,
            dimension=space.dimension,
            also=f"{space.name}.{name}",
            title=f"{space.name.title()}{name}",
        )
        for name, cls in space.sections[section].items()
    }
    for other in SPACES.values():
        if other is not space:
            for name, cls in other.sections[section].items():
                full = f"{other.name}.{name}"
                title = f"{other.name.title()}{name}In{space.name.title()}Document"
                tables[full] = partial(table_of, full, cls, dimension=other.dimension, title=title)
    return one_of(tables, default=usual, prefix=f"{space.name}.")


@cache
def document_of(dimension: int) -> type[Document]:
    """Document type of a mechanism whose elements are in one space by default."""
    space = SPACES[dimension]
    point = point_type(space.dimension)
    points: Any = (dict[str, point], Field(default_factory=dict))  # type: ignore[valid-type]
    ground = create_model(
        f"{space.name.title()}GroundTable",
        __base__=GroundTable,
        __doc__=GroundTable.__doc__,
        points=points,
    )
    types: dict[str, Any] = {"gravity": point, "ground": ground}
    for section in space.sections:
        types[section] = dict[str, element_of(space, section)]  # type: ignore[misc]
    fields: dict[str, Any] = {n: (kind, Document.model_fields[n]) for n, kind in types.items()}
    about = Document.model_fields["dimension"].description
    own = Field(default=space.dimension, description=about)
    fields["dimension"] = (Literal[space.dimension], own)
    name = f"{space.name.title()}Document"
    document = create_model(name, __base__=Document, __doc__=Document.__doc__, **fields)
    document.space = space
    return document
