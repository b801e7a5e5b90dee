"""Model files of mechanisms and structures, and their JSON Schema."""

from __future__ import annotations

from functools import cache, partial
from typing import Any, ClassVar, Literal

from pydantic import BaseModel, Field, create_model
from pydantic.json_schema import models_json_schema

from dalembert.elements.registry import BLOCKS, SPACES, Space
from dalembert.io.choices import Record, one_of
from dalembert.io.decisions.design_tables import SynthesisTable
from dalembert.io.decisions.task_tables import (
    CompareTable,
    HistoryTable,
    InvertTable,
    ReportTable,
    StructureReportTable,
    TrajectoryTable,
)
from dalembert.io.orientations import FrameTable
from dalembert.io.schema import ModelDocument, gravity_type
from dalembert.io.strategies import ANALYSES, RESPONSES, STRUCTURAL_ANALYSES
from dalembert.io.tables import any_of, point_type, table_of
from dalembert.io.values import Text
from dalembert.model.structure import Structure
from dalembert.model.system import System


class GroundTable(Record):
    """Named points [m] and frames of the ground."""

    points: dict[str, Any] = Field(default_factory=dict)
    frames: dict[str, FrameTable] = Field(default_factory=dict)


CASE: dict[str, Any] = {
    "case": (
        Text,
        Field(default=None, description="name of a case; of the run of this file by default"),
    )
}
"""Key of a response: the case that it belongs to."""
_ANALYSIS = any_of(
    ANALYSES, {n: "for structures" for n in STRUCTURAL_ANALYSES if n not in ANALYSES}
)
_RESPONSE = one_of({n: partial(table_of, n, cls, more=CASE) for n, cls in RESPONSES.items()})
_STRUCTURAL_ANALYSIS = any_of(
    STRUCTURAL_ANALYSES, {n: "for mechanisms" for n in ANALYSES if n not in STRUCTURAL_ANALYSES}
)
_FINAL = partial(
    table_of, "Final", RESPONSES["Final"], optional_type=True, title="StructuralFinal", more=CASE
)
_BLOCK = any_of(BLOCKS)
_STRUCTURAL_RESPONSE = one_of(
    {
        n: _FINAL if n == "Final" else partial(table_of, n, c, more=CASE)
        for n, c in RESPONSES.items()
    },
    default="Final",
)


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


class StructuralCaseTable(CaseTable):
    """Another load case of a design: a run of this structure, or of a model in another file."""

    analysis: _STRUCTURAL_ANALYSIS = Field(  # type: ignore[valid-type]
        default=None, description="another analysis of this structure, as `[analysis]`"
    )


class Document(ModelDocument):
    """A model file of dalembert: a mechanism and its tasks."""

    sections = (
        *("parameters", "tables", "derived", "inputs", "outputs", "histories", "nodes", "bodies"),
        *("beams", "elements", "meshes", "blocks", "joints", "drivers", "forces"),
    )
    analyses = ANALYSES
    builder = System
    space: ClassVar[Space]
    """Default space of its elements."""

    kind: Literal["mechanism"] = Field(
        default="mechanism", description='"mechanism"; a structure has tables of its own'
    )
    dimension: int = Field(
        default=2, description="number of coordinates of points; 2 for planar mechanisms"
    )
    histories: dict[str, HistoryTable] = Field(
        default_factory=dict, description="unknown functions of time, by name"
    )
    ground: GroundTable = Field(default_factory=GroundTable)
    bodies: dict[str, Any] = Field(default_factory=dict)
    beams: dict[str, Any] = Field(default_factory=dict)
    joints: dict[str, Any] = Field(default_factory=dict)
    drivers: dict[str, Any] = Field(default_factory=dict)
    forces: dict[str, Any] = Field(default_factory=dict)
    blocks: dict[str, _BLOCK] = Field(  # type: ignore[valid-type]
        default_factory=dict, description="states of first order and controllers, by name"
    )
    analysis: _ANALYSIS = None  # type: ignore[valid-type]
    responses: dict[str, _RESPONSE] = Field(default_factory=dict)  # type: ignore[valid-type]
    cases: dict[str, CaseTable] = Field(default_factory=dict)
    invert: InvertTable = None  # type: ignore[assignment]
    synthesis: SynthesisTable = None  # type: ignore[assignment]
    trajectory: TrajectoryTable = None  # type: ignore[assignment]
    compare: CompareTable = Field(default_factory=CompareTable)
    report: ReportTable = Field(default_factory=ReportTable)


class StructureDocument(ModelDocument):
    """A model file of dalembert: a structure and its tasks."""

    sections = (
        *("parameters", "tables", "derived", "inputs", "outputs", "nodes", "elements", "meshes"),
    )
    analyses = STRUCTURAL_ANALYSES
    usual_analysis = "Statics"
    builder = Structure

    kind: Literal["structure"]
    analysis: _STRUCTURAL_ANALYSIS = None  # type: ignore[valid-type]
    cases: dict[str, StructuralCaseTable] = Field(default_factory=dict)
    responses: dict[str, _STRUCTURAL_RESPONSE] = Field(default_factory=dict)  # type: ignore[valid-type]
    report: StructureReportTable = Field(default_factory=StructureReportTable)


StructureDocument.misplaced = {
    key: 'is for mechanisms, and this is a structure; omit it, or kind = "structure"'
    for key in Document.model_fields
    if key not in StructureDocument.model_fields
}


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
    types: dict[str, Any] = {"ground": ground}
    for section in space.sections:
        types[section] = dict[str, element_of(space, section)]  # type: ignore[misc]
    fields: dict[str, Any] = {n: (kind, Document.model_fields[n]) for n, kind in types.items()}
    fields["dimension"] = (Literal[space.dimension], _again("dimension", space.dimension))
    fields["gravity"] = (gravity_type(point), _again("gravity"))
    name = f"{space.name.title()}Document"
    document = create_model(name, __base__=Document, __doc__=Document.__doc__, **fields)
    document.space = space
    return document


def _again(name: str, default: Any = None) -> Any:
    """Field of a document with another type or default."""
    return Field(default=default, description=Document.model_fields[name].description)


def json_schema(kind: str | None = None) -> dict[str, Any]:
    """JSON Schema (2020-12) of model files, for editors and other programs.

    Parameters
    ----------
    kind : ``"mechanism"`` or ``"structure"``; both by default, distinguished by their ``kind``
    """
    models: list[type[BaseModel]] = []
    if kind != "structure":
        models += map(document_of, SPACES)
    if kind != "mechanism":
        models.append(StructureDocument)
    schema = models[0].model_json_schema() if len(models) == 1 else _one_of(models)
    _drop_null_defaults(schema)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _one_of(models: list[type[BaseModel]]) -> dict[str, Any]:
    """Schema of a file of any kind; the first one applies if the file states no kind."""
    modes = [(model, "validation") for model in models]
    references, schema = models_json_schema(modes, title="Model file of dalembert")  # type: ignore[arg-type]
    branch: dict[str, Any] = references[models[0], "validation"]
    for model in models[1:]:
        branch = {"if": _condition(model), "then": references[model, "validation"], "else": branch}
    return schema | branch


def _condition(model: type[BaseModel]) -> dict[str, Any]:
    """Condition that selects a kind of file: its ``kind``, ``dimension`` or gravity."""
    if not issubclass(model, Document):
        return {"properties": {"kind": {"const": "structure"}}, "required": ["kind"]}
    size = model.space.dimension
    declared = {"properties": {"dimension": {"const": size}}, "required": ["dimension"]}
    vector = {"minItems": size, "items": {"not": {"type": "object"}}}
    implied = {"properties": {"gravity": vector}, "required": ["gravity"]}
    return {"anyOf": [declared, {"not": {"required": ["dimension"]}, **implied}]}


def _drop_null_defaults(node: object) -> None:
    """Remove null defaults, because null is not a value of this format."""
    if isinstance(node, dict):
        if "default" in node and node["default"] is None:
            del node["default"]
        for child in node.values():
            _drop_null_defaults(child)
    elif isinstance(node, list):
        for child in node:
            _drop_null_defaults(child)
