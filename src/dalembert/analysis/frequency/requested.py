"""Requested inputs and outputs of linear systems: names and measures."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from dalembert.errors import AnalysisError
from dalembert.symbolic.formulas.expression import Expression

SAMPLES = {"inputs": "['push']", "outputs": "['body.x']"}
"""Option → what a message shows."""


def requested(items: Any, option: str, verb: str) -> list[str | Expression]:
    """Names or measures of an option, a single one as a list.

    Parameters
    ----------
    items : a name, a measure, or a collection of them
    option : ``"inputs"`` or ``"outputs"``
    verb : analysis or function, for messages

    Raises
    ------
    AnalysisError
        Another type.
    """
    single = isinstance(items, (str, Expression))
    listed = [items] if single else list(items) if isinstance(items, Iterable) else [items]
    for item in listed:
        if not isinstance(item, (str, Expression)):
            raise AnalysisError(
                f"{verb}: {option} is {items!r:.60}; give names, as in {option}={SAMPLES[option]}"
            )
    return listed


def requested_names(items: Any, verb: str) -> list[str]:
    """Names of inputs.

    Raises
    ------
    AnalysisError
        Another type, or a name twice.
    """
    names = [x if isinstance(x, str) else x.name for x in requested(items, "inputs", verb)]
    for k, name in enumerate(names):
        if name in names[:k]:
            raise AnalysisError(f"{verb}: the input {name!r} is named twice")
    return names
