"""Cases of the quick suite, and the others, which ``pytest -m thorough`` runs."""

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


def covering(
    cases: Sequence[Mapping[str, Any]], limit: int | None = None, seed: str | int | None = None
) -> set[int]:
    """Indices of a few cases that have every value of every parameter, the same in all runs.

    Parameters
    ----------
    cases : names and values of parameters
    limit : maximum number of indices; fewer values of parameters may occur then
    seed : another one chooses other cases; default: number of cases
    """
    pairs = [[(name, _key(value)) for name, value in case.items()] for case in cases]
    random_order = random.Random(len(cases) if seed is None else seed)
    order = random_order.sample(range(len(cases)), len(cases))
    taken: Counter[tuple[str, Any]] = Counter()
    chosen: set[int] = set()
    while limit is None or len(chosen) < limit:
        best, gain, used = -1, 0, 0
        for k in order:
            counts = [taken[pair] for pair in pairs[k]]
            new, often = counts.count(0), sum(counts)
            if new > gain or (new == gain > 0 and often < used):
                best, gain, used = k, new, often
        if not gain:
            break
        chosen.add(best)
        taken.update(pairs[best])
    return chosen


def collected(request: pytest.FixtureRequest, *names: str) -> set[Any]:
    """Values of parameters in the tests of a module that run, tuples of several parameters.

    Parameters
    ----------
    request : that of a fixture of the module
    names : parameters
    """
    values = set()
    for item in request.session.items:
        params = item.callspec.params if hasattr(item, "callspec") else {}
        if item.path == request.path and params.keys() >= set(names):
            values.add(params[names[0]] if len(names) == 1 else tuple(params[n] for n in names))
    return values


def mark_products(items: Iterable[pytest.Item]) -> None:
    """Mark ``thorough`` the cases that ``product`` or ``few`` leaves out of the quick suite.

    Tests of different names take different entries of a registry by ``few``.
    """
    tests: dict[str, list[pytest.Function]] = {}
    for item in items:
        marked = item.get_closest_marker("product") or item.get_closest_marker("few")
        if marked and isinstance(item, pytest.Function) and not _is_thorough(item):
            tests.setdefault(item.nodeid.partition("[")[0], []).append(item)
    for name, cases in tests.items():
        parameters, few = (
            [case.callspec.params for case in cases],
            cases[0].get_closest_marker("few"),
        )
        some = covering(parameters, *few.args, name) if few else covering(parameters)
        for k, case in enumerate(cases):
            if k not in some:
                case.add_marker(pytest.mark.thorough)


def _is_thorough(item: pytest.Item) -> bool:
    return item.get_closest_marker("thorough") is not None


def _key(value: Any) -> Any:
    try:
        hash(value)
    except TypeError:
        return repr(value)
    return value


def _parts(value: Any) -> tuple:
    return value if isinstance(value, tuple) else (value,)
