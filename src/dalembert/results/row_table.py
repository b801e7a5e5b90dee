"""Distinct rows of a module, by their formulas."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from dalembert.model.graph.absolute import at_ground
from dalembert.results.sources import Row, Source, as_row


class RowTable:
    """Distinct rows of a module.

    Parameters
    ----------
    ground : body at rest of a mechanism; None for structures
    """

    def __init__(self, ground: Any):
        self.ground, self.rows = ground, list[Row]()
        self._numbers: dict[Any, int] = {}

    def number(self, source: Source) -> int:
        """Number of the row of a formula."""
        row = as_row(source)
        key = (row.sx.element_hash(), row.work, row.relative)
        if key not in self._numbers:
            self._numbers[key] = len(self.rows)
            sx = row.sx if self.ground is None else at_ground(self.ground, row.sx)
            self.rows.append(replace(row, sx=sx))
        return self._numbers[key]
