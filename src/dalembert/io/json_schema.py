"""JSON Schema of model files, of mechanisms and structures alike."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from dalembert.elements.registry import SPACES
from dalembert.io.schema import Document, document_of
from dalembert.io.structures.schema import StructureDocument


def json_schema(kind: str | None = None) -> dict[str, Any]:
    """JSON Schema (2020-12) of model files, for editors and other programs.

    Parameters
    ----------
    kind : ``"mechanism"`` or ``"structure"``; both by default, told apart by their ``kind``
    """
    models: list[type[BaseModel]] = []
    if kind != "structure":
        models += map(document_of, SPACES)
    if kind != "mechanism":
        models.append(StructureDocument)
    made = models[0].model_json_schema() if len(models) == 1 else _one_of(models)
    _drop_null_defaults(made)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **made}


def _one_of(models: list[type[BaseModel]]) -> dict[str, Any]:
    """The schema of a file of any kind; one that says nothing is the first."""
    wanted = [(model, "validation") for model in models]
    references, made = models_json_schema(wanted, title="Model file of dalembert")  # type: ignore[arg-type]
    chosen: dict[str, Any] = references[models[0], "validation"]
    for model in models[1:]:
        chosen = {"if": _signs(model), "then": references[model, "validation"], "else": chosen}
    return made | chosen


def _signs(model: type[BaseModel]) -> dict[str, Any]:
    """What tells a file of this kind: its ``kind``, or its ``dimension``, or its gravity."""
    if not issubclass(model, Document):
        return {"properties": {"kind": {"const": "structure"}}, "required": ["kind"]}
    size = model.space.dimension
    said = {"properties": {"dimension": {"const": size}}, "required": ["dimension"]}
    meant = {"properties": {"gravity": {"minItems": size}}, "required": ["gravity"]}
    return {"anyOf": [said, {"not": {"required": ["dimension"]}, **meant}]}


def _drop_null_defaults(node: Any) -> None:
    """A missing key is missing; null is not a value of this format."""
    if isinstance(node, dict):
        if "default" in node and node["default"] is None:
            del node["default"]
        for child in node.values():
            _drop_null_defaults(child)
    elif isinstance(node, list):
        for child in node:
            _drop_null_defaults(child)
