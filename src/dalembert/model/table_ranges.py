"""Tables evaluated outside of their range by a motion."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.model.description import Description
from dalembert.model.equations import Equations

AHEAD = 3.0
"""Extrapolation of a motion, in lengths of the last step."""


def left_table(
    d: Description, e: Equations, states: list[tuple[float, np.ndarray, np.ndarray]], p: np.ndarray
) -> str:
    """Message about a table that ends at the last state or just ahead of it; else empty.

    Parameters
    ----------
    d : with its tables
    e : equations of all bodies
    states : (time, coordinates, speeds), one or several; all are finite
    """
    for name, table in d.tables.items():
        for use in table.uses:
            function = ca.Function("use", [e.t, e.y, e.v, e.p], [use], {"allow_free": True})
            if function.has_free():  # a law or curve evaluates it at its own variable
                continue
            values = [float(function(*state, p)) for state in states]
            change = values[-1] - values[-2] if len(values) > 1 else 0.0
            for value in (values[-1], values[-1] + AHEAD * change):
                if table.is_left_at(value):
                    first, last = table.range
                    return (
                        f"the table {name!r} goes from {first:g} to {last:g} and is evaluated at "
                        f"{values[-1]:.6g} and beyond; give it more rows, or outside = "
                        "'extrapolate' or 'clamp'"
                    )
    return ""


def left_ahead(
    d: Description,
    e: Equations,
    now: float,
    state: tuple[np.ndarray, np.ndarray],
    back: float,
    p: np.ndarray,
) -> str:
    """Message about a table that ends where a motion does, extrapolated over the time ``back``."""
    y, v = state
    earlier = (now - back, e.manifold.go(y, -back * v), v)
    left = left_table(d, e, [earlier, (now, y, v)], p)
    return f"after t = {now:.9g} s {left}" if left else ""
