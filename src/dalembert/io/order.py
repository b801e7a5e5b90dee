"""Order of entries that refer to one another."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from graphlib import CycleError, TopologicalSorter

from dalembert.errors import ExpressionError
from dalembert.io.messages import key_path

_FIRST_NAME = re.compile(r"(?<![\w.])[^\W\d]\w*")


def dependency_order(section: str, formulas: Mapping[str, Iterable[str]]) -> list[str]:
    """Names of a section, each after the names that its formulas use.

    Raises
    ------
    ExpressionError
        Circular references; names the cycle.
    """
    needs = {
        name: [n for text in texts for n in _FIRST_NAME.findall(text) if n in formulas]
        for name, texts in formulas.items()
    }
    try:
        return list(TopologicalSorter(needs).static_order())
    except CycleError as error:
        chain = error.args[1][::-1]
        more = " → …" if len(chain) > 12 else ""
        raise ExpressionError(
            f"depends on itself in the cycle {' → '.join(chain[:12])}{more}; "
            "define one of them without the others",
            key_path(section, chain[0]),
        ) from None
