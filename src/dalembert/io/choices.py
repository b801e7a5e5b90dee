"""Tables with known keys, and places where one of several tables may stand."""

from __future__ import annotations

from typing import Annotated, Any, Union

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Tag,
    model_validator,
)

from dalembert.io.messages import UnknownKey
from dalembert.io.values import shown
from dalembert.text import nearest

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


def one_of(
    tables: dict[str, Any], *, plain: Any = None, default: str | None = None, prefix: str = ""
) -> Any:
    """A table chosen by its ``type``, or a plain value where one is allowed.

    Parameters
    ----------
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

    members = [Annotated[table, Tag(name)] for name, table in tables.items()]
    if plain is not None:
        members.append(Annotated[plain, Tag(PLAIN)])
    return Annotated[Union[tuple(members)], Discriminator(choose), BeforeValidator(check)]  # noqa: UP007


def table_or(table: type[BaseModel], plain: Any) -> Any:
    """A table of one kind, or a plain value that stands for it."""

    def choose(value: Any) -> str:
        return "table" if isinstance(value, (dict, BaseModel)) else PLAIN

    members = (Annotated[table, Tag("table")], Annotated[plain, Tag(PLAIN)])
    return Annotated[Union[members], Discriminator(choose)]  # noqa: UP007
