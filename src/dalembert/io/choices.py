"""Tables with known keys, and places where one of several tables may stand."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Annotated, Any, Union

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
from dalembert.io.values import shown
from dalembert.text.wording import nearest

PLAIN = "plain"


class Record(BaseModel):
    """A table with known keys only."""

    model_config = ConfigDict(strict=True, extra="forbid")

    @model_validator(mode="before")
    @classmethod
    def _known_keys_only(cls, value: Any) -> Any:
        if not isinstance(value, dict):
            raise ValueError(f"expected a table, got {shown(value)}")
        known = [field.alias or name for name, field in cls.model_fields.items()]
        for key in value:
            if key not in known:
                raise UnknownKey(key, known)
        return value


Table = type[BaseModel]


class Later:
    """A table that is described when the first one of it is read: most files hold few of many."""

    def __init__(self, make: Callable[[], Table]):
        self.make = make

    @cached_property
    def _table(self) -> Table:
        return self.make()

    def _read(self, value: Any) -> Any:
        return self._table.model_validate(value)

    def __get_pydantic_core_schema__(self, *_: Any) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(self, _: Any, handler: Any) -> Any:
        table = self._table
        known: Any = table.__pydantic_core_schema__
        name = f"{table.__module__}.{table.__qualname__}:{id(table)}"
        if known["type"] == "definitions":
            known = known | {"schema": known["schema"] | {"ref": name}}
        else:
            known = known | {"ref": name}
        return handler.generate_json_schema.generate_inner(known)


def one_of(
    tables: Mapping[str, Table | Callable[[], Table]],
    *,
    plain: Any = None,
    default: str | None = None,
    prefix: str = "",
) -> Any:
    """A table chosen by its ``type``, or a plain value where one is allowed.

    Parameters
    ----------
    tables : type → its table, or what makes it
    default : the type where none is given
    prefix : what may stand before a type and says nothing new
    """

    def choose(value: Any) -> Any:
        if not isinstance(value, (dict, BaseModel)):
            return PLAIN
        told = value if isinstance(value, dict) else vars(value)
        given = told.get("type", default)
        return given.removeprefix(prefix) if isinstance(given, str) else given

    def check(value: Any) -> Any:
        known = ", ".join(tables)
        if not isinstance(value, (dict, BaseModel)):
            if plain is None:
                raise ValueError(f"expected a table with a type ({known}), got {shown(value)}")
        elif (name := choose(value)) is None:
            raise ValueError(f"type is missing; give one of: {known}")
        elif not isinstance(name, str) or name not in tables:
            raise ValueError(f"unknown type {shown(name)}{nearest(name, tables)}; known: {known}")
        return value

    members = [
        Annotated[table if isinstance(table, type) else Annotated[Any, Later(table)], Tag(name)]
        for name, table in tables.items()
    ]
    if plain is not None:
        members.append(Annotated[plain, Tag(PLAIN)])
    return Annotated[Union[tuple(members)], Discriminator(choose), BeforeValidator(check)]  # noqa: UP007


def table_or(table: type[BaseModel], plain: Any) -> Any:
    """A table of one kind, or a plain value that stands for it."""

    def choose(value: Any) -> str:
        return "table" if isinstance(value, (dict, BaseModel)) else PLAIN

    members = (Annotated[table, Tag("table")], Annotated[plain, Tag(PLAIN)])
    return Annotated[Union[members], Discriminator(choose)]  # noqa: UP007
