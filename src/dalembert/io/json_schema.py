"""JSON Schema of model files, of mechanisms and structures alike."""

from __future__ import annotations

from typing import Any

from pydantic.json_schema import models_json_schema

from dalembert.io.model_file import DOCUMENTS
from dalembert.io.schema import Document
from dalembert.io.structure_schema import StructureDocument


def json_schema(kind: str | None = None) -> dict[str, Any]:
    """JSON Schema (2020-12) of model files, for editors and other programs.

    Parameters
    ----------
    kind : ``"mechanism"`` or ``"structure"``; both by default, told apart by their ``kind``
    """
    made: dict[str, Any]
    if kind is not None:
        made = DOCUMENTS[kind].model_json_schema()
    else:
        models = [(model, "validation") for model in DOCUMENTS.values()]
        _, made = models_json_schema(models, title="Model file of dalembert")  # type: ignore[arg-type]
        structure = {"properties": {"kind": {"const": "structure"}}, "required": ["kind"]}
        made |= {"if": structure, "then": _reference(StructureDocument)}
        made["else"] = _reference(Document)
    _drop_null_defaults(made)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **made}


def _reference(model: type) -> dict[str, str]:
    return {"$ref": f"#/$defs/{model.__name__}"}


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
