"""Interfaces of flexible bodies: node names, listed or grouped by section name."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import PlainValidator, WithJsonSchema

from dalembert.io.values import short_repr

_NAMES = {"type": "array", "items": {"type": "string"}, "minItems": 1}


def _interfaces(value: Any) -> Any:
    chosen = list(value.values()) if isinstance(value, dict) else value
    if not isinstance(chosen, list) or not chosen:
        got = "none" if value == {} else short_repr(value)
        raise ValueError(f"expected names of nodes, or a table of them, got {got}")
    for nodes in chosen:
        names = nodes if isinstance(nodes, list) and isinstance(value, dict) else [nodes]
        if not names or not all(isinstance(name, str) for name in names):
            raise ValueError(
                f"expected the name of nodes, or a list of names, got {short_repr(nodes)}"
            )
    return value


InterfacesType = Annotated[
    Any,
    PlainValidator(_interfaces),
    WithJsonSchema(
        {
            "anyOf": [
                _NAMES,
                {
                    "type": "object",
                    "additionalProperties": {"anyOf": [{"type": "string"}, _NAMES]},
                    "minProperties": 1,
                },
            ]
        }
    ),
]
