"""Laws and curves: tables of their own inside an element, with rows that may lie in a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import BaseModel

from dalembert.elements.curves import u
from dalembert.elements.registry import CURVES, LAWS
from dalembert.errors import ModelError
from dalembert.io.fields import FROM_FILE, Laws, Quantity, written
from dalembert.io.formulas import Formulas, Scope
from dalembert.io.location import Located
from dalembert.io.pairs import read_pairs

Place = tuple[str | int, ...]


class Shapes:
    """Makes laws and curves.

    Parameters
    ----------
    located : adds file and place to errors
    formulas : reads numbers and formulas
    """

    def __init__(self, located: Located, formulas: Formulas):
        self.located, self.formulas = located, formulas
        self.histories: dict[str, Any] = {}
        """Name of an unknown history → the law that it is."""

    def law(self, given: Any, where: Place) -> Any:
        """A law, or the number or formula in ``t`` that stands for one."""
        if isinstance(given, str) and given in self.histories:
            return self.histories[given]
        if not isinstance(given, BaseModel):
            return self.formulas.read(given, Scope.TIME)
        return self._shape(LAWS, given, where, Scope.TIME, {})

    def curve(self, given: Any, where: Place) -> Any:
        """A curve; formulas may use its parameter ``u``."""
        return self._shape(CURVES, given, where, Scope.PARAMETERS, {"u": u})

    def _shape(
        self, registry: dict[str, Any], table: Any, where: Place, scope: Scope, local: dict
    ) -> Any:
        cls, rows = registry[table.type], FROM_FILE.get(table.type, ())
        made = self._rows(table, rows, where) if rows else {}
        for field in written(cls, frozenset()):
            if field.name not in table.model_fields_set or field.name in rows:
                continue
            given = getattr(table, field.name)
            with self.located(*where, field.name):
                if field.holds is Quantity:
                    given = self.formulas.read(given, scope, local)
                elif field.holds is Laws:
                    given = [self.law(x, (*where, field.name, k)) for k, x in enumerate(given)]
                made[field.name] = given
        with self.located(*where):
            return made_of(cls, **made)

    def _rows(self, table: Any, fields: tuple[str, ...], where: Place) -> dict[str, Any]:
        """The columns, given in the table or in a file beside the model."""
        given = [name for name in fields if getattr(table, name) is not None]
        if (table.file is None) != (len(given) == len(fields)) or (table.file and given):
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


def made_of(cls: type, *arguments: Any, **keys: Any) -> Any:
    """An object of a registered class; what its data cannot mean becomes a model error."""
    try:
        return cls(*arguments, **keys)
    except (TypeError, ValueError, ArithmeticError) as error:
        raise ModelError(f"cannot be made: {error}") from None
