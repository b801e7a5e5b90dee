"""Names of the outputs of a stepper."""

from __future__ import annotations

from collections.abc import Sequence

from dalembert.symbolic.formulas.expression import Expression


def names_of(measures: Sequence[Expression]) -> list[str]:
    """Names of all components of measures."""
    names = []
    for measure in measures:
        size = len(measure)
        names += [measure.name] if size == 1 else [f"{measure.name}[{k}]" for k in range(size)]
    return names
