"""Cases that run with every push, and the others, which ``pytest -m thorough`` runs."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
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


def covering(cases: Sequence[Mapping[str, Any]]) -> set[int]:
    """Indices of a few cases that have every value of every parameter, the same in all runs.

    Parameters
    ----------
    cases : names and values of parameters
    """
    pairs = [[(name, _key(value)) for name, value in case.items()] for case in cases]
    order = random.Random(len(cases)).sample(range(len(cases)), len(cases))
    taken: Counter[tuple[str, Any]] = Counter()
    chosen: set[int] = set()
    while True:
        best, gain, used = -1, 0, 0
        for k in order:
            counts = [taken[pair] for pair in pairs[k]]
            new, often = counts.count(0), sum(counts)
            if new > gain or (new == gain > 0 and often < used):
                best, gain, used = k, new, often
        if not gain:
            return chosen
        chosen.add(best)
        taken.update(pairs[best])


def mark_products(items: Iterable[pytest.Item]) -> None:
    """Mark ``thorough`` what ``covering`` leaves out of tests with the marker ``product``."""
    products: dict[str, list[pytest.Function]] = {}
    for item in items:
        pushed = item.get_closest_marker("product") and not item.get_closest_marker("thorough")
        if pushed and isinstance(item, pytest.Function):
            products.setdefault(item.nodeid.partition("[")[0], []).append(item)
    for cases in products.values():
        some = covering([case.callspec.params for case in cases])
        for k, case in enumerate(cases):
            if k not in some:
                case.add_marker(pytest.mark.thorough)


def _key(value: Any) -> Any:
    try:
        hash(value)
    except TypeError:
        return repr(value)
    return value


def _parts(value: Any) -> tuple:
    return value if isinstance(value, tuple) else (value,)
