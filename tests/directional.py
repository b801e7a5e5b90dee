"""Differences of runs along one direction of all parameters.

One wrong entry of a gradient changes its product with a random direction as much as itself, and the
product takes as many runs for ten parameters as for one.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Values = Callable[[np.ndarray], np.ndarray]
"""Parameters → values of the responses."""


def assert_slopes(
    gradient: np.ndarray, values: Values, p: np.ndarray, change: float, tolerance: float
) -> None:
    """Compare a gradient (n, n_p) with central differences, extrapolated to fourth order.

    Parameters
    ----------
    change : relative change of the parameters, which counts from 0.1 on
    tolerance : of each row, by its largest contribution of one parameter
    """
    way = np.maximum(np.abs(p), 0.1) * np.random.default_rng(0).uniform(0.5, 1.0, p.size)
    near, far = (
        (values(p + h * way) - values(p - h * way)) / (2 * h) for h in (change / 2, change)
    )
    parts = gradient * way
    error = np.abs(parts.sum(axis=1) - (4 * near - far) / 3)
    assert np.all(error < tolerance * np.abs(parts).max(axis=1)), error
