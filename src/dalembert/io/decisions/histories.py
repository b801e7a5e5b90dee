"""Unknown histories of a file: times of their knots, and their parameters."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.design.inverse.history import History, history
from dalembert.io.decisions.task_tables import KnotsTable


def knots_of(table: Any) -> np.ndarray:
    """The times of a history's knots."""
    if isinstance(table.knots, KnotsTable):
        return np.linspace(table.knots.start, table.knots.end, max(table.knots.count, 0))
    return np.asarray(table.knots, dtype=float)


def declare_history(system: Any, name: str, table: Any) -> History:
    """Give a system the parameters of a history."""
    return history(system, name, knots_of(table), table.value, table.unit, table.ends)
