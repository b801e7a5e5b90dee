"""Problems of Hock and Schittkowski, *Test Examples for Nonlinear Programming Codes* (1981).

Starts, limits and optima as printed there; the optima stand as their closed forms where there is
one.
"""

from __future__ import annotations

import math

import pytest
from design_problems import solve
from thorough import crossed

INF = math.inf
ROSENBROCK = "100*(x2 - x1**2)**2 + (1 - x1)**2"


def free(*start: float) -> dict[str, tuple[float, float, float]]:
    return {f"x{k}": (value, -INF, INF) for k, value in enumerate(start, 1)}


def within(start, lower, upper) -> dict[str, tuple[float, float, float]]:
    sides = zip(start, lower, upper, strict=True)
    return {f"x{k}": side for k, side in enumerate(sides, 1)}


CASES = {
    1: (within((-2, 1), (-INF, -1.5), (INF, INF)), ROSENBROCK, [], 0.0),
    4: (within((1.125, 0.125), (1, 0), (INF, INF)), "(x1 + 1)**3/3 + x2", [], 8 / 3),
    5: (
        within((0, 0), (-1.5, -3), (4, 3)),
        "sin(x1 + x2) + (x1 - x2)**2 - 1.5*x1 + 2.5*x2 + 1",
        [],
        -math.sqrt(3) / 2 - math.pi / 3,
    ),
    6: (free(-1.2, 1), "(1 - x1)**2", [("10*(x2 - x1**2)", 0, 0)], 0.0),
    7: (free(2, 2), "log(1 + x1**2) - x2", [("(1 + x1**2)**2 + x2**2", 4, 4)], -math.sqrt(3)),
    10: (free(-10, 10), "x1 - x2", [("-3*x1**2 + 2*x1*x2 - x2**2", -1, None)], -1.0),
    11: (free(4.9, 0.1), "(x1 - 5)**2 + x2**2 - 25", [("x2 - x1**2", 0, None)], -8.498464223),
    12: (
        free(0, 0),
        "0.5*x1**2 + x2**2 - x1*x2 - 7*x1 - 7*x2",
        [("4*x1**2 + x2**2", None, 25)],
        -30.0,
    ),
    14: (
        free(2, 2),
        "(x1 - 2)**2 + (x2 - 1)**2",
        [("0.25*x1**2 + x2**2", None, 1), ("x1 - 2*x2", -1, -1)],
        9 - 2.875 * math.sqrt(7),
    ),
    22: (
        free(2, 2),
        "(x1 - 2)**2 + (x2 - 1)**2",
        [("x1 + x2", None, 2), ("x2 - x1**2", 0, None)],
        1.0,
    ),
    24: (
        within((1, 0.5), (0, 0), (INF, INF)),
        "((x1 - 3)**2 - 9)*x2**3/(27*sqrt(3))",
        [("x1/sqrt(3) - x2", 0, None), ("x1 + sqrt(3)*x2", 0, 6)],
        -1.0,
    ),
    29: (free(1, 1, 1), "-x1*x2*x3", [("x1**2 + 2*x2**2 + 4*x3**2", None, 48)], -16 * math.sqrt(2)),
    31: (
        within((1, 1, 1), (-10, 1, -10), (10, 10, 1)),
        "9*x1**2 + x2**2 + 9*x3**2",
        [("x1*x2 - 1", 0, None)],
        6.0,
    ),
    35: (
        within((0.5, 0.5, 0.5), (0, 0, 0), (INF, INF, INF)),
        "9 - 8*x1 - 6*x2 - 4*x3 + 2*x1**2 + 2*x2**2 + x3**2 + 2*x1*x2 + 2*x1*x3",
        [("x1 + x2 + 2*x3", None, 3)],
        1 / 9,
    ),
    36: (
        within((10, 10, 10), (0, 0, 0), (20, 11, 42)),
        "-x1*x2*x3",
        [("x1 + 2*x2 + 2*x3", None, 72)],
        -3300.0,
    ),
    39: (
        free(2, 2, 2, 2),
        "-x1",
        [("x2 - x1**3 - x3**2", 0, 0), ("x1**2 - x2 - x4**2", 0, 0)],
        -1.0,
    ),
    40: (
        free(0.8, 0.8, 0.8, 0.8),
        "-x1*x2*x3*x4",
        [("x1**3 + x2**2", 1, 1), ("x1**2*x4 - x3", 0, 0), ("x4**2 - x2", 0, 0)],
        -0.25,
    ),
    43: (
        free(0, 0, 0, 0),
        "x1**2 + x2**2 + 2*x3**2 + x4**2 - 5*x1 - 5*x2 - 21*x3 + 7*x4",
        [
            ("x1**2 + x2**2 + x3**2 + x4**2 + x1 - x2 + x3 - x4", None, 8),
            ("x1**2 + 2*x2**2 + x3**2 + 2*x4**2 - x1 - x4", None, 10),
            ("2*x1**2 + x2**2 + x3**2 + 2*x1 - x2 - x4", None, 5),
        ],
        -44.0,
    ),
    61: (  # the equations have no gradients of their own at the start
        free(0, 0, 0),
        "4*x1**2 + 2*x2**2 + 2*x3**2 - 33*x1 + 16*x2 - 24*x3",
        [("3*x1 - 2*x2**2", 7, 7), ("4*x1 - x3**2", 11, 11)],
        -143.6461422,
    ),
    66: (
        within((0, 1.05, 2.9), (0, 0, 0), (100, 100, 10)),
        "0.2*x3 - 0.8*x1",
        [("x2 - exp(x1)", 0, None), ("x3 - exp(x2)", 0, None)],
        0.5181632741,
    ),
    71: (
        within((1, 5, 5, 1), (1, 1, 1, 1), (5, 5, 5, 5)),
        "x1*x4*(x1 + x2 + x3) + x3",
        [("x1*x2*x3*x4", 25, None), ("x1**2 + x2**2 + x3**2 + x4**2", 40, 40)],
        17.0140173,
    ),
    72: (
        within((1,) * 4, (0.001,) * 4, (4e5, 3e5, 2e5, 1e5)),
        "1 + x1 + x2 + x3 + x4",
        [
            ("4/x1 + 2.25/x2 + 1/x3 + 0.25/x4", None, 0.0401),
            ("0.16/x1 + 0.36/x2 + 0.64/x3 + 0.64/x4", None, 0.010085),
        ],
        727.67937,
    ),
    76: (
        within((0.5,) * 4, (0,) * 4, (INF,) * 4),
        "x1**2 + 0.5*x2**2 + x3**2 + 0.5*x4**2 - x1*x3 + x3*x4 - x1 - 3*x2 + x3 - x4",
        [
            ("x1 + 2*x2 + x3 + x4", None, 5),
            ("3*x1 + x2 + 2*x3 - x4", None, 4),
            ("x2 + 4*x3", 1.5, None),
        ],
        -4.681818181,
    ),
    100: (
        free(1, 2, 0, 4, 0, 1, 1),
        "(x1 - 10)**2 + 5*(x2 - 12)**2 + x3**4 + 3*(x4 - 11)**2 + 10*x5**6 + 7*x6**2 + x7**4"
        " - 4*x6*x7 - 10*x6 - 8*x7",
        [
            ("2*x1**2 + 3*x2**4 + x3 + 4*x4**2 + 5*x5", None, 127),
            ("7*x1 + 3*x2 + 10*x3**2 + x4 - x5", None, 282),
            ("23*x1 + x2**2 + 6*x6**2 - 8*x7", None, 196),
            ("4*x1**2 + x2**2 - 3*x1*x2 + 2*x3**2 + 5*x6 - 11*x7", None, 0),
        ],
        680.6300573,
    ),
}


@pytest.mark.few(6)
@pytest.mark.parametrize(("number", "method"), crossed(CASES, ["slsqp", "ipopt"]))
def test_optimum(number, method):
    variables, objective, limits, least = CASES[number]
    best = solve(variables, objective, limits, method=method)
    assert best.success, best.message
    assert best.fun == pytest.approx(least, rel=1e-6, abs=1e-6)
    assert best.violation <= 1e-6
