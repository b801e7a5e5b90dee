"""The schema of model files of structures, which mirrors the Python names too."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from dalembert.io.choices import one_of
from dalembert.io.schema import ModelDocument, any_of
from dalembert.io.strategies import RESPONSES, STRUCTURAL_ANALYSES
from dalembert.io.structure_tables import (
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
_FINAL = table_of("Final", RESPONSES["Final"], optional_type=True, title="StructuralFinal")
_RESPONSE = one_of(
    {n: _FINAL if n == "Final" else table_of(n, c) for n, c in RESPONSES.items()}, default="Final"
)


class StructureDocument(ModelDocument):
    """A model file of dalembert: a structure, and what is to be computed on it."""

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
    responses: dict[str, _RESPONSE] = Field(default_factory=dict)  # type: ignore[valid-type]
