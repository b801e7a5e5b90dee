"""Errors of a model, reported with the file and the location in it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from dalembert.errors import (
    AnalysisError,
    BudgetError,
    ExpressionError,
    FileError,
    ModelError,
    UnsupportedError,
)
from dalembert.io.messages import key_path
from dalembert.io.schema import ModelDocument


class Located:
    """Context manager that adds file and location to errors: ``with located("joints", "A"):``.

    Parameters
    ----------
    source : path of the model file
    document : contents of the file, which give the section of an element
    """

    def __init__(self, source: Path, document: ModelDocument):
        self.source, self._document = source, document
        self._section = {
            name: section for section in document.sections for name in getattr(document, section)
        }

    def error(self, message: str, *keys: str | int) -> ModelError:
        """A ``ModelError`` at a location."""
        return ModelError(message, f"{self.source}: {key_path(*keys)}")

    @contextmanager
    def __call__(self, *keys: str | int) -> Iterator[None]:
        try:
            yield
        except ModelError as error:
            if error.entity and error.entity.startswith(f"{self.source}: "):
                raise
            where = self._where(error.entity, keys)
            kind = ExpressionError if isinstance(error, ExpressionError) else ModelError
            raise kind(
                error.message, f"{self.source}: {where}" if where else str(self.source)
            ) from None
        except (BudgetError, FileError, UnsupportedError) as error:
            raise type(error)(self._message(error, keys)) from None
        except AnalysisError as error:
            raise error.with_message(self._message(error, keys)) from None

    def _message(self, error: Exception, keys: tuple[str | int, ...]) -> str:
        if str(error).startswith(f"{self.source}: "):
            return str(error)
        return ": ".join(part for part in (str(self.source), key_path(*keys), str(error)) if part)

    def _where(self, entity: str | None, keys: tuple[str | int, ...]) -> str:
        """The location or the element that the error names, whichever is more specific."""
        here = key_path(*keys)
        if not entity:
            return here
        owner = re.split(r"[.\[]", entity, maxsplit=1)[0]
        if owner not in self._section:
            field = entity.partition(".")[2]  # of a component: its class and its field
            if field and self._has(keys, re.split(r"[.\[]", field, maxsplit=1)[0]):
                return f"{here}.{field}"
            return f"{here}.{entity}" if self._has(keys, owner) else here or entity
        named = key_path(self._section[owner], owner) + entity[len(owner) :]
        return here if here.startswith(named) else named

    def _has(self, keys: tuple[str | int, ...], field: str) -> bool:
        """Whether the table at a location has a field, such as a polygon its ``holes``."""
        value: Any = self._document
        for key in keys:
            if isinstance(value, BaseModel):
                value = getattr(value, str(key), None)
                continue
            try:
                value = value[key]
            except (IndexError, KeyError, TypeError):
                return False
        return isinstance(value, BaseModel) and field in type(value).model_fields
