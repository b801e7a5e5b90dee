"""Live pages in a browser: changes of parameters, comparison with Python."""

from __future__ import annotations

from typing import Any

import numpy as np
from browser import Visit

VALUES, SLOPES = 1e-9, 1e-8
"""Tolerances, relative to the largest value of a quantity and the largest slope."""
SLOPE = """(async () => {{
    const {{ solver, table, design }} = dalembert, {{ responses }} = table;
    const request = {{ parameters: design.values, responses, gradients: [{0}] }};
    return Array.from((await solver.request(request, true)).slopes[{0}]);
}})()"""
"""Slopes of a response, by its number."""


def settle(page: Visit) -> None:
    """Wait until the present design is computed and drawn."""
    page.frames()
    waiting = "dalembert.solver?.running === null && dalembert.solver.waiting === null"
    page.until(f"document.documentElement.dataset.live !== undefined && {waiting}")
    page.frames()


def change(page: Visit, values: dict[int, float]) -> None:
    page.js("dalembert.design.begin()")
    for k, value in values.items():
        page.js(f"dalembert.design.set({k}, {value})")
    settle(page)


def close(found: Any, expected: Any, tolerance: float) -> None:
    found, expected = np.array(found, float), np.array(expected, float)
    size = np.nanmax(np.abs(expected)) or 1.0
    share = np.abs(found - expected.reshape(found.shape)) / size
    assert np.nanmax(share) <= tolerance, (found, expected)
