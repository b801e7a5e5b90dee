"""Independent speeds by the names of their coordinates, and whether they can be."""

from __future__ import annotations

import difflib

import casadi as ca
import numpy as np

from dalembert.errors import SingularityError, UnsupportedError
from dalembert.formulations.partition import scaled_ratios
from dalembert.model.equations import Equations


def _names(e: Equations) -> list[str]:
    """Names of the coordinates, where each has its speed, or else of the speeds."""
    symbols = e.y if e.manifold.flat else e.v
    return [symbol.name() for symbol in ca.vertsplit(symbols)]


def indices_of(e: Equations, names: tuple[str, ...]) -> tuple[int, ...]:
    """Indices in v of the speeds of these coordinates.

    Raises
    ------
    UnsupportedError
        A name that is not known, or not as many as there are degrees of freedom.
    """
    known, needed = _names(e), e.speed_count - e.constraint_count
    for name in names:
        if name not in known:
            close = difflib.get_close_matches(name, known, 3, 0.4) or known
            raise UnsupportedError(
                f"VelocityPartitioning: no coordinate {name!r}; nearest: {', '.join(close)}"
            )
    found = tuple(sorted({known.index(name) for name in names}))
    if len(found) != needed:
        raise UnsupportedError(
            f"VelocityPartitioning(independent={names}): {needed} independent speeds are needed, "
            f"{len(found)} are named"
        )
    return found


def check_independent(
    e: Equations,
    indices: tuple[int, ...],
    limit: float,
    t: float,
    y: np.ndarray,
    p: np.ndarray,
) -> None:
    """No other speed may exceed these ones by more than the limit, in units of energy.

    Raises
    ------
    SingularityError
        Names the fastest one and how fast it is.
    """
    ratios = ca.Function("ratios", [e.t, e.y, e.p], [ca.densify(scaled_ratios(e, indices))])
    size = np.abs(ratios(t, y, p).full())
    if not size.size or np.all(size <= limit):
        return
    names = _names(e)
    if np.all(np.isfinite(size)):
        row, column = np.unravel_index(np.argmax(size), size.shape)
        slow = names[indices[column]]
        fast = names[[k for k in range(e.speed_count) if k not in indices][row]]
        why = (
            f"{fast} is {size[row, column]:.3g} times as fast as {slow} in units of energy "
            f"(limit {limit:g})"
        )
    else:
        given = ", ".join(names[k] for k in indices)
        why = f"{given} do not determine the other speeds, det W = 0"
    raise SingularityError(
        f"VelocityPartitioning: at t = {t:.9g} s {why}; name other coordinates, or leave "
        "independent=None and let the run choose"
    )
