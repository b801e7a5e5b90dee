"""Keys of every model file (TOML or JSON), which mirror the Python names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, Field, PlainValidator, WithJsonSchema

from dalembert.io.choices import Record, table_or, tables_or
from dalembert.io.curve_tables import CurveTable
from dalembert.io.decisions.design_tables import (
    RANDOM,
    CombinedTable,
    OptimizeTable,
    ParetoTable,
    ReliabilityTable,
    RobustTable,
    ToleranceTable,
)
from dalembert.io.decisions.task_tables import IdentifyTable, SensitivityTable, SweepTable
from dalembert.io.finite_element_tables import (
    ELEMENT,
    MESH,
    Acceleration,
    InitialTable,
    LineLoadTable,
    LoadTable,
    Place,
    SupportTable,
    TemperatureTable,
    TractionTable,
)
from dalembert.io.values import Entry, OwnBound, OwnNumber, Text, list_of, short_repr
from dalembert.model.system import System

FORMAT = 1


def _format(value: object) -> int:
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


class InputTable(Record):
    """A quantity that acts on the model from outside."""

    value: Entry = Field(
        default=0.0, description="number, or formula of t, parameters and tables, in SI units"
    )
    unit: Text = ""
    bounds: list_of(OwnBound, 2, "lower, upper") = None  # type: ignore[valid-type]
    description: Text = ""


class OutputTable(Record):
    """A formula of measures under a name."""

    formula: Text
    unit: Text = ""
    description: Text = ""


_PARAMETER = table_or(ParameterTable, OwnNumber)
_DERIVED = table_or(DerivedTable, Entry)
_INPUT = table_or(InputTable, Entry)
_OUTPUT = table_or(OutputTable, Text)


def _combined(value: object) -> CombinedTable:
    return value if isinstance(value, CombinedTable) else CombinedTable(formula=value)


_COMBINED = Annotated[table_or(CombinedTable, Text), AfterValidator(_combined)]  # type: ignore[valid-type]


def gravity_type(vector: Any) -> Any:
    """Type of gravity: a vector, or a table for each load case."""
    return tables_or(Acceleration, vector)


class ModelDocument(Record):
    """Keys of every model file.

    A new section is a field here, or in a subclass for one kind of model, and a reader in
    ``Builder``.
    """

    sections: ClassVar[tuple[str, ...]]
    """Tables whose entries share one namespace."""
    analyses: ClassVar[Mapping[str, type]]
    """Name → analysis available to the file."""
    usual_analysis: ClassVar[str | None] = None
    """Default analysis."""
    builder: ClassVar[type[System]]
    """Builder of its model."""

    schema_location: Text = Field(default=None, alias="$schema", description="for editors")
    format: Annotated[int, PlainValidator(_format), WithJsonSchema({"const": FORMAT})]
    name: Text = Field(default=None, description="name of the model; the file name by default")
    description: Text = ""
    parameters: dict[str, _PARAMETER] = Field(default_factory=dict)  # type: ignore[valid-type]
    derived: dict[str, _DERIVED] = Field(default_factory=dict)  # type: ignore[valid-type]
    tables: dict[str, CurveTable] = Field(
        default_factory=dict, description="interpolated functions"
    )
    inputs: dict[str, _INPUT] = Field(  # type: ignore[valid-type]
        default_factory=dict, description="quantities that act on the model from outside"
    )
    outputs: dict[str, _OUTPUT] = Field(  # type: ignore[valid-type]
        default_factory=dict, description="formulas of measures, by name"
    )
    gravity: gravity_type(Place) = Field(  # type: ignore[valid-type]
        default=None,
        description="acceleration of gravity [m/s^2], or a table for each load case of a "
        "structure; none by default",
    )
    nodes: dict[str, Place] = Field(
        default_factory=dict, description="nodes of finite elements: name → coordinates [m]"
    )
    elements: dict[str, ELEMENT] = Field(  # type: ignore[valid-type]
        default_factory=dict, description="finite elements between nodes"
    )
    meshes: dict[str, MESH] = Field(  # type: ignore[valid-type]
        default_factory=dict, description="meshes of finite elements, with their nodes"
    )
    supports: list[SupportTable] = Field(  # type: ignore[valid-type]
        default_factory=list, description="prescribed displacements of nodes"
    )
    loads: list[LoadTable] = Field(  # type: ignore[valid-type]
        default_factory=list, description="forces and moments on nodes"
    )
    line_loads: list[LineLoadTable] = Field(  # type: ignore[valid-type]
        default_factory=list, description="forces per length on bars and beams"
    )
    temperatures: list[TemperatureTable] = Field(  # type: ignore[valid-type]
        default_factory=list, description="changes of temperature of elements"
    )
    tractions: list[TractionTable] = Field(  # type: ignore[valid-type]
        default_factory=list, description="tractions on edges and faces of meshes"
    )
    initial: tables_or(InitialTable, dict[str, Entry]) = Field(  # type: ignore[valid-type]
        default_factory=dict,
        description="exact initial values of measures; or tables of motions of nodes",
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
