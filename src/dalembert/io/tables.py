"""Tables of a file, generated from the classes they describe: nothing is written twice."""

from __future__ import annotations

import dataclasses
import inspect
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, Field, create_model

from dalembert.elements.laws import Product, Sum
from dalembert.elements.registry import CURVES, LAWS
from dalembert.io.choices import Record, one_of, table_or
from dalembert.io.fields import FROM_FILE, connected, is_needed, kind_of, written
from dalembert.io.messages import nearest
from dalembert.io.strategies import STRATEGIES
from dalembert.io.values import (
    CountOrTimes,
    Entry,
    Flag,
    Integer,
    Number,
    Rows,
    Text,
    list_of,
    shown,
)


class InlinePoint(Record):
    """A point that needs no name: coordinates in the frame of its body [m]."""

    body: Text
    at: list_of(Entry, 2, "x, y")  # type: ignore[valid-type]


class EventTable(Record):
    """An event with its direction and whether it ends the run."""

    measure: Entry
    terminal: Flag = False
    direction: Integer = 0


class RayleighTable(Record):
    """Damping ``C = α M + β K``."""

    mass: Entry = Field(default=0.0, description="α [1/s]")
    stiffness: Entry = Field(default=0.0, description="β [s]")


def named(known: dict[str, type]) -> Any:
    """The name of a strategy, or a table with its type and its options."""

    def check(value: Any) -> Any:
        if isinstance(value, str) and value not in known:
            raise ValueError(f"unknown {value!r}{nearest(value, known)}; known: {', '.join(known)}")
        if not isinstance(value, (str, dict)):
            raise ValueError(f"expected a name ({', '.join(known)}) or a table, got {shown(value)}")
        return value

    plain: Any = Annotated[Literal[tuple(known)], Field(title="name")]
    tables = {name: table_of(name, cls) for name, cls in known.items()}
    return Annotated[one_of(tables, plain=plain), BeforeValidator(check)]


Vector = list_of(Entry, 2, "x, y")
Reference = table_or(InlinePoint, Text)


def _connection(ties: list[dataclasses.Field]) -> Any:
    names = ", ".join(f.name for f in ties)
    point = any(kind_of(f) == "point" for f in ties)
    return list_of(Reference if point else Text, len(ties), names)


@cache
def value_type(kind: str, size: int = 1) -> Any:
    """The pydantic type behind the word of ``kind_of``."""
    simple = {
        "quantity": Entry,
        "spring-law": Entry,
        "measure": Entry,
        "number": Number,
        "integer": Integer,
        "flag": Flag,
        "text": Text,
        "event": Text,
        "state": Text,
        "body": Text,
        "joint": Text,
        "rows": Rows,
        "count or times": CountOrTimes,
    }
    if kind in simple:
        return simple[kind]
    if kind in STRATEGIES:
        return named(STRATEGIES[kind])
    made = {
        "vector": lambda: list_of(Entry, size),
        "interval": lambda: list_of(Number, 2, "start, end"),
        "points": lambda: dict[str, Vector],  # type: ignore[valid-type]
        "law": lambda: _law(),
        "terms": lambda: list[_law(Sum)],  # type: ignore[misc]
        "factors": lambda: list[_law(Sum, Product)],  # type: ignore[misc]
        "curve": lambda: one_of({n: table_of(n, c) for n, c in CURVES.items()}),
        "damping": lambda: RayleighTable,
        "names": lambda: list[Text],  # type: ignore[valid-type]
        "events": lambda: dict[str, table_or(EventTable, Entry)],  # type: ignore[misc]
    }
    return made[kind]()


def _law(*without: type) -> Any:
    """A law but these, or a number or formula in t: sums hold products, products neither."""
    tables = {n: table_of(n, c) for n, c in LAWS.items() if c not in without}
    return one_of(tables, plain=Entry)


def table_of(name: str, cls: Any, optional_type: bool = False) -> type[BaseModel]:
    """The table that describes an object of a registered class."""
    kind = Literal[name]  # type: ignore[valid-type]
    keys: dict[str, Any] = {"type": (kind, name if optional_type else ...)}
    ties = connected(cls)
    if ties:
        about = "what it ties, in order: " + ", ".join(f.name for f in ties)
        keys["connect"] = (_connection(ties), Field(description=about))
    from_file = FROM_FILE.get(name, ())
    if from_file:
        about = f"CSV file with two columns, instead of {' and '.join(from_file)}"
        keys["file"] = (Text, Field(default=None, description=about))
    for field in written(cls):
        given = value_type(kind_of(field), field.metadata.get("size", 1))
        default = ... if is_needed(field) and field.name not in from_file else None
        keys[field.name] = (given, Field(default, description=about_field(field)))
    return create_model(name, __base__=Record, __doc__=summary_of(cls), **keys)


def about_field(field: dataclasses.Field) -> str | None:
    """What a field holds, with its unit."""
    text, unit = field.metadata.get("description"), field.metadata.get("unit")
    if field.name == "points":
        return "name of a point: its coordinates in the body frame [m]"
    return f"{text} [{unit}]" if text and unit else text


def summary_of(cls: type) -> str:
    """The first paragraph of what is said about a class."""
    return inspect.cleandoc(cls.__doc__ or "").split("\n\n")[0].replace("\n", " ")
