"""Value types of model files: numbers, formulas, flags, texts and lists, each with its check."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pkgutil import resolve_name
from typing import Annotated, Any, TypeGuard

from pydantic import BeforeValidator, Field, PlainValidator, WithJsonSchema

from dalembert.errors import ExpressionError
from dalembert.text.wording import misspelt
from dalembert.units.measured import Measured, measured


def short_repr(value: object) -> str:
    """A value as it appears in messages, abbreviated."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "a table"
    return reprlib.repr(value)


def constant(value: object) -> float:
    """A finite number; a text is read as a formula of numbers alone, ``2*pi``, or with units.

    Raises
    ------
    ValueError
        Anything else.
    """
    if isinstance(value, str):
        try:
            value = measured(value)
        except ExpressionError as error:
            raise ValueError(f"{error.message}; a plain number is needed here") from None
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError(f"expected a number, got {short_repr(value)}")
    return _finite(value)


def in_own_unit(value: object) -> float | str:
    """A finite number, or a text with a number and a unit, which is returned unchanged."""
    number = constant(value)
    return value if isinstance(value, str) and isinstance(number, Measured) else number


def _finite(value: int | float) -> float:
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ValueError(f"{short_repr(value)} is not a finite number; give a finite one")
    return value if isinstance(value, Measured) else number


def number_or_formula(value: object) -> float | str:
    """A finite number, or the text of a formula (parsed when the model is built)."""
    if isinstance(value, str):
        if not value.strip():
            raise ValueError("the text is empty; write a number or a formula")
        return value
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError(f"expected a number or a formula, got {short_repr(value)}")
    return _finite(value)


def _bound(value: object) -> float | None:
    return value if _is_open(value) else constant(value)


def _own_bound(value: object) -> float | str | None:
    return value if _is_open(value) else in_own_unit(value)


def _number_or_bounds(value: object) -> float | list[float | None]:
    if not isinstance(value, list):
        return constant(value)
    if len(value) != 2:
        raise ValueError(f"expected a number or [lower, upper], got {len(value)} entries")
    return [_bound(side) for side in value]


def _is_open(value: object) -> TypeGuard[float | None]:
    return value is None or (isinstance(value, float) and math.isinf(value))


def _integer(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"expected a whole number, got {short_repr(value)}")
    if abs(value) > 10**12:
        raise ValueError("the number is too large")
    return value


def _count(value: object) -> int:
    number = _integer(value)
    if number < 1:
        raise ValueError(f"expected a whole number of at least 1, got {number}")
    return number


def _flag(value: object) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"expected true or false, got {short_repr(value)}")
    return value


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise ValueError(f"expected a text in quotes, got {short_repr(value)}")
    return value


def _count_or_times(value: object) -> int | list[float | str]:
    if isinstance(value, list):
        return [number_or_formula(item) for item in value]
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"expected a count or a list of times, got {short_repr(value)}")
    return _integer(value)


def _rows(value: object) -> list:
    if not isinstance(value, list):
        raise ValueError(f"expected a list of numbers, got {short_repr(value)}")
    return [
        [number_or_formula(x) for x in item] if isinstance(item, list) else number_or_formula(item)
        for item in value
    ]


_NUMBER_OR_TEXT: dict[str, Any] = {"type": ["number", "string"]}

Entry = Annotated[
    Any,
    PlainValidator(number_or_formula),
    WithJsonSchema({**_NUMBER_OR_TEXT, "description": "number or formula"}),
]
Number = Annotated[
    Any,
    PlainValidator(constant),
    WithJsonSchema(
        {**_NUMBER_OR_TEXT, "description": "number, or a formula of numbers and units: 2*pi, 45 mm"}
    ),
]
OwnNumber = Annotated[
    Any,
    PlainValidator(in_own_unit),
    WithJsonSchema({**_NUMBER_OR_TEXT, "description": "number, or a number with its unit: 45 mm"}),
]
Bound = Annotated[
    Any, PlainValidator(_bound), WithJsonSchema({"type": ["number", "string", "null"]})
]
OwnBound = Annotated[
    Any, PlainValidator(_own_bound), WithJsonSchema({"type": ["number", "string", "null"]})
]
NumberOrBounds = Annotated[
    Any,
    PlainValidator(_number_or_bounds),
    WithJsonSchema(
        {
            "anyOf": [
                _NUMBER_OR_TEXT,
                {
                    "type": "array",
                    "items": {"type": ["number", "string", "null"]},
                    "minItems": 2,
                    "maxItems": 2,
                },
            ]
        }
    ),
]
Integer = Annotated[Any, PlainValidator(_integer), WithJsonSchema({"type": "integer"})]
Count = Annotated[Any, PlainValidator(_count), WithJsonSchema({"type": "integer", "minimum": 1})]
Flag = Annotated[Any, PlainValidator(_flag), WithJsonSchema({"type": "boolean"})]
Text = Annotated[Any, PlainValidator(_text), WithJsonSchema({"type": "string"})]
CountOrTimes = Annotated[
    Any,
    PlainValidator(_count_or_times),
    WithJsonSchema({"anyOf": [{"type": "integer"}, {"type": "array", "items": _NUMBER_OR_TEXT}]}),
]
ListOfRows = Annotated[
    Any,
    PlainValidator(_rows),
    WithJsonSchema(
        {
            "type": "array",
            "items": {"anyOf": [_NUMBER_OR_TEXT, {"type": "array", "items": _NUMBER_OR_TEXT}]},
        }
    ),
]

_NODE_NAMES = {"type": "array", "items": {"type": "string"}, "minItems": 1}


def _interfaces(value: object) -> Any:
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
                _NODE_NAMES,
                {
                    "type": "object",
                    "additionalProperties": {"anyOf": [{"type": "string"}, _NODE_NAMES]},
                    "minProperties": 1,
                },
            ]
        }
    ),
]


@dataclass(frozen=True)
class JsonSchema:
    """JSON Schema of a type, created on request."""

    create: Callable[[], dict[str, Any]]

    def __get_pydantic_json_schema__(self, _: Any, __: Any) -> dict[str, Any]:
        return self.create()


def one_name(choices: str | Iterable[str]) -> Any:
    """Type of a text that is one of several names.

    ``choices`` lists the names, or is the dotted name of the list, which is imported on first use.
    """

    def names() -> list[str]:
        return list(resolve_name(choices) if isinstance(choices, str) else choices)

    def check(value: object) -> str:
        if not isinstance(value, str) or value not in names():
            known = f"; known: {', '.join(names())}"
            raise ValueError(misspelt(f"unknown name {short_repr(value)}", value, names(), known))
        return value

    return Annotated[str, BeforeValidator(check), JsonSchema(lambda: {"enum": names()})]


def list_of(item: Any, size: int, description: str = "numbers or formulas", least: int = 0) -> Any:
    """Type of a list with ``size`` or ``least`` entries; ``what`` names them in messages."""
    sizes = f"{least} or {size}" if least else f"{size}"

    def check(value: object) -> Any:
        if not isinstance(value, list):
            raise ValueError(
                f"expected a list of {sizes} entries ({description}), got {short_repr(value)}"
            )
        if len(value) not in (least or size, size):
            raise ValueError(f"expected {sizes} entries ({description}), got {len(value)}")
        return value

    limits = Field(min_length=least or size, max_length=size)
    return Annotated[list[item], BeforeValidator(check), limits]
