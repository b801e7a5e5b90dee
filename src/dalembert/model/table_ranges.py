"""Tables that are asked for more than they have, where a mechanism has come to."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.model.description import Description
from dalembert.model.equations import Equations

AHEAD = 3.0
"""Lengths of the last step by which a motion is looked ahead."""


def left_table(
    d: Description, e: Equations, states: list[tuple[float, np.ndarray, np.ndarray]], p: np.ndarray
) -> str:
    """Which table ends at the last of these states or right ahead of it; empty if none does.

    Parameters
    ----------
    d : with its tables
    e : equations of all bodies
    states : one or several (time, coordinates, speeds), the last one the last that is finite
    """
    for name, table in d.tables.items():
        for use in table.uses:
            function = ca.Function("use", [e.t, e.y, e.v, e.p], [use], {"allow_free": True})
            if function.has_free():  # in a law or curve, of its own variable
                continue
            found = [float(function(*state, p)) for state in states]
            change = found[-1] - found[-2] if len(found) > 1 else 0.0
            for value in (found[-1], found[-1] + AHEAD * change):
                if table.is_left_at(value):
                    first, last = table.range
                    return (
                        f"the table {name!r} goes from {first:g} to {last:g} and is asked for "
                        f"{found[-1]:.6g} and beyond; give it more rows, or outside = "
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
    """Which table ends where a motion does, told from where it was a time ``back`` before."""
    y, v = state
    earlier = (now - back, e.manifold.go(y, -back * v), v)
    left = left_table(d, e, [earlier, (now, y, v)], p)
    return f"after t = {now:.9g} s {left}" if left else ""
