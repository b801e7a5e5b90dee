"""Formulas that are written once and copied afterwards."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, wraps

import casadi as ca


def template(*sizes: int) -> Callable[[Callable[..., ca.SX]], Callable[..., ca.SX]]:
    """Decorator: CasADi copies what a function writes, for expressions of these numbers of rows.

    The graph is the same; made operation by operation it takes Python twenty times as long, which
    shows where a mechanism has a thousand bodies.
    """

    def decorated(write: Callable[..., ca.SX]) -> Callable[..., ca.SX]:
        @cache
        def written() -> ca.Function:
            symbols = [ca.SX.sym(f"x{k}", size) for k, size in enumerate(sizes)]
            return ca.Function("template", symbols, [write(*symbols)])

        @wraps(write)
        def filled(*expressions: ca.SX) -> ca.SX:
            return written()(*expressions)

        return filled

    return decorated
