"""Most probable points of failure, ``β = min |u|`` on ``g(u) = 0`` (Hasofer & Lind 1974).

Limit states and indices of the black-box reliability benchmark (RPREPO), as collected in
otbenchmark.
"""

from __future__ import annotations

import math

import pytest
from design_problems import solve

CASES = {
    "R-S": (2, "(4 + u1) - (2 + u2)", math.sqrt(2)),
    "RP107": (10, "5*sqrt(10) - (" + " + ".join(f"u{k}" for k in range(1, 11)) + ")", 5.0),
    "RP22": (2, "2.5 - (u1 + u2)/sqrt(2) + 0.1*(u1 - u2)**2", 2.5),
    "RP24": (2, "2.5 - 0.2357*3*(u1 - u2) + 0.00463*(3*u1 + 3*u2)**4", 2.500024),
    "one branch of four": (2, "3 + 0.1*(u1 - u2)**2 - (u1 + u2)/sqrt(2)", 3.0),
}


@pytest.mark.parametrize("name", CASES)
def test_reliability_index(name):
    size, state, index = CASES[name]
    variables = {f"u{k}": (0.4 if k == 1 else 0.1, -10.0, 10.0) for k in range(1, size + 1)}
    distance = " + ".join(f"{u}**2" for u in variables)
    best = solve(variables, distance, [(state, 0.0, 0.0)])
    assert best.success, best.message
    assert math.sqrt(best.fun) == pytest.approx(index, rel=1e-6)
