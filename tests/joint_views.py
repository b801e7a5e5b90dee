"""What a mechanism does at its start, as seen in the coordinates of a view."""

from __future__ import annotations

import numpy as np

import dalembert as da


def accelerations(view, formulation=None) -> list[np.ndarray]:
    """``y, v, v̇, λ`` of the bodies at the start."""
    model, e, f = view.model, view.equations, formulation or da.KKT()
    start, p = model.start, model.nominal
    q, u = (x.full().ravel() for x in view.reduce.function(0.0, start.y, start.v, p))
    f = f.choose(e, 0.0, q, p)
    seen = [e.without_dropped(column) for column in view.everything]
    function = f.acceleration(e, e.constraint_acceleration, seen).function
    return [x.full().ravel() for x in function(0.0, np.concatenate([q, u, [0, 0]]), p)]


def assert_same(computed, expected, tolerance=1e-9) -> None:
    for one, other in zip(computed, expected, strict=True):
        limit = tolerance * (1 + np.abs(other).max(initial=0))
        np.testing.assert_allclose(one, other, atol=limit, rtol=0)
