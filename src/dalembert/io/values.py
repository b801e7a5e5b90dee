"""The kinds of values a model file may hold, each checked with a message of its own."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pkgutil import resolve_name
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, PlainValidator, WithJsonSchema

from dalembert.errors import ExpressionError
from dalembert.text.wording import nearest
from dalembert.units.measured import Measured, measured


def shown(value: Any) -> str:
    """A value as it appears in messages: short, however large it is."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "a table"
    return reprlib.repr(value)


def constant(value: Any) -> float:
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
        raise ValueError(f"expected a number, got {shown(value)}")
    return _finite(value)


def in_own_unit(value: Any) -> float | str:
    """A finite number, or a text that gives its unit with it; the unit is kept."""
    number = constant(value)
    return value if isinstance(number, Measured) else number


def _finite(value: int | float) -> float:
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ValueError(f"{shown(value)} is not a finite number; give a finite one")
    return value if isinstance(value, Measured) else number


def number_or_formula(value: Any) -> float | str:
    """A finite number, or the text of a formula (parsed when the model is built)."""
    if isinstance(value, str):
        if not value.strip():
            raise ValueError("the text is empty; write a number or a formula")
        return value
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError(f"expected a number or a formula, got {shown(value)}")
    return _finite(value)


def _bound(value: Any) -> float | None:
    return value if _is_open(value) else constant(value)


def _own_bound(value: Any) -> float | str | None:
    return value if _is_open(value) else in_own_unit(value)


def _number_or_bounds(value: Any) -> float | list[float | None]:
    if not isinstance(value, list):
        return constant(value)
    if len(value) != 2:
        raise ValueError(f"expected a number or [lower, upper], got {len(value)} entries")
    return [_bound(side) for side in value]


def _is_open(value: Any) -> bool:
    return value is None or (isinstance(value, float) and math.isinf(value))


def _integer(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"expected a whole number, got {shown(value)}")
    if abs(value) > 10**12:
        raise ValueError("the number is too large")
    return value


def _flag(value: Any) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"expected true or false, got {shown(value)}")
    return value


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise ValueError(f"expected a text in quotes, got {shown(value)}")
    return value


def _count_or_times(value: Any) -> int | list[float | str]:
    if isinstance(value, list):
        return [number_or_formula(item) for item in value]
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"expected a count or a list of times, got {shown(value)}")
    return _integer(value)


def _rows(value: Any) -> list:
    if not isinstance(value, list):
        raise ValueError(f"expected a list of numbers, got {shown(value)}")
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


@dataclass(frozen=True)
class JsonSchema:
    """What a type is in the JSON Schema, made when that is asked for."""

    made: Callable[[], dict[str, Any]]

    def __get_pydantic_json_schema__(self, _: Any, __: Any) -> dict[str, Any]:
        return self.made()


def one_name(known: str | Iterable[str]) -> Any:
    """One of these names, or of those that stand under a dotted name.

    The latter are looked up when a file holds one, so that reading others imports nothing.
    """

    def names() -> list[str]:
        return list(resolve_name(known) if isinstance(known, str) else known)

    def check(value: Any) -> str:
        if not isinstance(value, str) or value not in names():
            near, all_of_them = nearest(value, names()), ", ".join(names())
            raise ValueError(f"unknown name {shown(value)}{near}; known: {all_of_them}")
        return value

    return Annotated[str, BeforeValidator(check), JsonSchema(lambda: {"enum": names()})]


def list_of(item: Any, size: int, what: str = "numbers or formulas", least: int = 0) -> Any:
    """A list with ``size`` entries, or with ``least``; ``what`` names them in messages."""
    sizes = f"{least} or {size}" if least else f"{size}"

    def check(value: Any) -> Any:
        if not isinstance(value, list):
            raise ValueError(f"expected a list of {sizes} entries ({what}), got {shown(value)}")
        if len(value) not in (least or size, size):
            raise ValueError(f"expected {sizes} entries ({what}), got {len(value)}")
        return value

    limits = Field(min_length=least or size, max_length=size)
    return Annotated[list[item], BeforeValidator(check), limits]
