"""JSON Schema of model files of mechanisms and structures."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from dalembert.elements.registry import SPACES
from dalembert.io.documents import Document, StructureDocument, document_of


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
