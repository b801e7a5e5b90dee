"""Schema of the model files of structures."""

from __future__ import annotations

from functools import partial
from typing import Literal

from pydantic import Field

from dalembert.io.choices import one_of
from dalembert.io.decisions.task_tables import StructureReportTable
from dalembert.io.schema import CASE, CaseTable, ModelDocument, any_of
from dalembert.io.strategies import RESPONSES, STRUCTURAL_ANALYSES
from dalembert.io.structures.structure_tables import (
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
from dalembert.io.tables import table_of

_ANALYSIS = any_of(STRUCTURAL_ANALYSES)
_FINAL = partial(
    table_of, "Final", RESPONSES["Final"], optional_type=True, title="StructuralFinal", more=CASE
)
_RESPONSE = one_of(
    {
        n: _FINAL if n == "Final" else partial(table_of, n, c, more=CASE)
        for n, c in RESPONSES.items()
    },
    default="Final",
)


class StructuralCaseTable(CaseTable):
    """Another load case of a design: a run of this structure, or of a model in another file."""

    analysis: _ANALYSIS = Field(  # type: ignore[valid-type]
        default=None, description="another analysis of this structure, as `[analysis]`"
    )


class StructureDocument(ModelDocument):
    """A model file of dalembert: a structure and its tasks."""

    sections = ("parameters", "tables", "nodes", "elements", "meshes")
    analyses = STRUCTURAL_ANALYSES
    usual_analysis = "Statics"

    kind: Literal["structure"]
    nodes: dict[str, Place] = Field(default_factory=dict, description="name → coordinates [m]")
    elements: dict[str, ELEMENT] = Field(default_factory=dict)  # type: ignore[valid-type]
    meshes: dict[str, MESH] = Field(default_factory=dict)  # type: ignore[valid-type]
    supports: list[SupportTable] = Field(default_factory=list)  # type: ignore[valid-type]
    loads: list[LoadTable] = Field(default_factory=list)  # type: ignore[valid-type]
    gravity: list[Acceleration] = Field(default_factory=list)
    line_loads: list[LineLoadTable] = Field(default_factory=list)  # type: ignore[valid-type]
    temperatures: list[TemperatureTable] = Field(default_factory=list)  # type: ignore[valid-type]
    tractions: list[TractionTable] = Field(default_factory=list)  # type: ignore[valid-type]
    initial: list[InitialTable] = Field(default_factory=list)  # type: ignore[valid-type]
    analysis: _ANALYSIS = None  # type: ignore[valid-type]
    cases: dict[str, StructuralCaseTable] = Field(default_factory=dict)
    responses: dict[str, _RESPONSE] = Field(default_factory=dict)  # type: ignore[valid-type]
    report: StructureReportTable = Field(default_factory=StructureReportTable)
