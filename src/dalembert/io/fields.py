"""What a field of a registered class holds, told from its metadata and annotation.

The schema and the builder both ask here, so that a file is accepted exactly when it can be built.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

REFERENCES = {
    "Point": "point",
    "Body": "body",
    "Constraint": "joint",
    "Node": "node",
    "tuple[Node, ...]": "node",
}
BY_ANNOTATION = {
    "bool": "flag",
    "int": "integer",
    "float": "number",
    "str": "text",
    "object": "rows",
    "tuple[str, ...]": "names",
    "Coordinates": "coordinates",
    "Formulation": "formulation",
    "Stabilization": "stabilization",
    "Integrator": "integrator",
    "NewmarkFamily": "integrator",
    "Rayleigh": "damping",
    "StructuralResult": "state",
    "str | Expression": "measure",
    "str | Event": "event",
    "Measure": "measure",
    "Events": "events",
    "tuple[float, float]": "interval",
    "int | Sequence[float]": "count or times",
    "int | Sequence[float] | np.ndarray": "count or times",
}
ALWAYS_NEEDED = {"law", "terms", "factors", "curve", "measure", "event"}


def kind_of(field: dataclasses.Field) -> str:
    """One word for what the field holds.

    Raises
    ------
    TypeError
        A field that files cannot express: a slip in the class, not in a file.
    """
    if field.name == "points" and not field.metadata:
        return "points"
    kind = field.metadata.get("kind")
    if kind == "quantity":
        return "vector" if field.metadata["size"] > 1 else "quantity"
    if kind not in (None, "option"):
        return "body" if kind == "body" else str(kind)
    annotation = str(field.type).strip("'\"").removesuffix(" | None")
    if annotation in REFERENCES:
        return REFERENCES[annotation]
    if annotation in BY_ANNOTATION:
        return BY_ANNOTATION[annotation]
    if annotation.startswith("Callable["):
        return "function"  # only Python can give one
    raise TypeError(f"field {field.name!r}: no file form for the annotation {annotation!r}")


def connected(cls: type) -> list[dataclasses.Field]:
    """The bodies, points and nodes that ``connect`` lists, in order."""
    if not dataclasses.is_dataclass(cls):
        return []
    ties = ("point", "body", "node")
    return [f for f in dataclasses.fields(cls) if not f.metadata and kind_of(f) in ties]


def written(cls: type, hidden: frozenset[str] = frozenset({"name"})) -> list[dataclasses.Field]:
    """The fields that a file gives by their own key."""
    left_out = {f.name for f in connected(cls)} | hidden
    fields = [f for f in dataclasses.fields(cls) if f.name not in left_out]
    return [f for f in fields if kind_of(f) != "function"]


def is_needed(field: dataclasses.Field) -> bool:
    """The file must give it."""
    if kind_of(field) in ALWAYS_NEEDED:
        return True
    return field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING


def given_fields(
    cls: type, table: Any, located: Any, where: tuple[str, ...], value: Callable
) -> dict[str, Any]:
    """The fields that a table gives, as ``value(field, given, where)`` makes them."""
    made = {}
    for field in written(cls):
        if field.name in table.model_fields_set:
            here = (*where, field.name)
            with located(*here):
                made[field.name] = value(field, getattr(table, field.name), here)
    return made


FROM_FILE = {"Table": ("times", "values"), "SplineCurve": ("points",)}
"""Classes whose rows may come from a file of two columns, and the fields it fills."""
