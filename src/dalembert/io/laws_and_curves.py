"""Laws and curves of elements, with rows inline or in a CSV file."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from dalembert.elements.curves import u
from dalembert.elements.registry import CURVES, LAWS
from dalembert.errors import FileError, ModelError
from dalembert.files import read_text
from dalembert.io.fields import FROM_FILE, Laws, Quantity, keyed_fields
from dalembert.io.formulas import Formulas, Scope
from dalembert.io.location import Located

KeyPath = tuple[str | int, ...]


class LawReader:
    """Reader of laws and curves.

    Parameters
    ----------
    located : adds file and location to errors
    formulas : reads numbers and formulas
    """

    def __init__(self, located: Located, formulas: Formulas):
        self.located, self.formulas = located, formulas
        self.histories: dict[str, Any] = {}
        """Name of an unknown history → its law."""

    def law(self, entry: Any, where: KeyPath) -> Any:
        """A law, or the number or formula in ``t`` that replaces it."""
        if isinstance(entry, str) and entry in self.histories:
            return self.histories[entry]
        if not isinstance(entry, BaseModel):
            return self.formulas.read(entry, Scope.TIME)
        return self._read(LAWS, entry, where, Scope.TIME, {})

    def curve(self, table: Any, where: KeyPath) -> Any:
        """A curve; formulas may use its parameter ``u``."""
        return self._read(CURVES, table, where, Scope.PARAMETERS, {"u": u})

    def _read(
        self, registry: dict[str, Any], table: Any, where: KeyPath, scope: Scope, local: dict
    ) -> Any:
        cls, rows = registry[table.type], FROM_FILE.get(table.type, ())
        keywords = self._columns(table, rows, where) if rows else {}
        for field in keyed_fields(cls, frozenset()):
            if field.name not in table.model_fields_set or field.name in rows:
                continue
            entry = getattr(table, field.name)
            with self.located(*where, field.name):
                if field.holds is Quantity:
                    entry = self.formulas.read(entry, scope, local)
                elif field.holds is Laws:
                    entry = [self.law(x, (*where, field.name, k)) for k, x in enumerate(entry)]
                keywords[field.name] = entry
        with self.located(*where):
            return construct(cls, **keywords)

    def _columns(self, table: Any, fields: tuple[str, ...], where: KeyPath) -> dict[str, Any]:
        """The columns, given in the table or in a file in the folder of the model."""
        columns_given = [name for name in fields if getattr(table, name) is not None]
        if (table.file is None) != (len(columns_given) == len(fields)) or (
            table.file and columns_given
        ):
            raise self.located.error(f"give either {' and '.join(fields)}, or file", *where)
        if table.file is None:
            with self.located(*where):
                return {name: [self._row(item) for item in getattr(table, name)] for name in fields}
        with self.located(*where, "file"):
            pairs = read_pairs(Path(self.located.source).parent / table.file)
        columns = zip(*pairs, strict=True) if len(fields) == 2 else [pairs]
        return dict(zip(fields, columns, strict=True))

    def _row(self, item: Any) -> Any:
        return [self._row(x) for x in item] if isinstance(item, list) else self.formulas.read(item)


def construct(cls: type, *arguments: Any, **keys: Any) -> Any:
    """Construct an object of a registered class; invalid data raise ``ModelError``."""
    try:
        return cls(*arguments, **keys)
    except (TypeError, ValueError, ArithmeticError) as error:
        raise ModelError(f"cannot be created: {error}") from None


def read_pairs(path: Path) -> list[tuple[float, float]]:
    """The rows of a CSV file with two columns; a heading line and ``#`` comments are allowed.

    Raises
    ------
    FileError
        The file cannot be read, or a line is not two numbers (states its number).
    """
    rows: list[tuple[float, float]] = []
    try:
        for number, row in enumerate(csv.reader(read_text(path).splitlines()), 1):
            if not row or not "".join(row).strip() or row[0].lstrip().startswith("#"):
                continue
            pair = _numbers(row)
            if pair is not None:
                rows.append(pair)
            elif rows or number > 1:
                raise FileError(
                    f"{path}: line {number}: expected two numbers, got {','.join(row)[:60]!r}"
                )
    except csv.Error as error:
        raise FileError(f"{path}: not a CSV file ({error})") from None
    if not rows:
        raise FileError(f"{path}: has no rows of two numbers")
    return rows


def _numbers(row: list[str]) -> tuple[float, float] | None:
    try:
        first, second = (float(text) for text in row)
    except ValueError:
        return None
    return first, second
