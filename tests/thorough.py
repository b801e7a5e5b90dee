"""Cases that run with every push, and the others, which ``pytest -m thorough`` runs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
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
        values = case if isinstance(case, tuple) else (case,)
        marks = () if k % each == 0 else (pytest.mark.thorough,)
        params.append(pytest.param(*values, marks=marks, id=names[k] if names else None))
    return params
