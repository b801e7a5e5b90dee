"""A table of a file with some of its keys replaced, as the command line does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from dalembert.io.messages import explain
from dalembert.io.model_file import ModelFile


def changed(file: ModelFile, section: str, changes: Mapping[str, Any]) -> ModelFile:
    """The same file with other keys in a table, which is made where there is none.

    Parameters
    ----------
    changes : key → value; None leaves it as it is, an empty text takes it away

    Raises
    ------
    ModelError
        A value that cannot be.
    """
    given = {key: value for key, value in changes.items() if value is not None}
    if not given:
        return file
    document: Any = file.document
    table = getattr(document, section)
    kind = type(document).model_fields[section].annotation
    known = {} if table is None else {k: getattr(table, k) for k in table.model_fields_set}
    known = {k: v for k, v in (known | given).items() if v != ""}
    try:
        made = _table(kind).model_validate(known)
    except ValidationError as error:
        told = explain(error, known, file.path)
        raise file.located.error(told.message, section) from None
    document = document.model_copy(update={section: made})
    document.__pydantic_fields_set__.add(section)
    return replace(file, document=document)


def _table(kind: Any) -> type[BaseModel]:
    listed = [k for k in get_args(kind) if isinstance(k, type)] or [kind]
    return listed[0]  # type: ignore[no-any-return]
