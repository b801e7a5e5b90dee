"""Laws and curves of elements, with rows inline or in a CSV file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from dalembert.elements.curves import u
from dalembert.elements.laws.base import Law
from dalembert.elements.registry import CURVES, LAWS
from dalembert.errors import FileError, ModelError
from dalembert.io.column_files import check_gaps, read_columns
from dalembert.io.fields import FROM_FILE, Laws, Quantity, keyed_fields
from dalembert.io.formulas import Formulas, Scope
from dalembert.io.location import Located
from dalembert.text.wording import counted
from dalembert.units.unit import unit

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
        self.histories: dict[str, Law] = {}
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
        cls, rows = registry[table.type], FROM_FILE.get(table.type, {})
        keywords = self.columns(table, rows, where) if rows else {}
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

    def columns(
        self, table: Any, fields: Mapping[str, tuple[str, ...]], where: KeyPath
    ) -> dict[str, Any]:
        """The rows, given in the table or in a file in the folder of the model."""
        inline = [name for name in fields if getattr(table, name) is not None]
        if (table.file is None) != (len(inline) == len(fields)) or (table.file and inline):
            raise self.located.error(f"give either {' and '.join(fields)}, or file", *where)
        if table.file is None:
            with self.located(*where):
                return {name: [self._row(item) for item in getattr(table, name)] for name in fields}
        path = Path(self.located.source).parent / table.file
        with self.located(*where, "file"):
            columns = iter(_si_columns(path, [si for units in fields.values() for si in units]))
        rows = {name: [next(columns) for _ in units] for name, units in fields.items()}
        return {
            name: parts[0] if len(parts) == 1 else list(zip(*parts, strict=True))
            for name, parts in rows.items()
        }

    def _row(self, item: Any) -> Any:
        return [self._row(x) for x in item] if isinstance(item, list) else self.formulas.read(item)


def construct(cls: type, *arguments: Any, **keys: Any) -> Any:
    """Construct an object of a registered class; invalid data raise ``ModelError``."""
    try:
        return cls(*arguments, **keys)
    except (TypeError, ValueError, ArithmeticError) as error:
        raise ModelError(f"cannot be created: {error}") from None


def _si_columns(path: Path, expected: list[str]) -> list[list[float]]:
    """Columns of a CSV file in SI units, converted from the units of its heading.

    Raises
    ------
    FileError
        Another number of columns, or a unit of another dimension than expected.
    """
    columns = read_columns(path)
    if len(columns) != len(expected):
        raise FileError(f"{path}: has {counted(len(columns), 'column')}; expected {len(expected)}")
    check_gaps(path, {name: values for name, (_, values) in columns.items()})
    converted = []
    for (name, (text, values)), si in zip(columns.items(), expected, strict=True):
        if text and si and not unit(text).fits(si):
            raise FileError(f"{path}: column {name!r} is in {text!r}; expected a unit of {si}")
        converted.append([value * unit(text).factor for value in values])
    return converted
