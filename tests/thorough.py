"""Cases that run with every push, and the others, which ``pytest -m thorough`` runs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product
from typing import Any

import pytest


def sampled(cases: Iterable[Any], each: int, names: Sequence[str] | None = None) -> list[Any]:
    """All cases, of which every ``each``-th is not marked ``thorough``.

    Parameters
    ----------
    cases : values of the parameters of a test, tuples where it has several
    names : names of the cases in reports
    """
    params = []
    for k, case in enumerate(cases):
        marks = () if k % each == 0 else (pytest.mark.thorough,)
        params.append(pytest.param(*_parts(case), marks=marks, id=names[k] if names else None))
    return params


def crossed(rows: Iterable[Any], columns: Iterable[Any], each: int = 1) -> list[Any]:
    """All pairs; those not marked ``thorough`` have every row and every column.

    Parameters
    ----------
    rows, columns : values of parameters of a test, tuples where they belong to several
    each : pairs of the longer side that run with every push; they take the shorter side in turn
    """
    rows, columns = list(rows), list(columns)
    period, params = min(len(rows), len(columns)), []
    for (i, row), (j, column) in product(enumerate(rows), enumerate(columns)):
        pair = [*_parts(row), *_parts(column)]
        marks = () if (j - i) % period < each else (pytest.mark.thorough,)
        params.append(pytest.param(*pair, marks=marks))
    return params


def _parts(value: Any) -> tuple:
    return value if isinstance(value, tuple) else (value,)
