"""Expressions of outputs with finite derivatives."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from dalembert.results.sources import Row
from dalembert.symbolic.formulas.expression import Expression, stack


def smooth_rows(rows: Sequence[Row]) -> tuple[Expression, list[int]]:
    """Stacked rows, and the numbers of those whose square root the script takes.

    Norms have no derivative at zero, where their weights usually vanish.
    """
    roots = [k for k, row in enumerate(rows) if row.sx.op() == ca.OP_SQRT]
    parts = [row.sx.dep(0) if k in roots else row.sx for k, row in enumerate(rows)]
    return Expression(stack(parts)), roots
