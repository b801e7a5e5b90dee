"""Tables with a fixed set of keys, and choices between several tables."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Annotated, Any, ClassVar, Union

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Tag,
    model_validator,
)
from pydantic_core import CoreSchema, core_schema

from dalembert.io.messages import UnknownKey
from dalembert.io.values import short_repr
from dalembert.text.wording import misspelt

PLAIN = "plain"


class Record(BaseModel):
    """A table that refuses unknown keys."""

    model_config = ConfigDict(strict=True, extra="forbid")
    misplaced: ClassVar[dict[str, str]] = {}
    """Keys of other tables → the reason why they are wrong here."""

    @model_validator(mode="before")
    @classmethod
    def _known_keys_only(cls, value: Any) -> Any:
        if not isinstance(value, dict):
            raise ValueError(f"expected a table, got {short_repr(value)}")
        names = [field.alias or name for name, field in cls.model_fields.items()]
        for key in value:
            if key not in names:
                raise UnknownKey(key, names, cls.misplaced.get(key, ""))
        return value


Table = type[BaseModel]


class DeferredTable:
    """A table type that is created on first use, because a file uses few of the many types."""

    def __init__(self, make: Callable[[], Table]):
        self.make = make

    @cached_property
    def _table(self) -> Table:
        return self.make()

    def _read(self, value: object) -> Any:
        return self._table.model_validate(value)

    def __get_pydantic_core_schema__(self, *_: Any) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(self, _: Any, handler: Any) -> Any:
        table = self._table
        schema: Any = table.__pydantic_core_schema__
        name = f"{table.__module__}.{table.__qualname__}:{id(table)}"
        if schema["type"] == "definitions":
            schema = schema | {"schema": schema["schema"] | {"ref": name}}
        else:
            schema = schema | {"ref": name}
        return handler.generate_json_schema.generate_inner(schema)


def one_of(
    tables: Mapping[str, Table | Callable[[], Table]],
    *,
    plain: Any = None,
    default: str | None = None,
    prefix: str = "",
    misplaced: Mapping[str, str] | None = None,
) -> Any:
    """Union of tables discriminated by their ``type``, or a plain value where one is allowed.

    Parameters
    ----------
    tables : type → its table, or the function that creates it
    default : type used when the key is absent
    prefix : optional prefix of a type
    misplaced : types of other places → the reason why they are wrong here
    """

    def choose(value: object) -> Any:
        if not isinstance(value, (dict, BaseModel)):
            return PLAIN
        keys = value if isinstance(value, dict) else vars(value)
        kind = keys.get("type", default)
        return kind.removeprefix(prefix) if isinstance(kind, str) else kind

    def check(value: object) -> Any:
        kinds = ", ".join(tables)
        if not isinstance(value, (dict, BaseModel)):
            if plain is None:
                raise ValueError(f"expected a table with a type ({kinds}), got {short_repr(value)}")
        elif (name := choose(value)) is None:
            raise ValueError(f"type is missing; give one of: {kinds}")
        elif misplaced and isinstance(name, str) and name in misplaced:
            raise ValueError(f"type {name} is {misplaced[name]}; known here: {kinds}")
        elif not isinstance(name, str) or name not in tables:
            raise ValueError(
                misspelt(f"unknown type {short_repr(name)}", name, tables, f"; known: {kinds}")
            )
        return value

    members = [
        Annotated[
            table if isinstance(table, type) else Annotated[Any, DeferredTable(table)], Tag(name)
        ]
        for name, table in tables.items()
    ]
    if plain is not None:
        members.append(Annotated[plain, Tag(PLAIN)])
    return Annotated[Union[tuple(members)], Discriminator(choose), BeforeValidator(check)]  # noqa: UP007


def table_or(table: Any, plain: Any) -> Any:
    """Union of one table and a plain value."""

    def choose(value: object) -> str:
        return "table" if isinstance(value, (dict, BaseModel)) else PLAIN

    members = (Annotated[table, Tag("table")], Annotated[plain, Tag(PLAIN)])
    return Annotated[Union[members], Discriminator(choose)]  # noqa: UP007


def tables_or(table: Any, plain: Any) -> Any:
    """Union of a list of tables and a plain value."""

    def choose(value: Any) -> str:
        entries = value if isinstance(value, list) else ()
        return "tables" if any(isinstance(e, (dict, BaseModel)) for e in entries) else PLAIN

    members = (Annotated[list[table], Tag("tables")], Annotated[plain, Tag(PLAIN)])
    return Annotated[Union[members], Discriminator(choose)]  # noqa: UP007
