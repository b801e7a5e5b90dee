"""Optima of the usual engineering set, to the digits of the literature.

Three-bar truss (Nowacki 1973), stepped cantilever (Fleury), welded beam and tension spring (Coello
2000, Arora 1989), pressure vessel (Sandgren 1990), speed reducer (Golinski 1973).
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from design_problems import solve

import dalembert as da

R = "sqrt(l**2/4 + ((h + d)/2)**2)"
J = "(2*sqrt(2)*h*l*(l**2/12 + ((h + d)/2)**2))"
FIRST, SECOND = "(6000/(sqrt(2)*h*l))", f"(6000*(14 + l/2)*{R}/{J})"
VESSEL = "0.6224*x1*x3*x4 + 1.7781*x2*x3**2 + 3.1661*x1**2*x4 + 19.84*x1**2*x3"
VESSEL_LIMITS = [
    ("0.0193*x3/x1", None, 1),
    ("0.00954*x3/x2", None, 1),
    ("(pi*x3**2*x4 + 4/3*pi*x3**3)/1296000", 1, None),
]
CASES = {
    "three-bar truss": (
        {"x1": (0.9, 1e-3, 1), "x2": (0.5, 1e-3, 1)},
        "100*(2*sqrt(2)*x1 + x2)",
        [
            ("2*(sqrt(2)*x1 + x2)/(sqrt(2)*x1**2 + 2*x1*x2)", None, 2),
            ("2*x2/(sqrt(2)*x1**2 + 2*x1*x2)", None, 2),
            ("2/(x1 + sqrt(2)*x2)", None, 2),
        ],
        100 * (math.sqrt(2) + math.sqrt(6) / 2),
        ((3 + math.sqrt(3)) / 6, 1 / math.sqrt(6)),
    ),
    "stepped cantilever": (
        {f"x{k}": (5, 0.01, 100) for k in range(1, 6)},
        "0.0624*(x1 + x2 + x3 + x4 + x5)",
        [("61/x1**3 + 37/x2**3 + 19/x3**3 + 7/x4**3 + 1/x5**3", None, 1)],
        1.339956367,
        (6.0160159, 5.3091739, 4.4943296, 3.5014750, 2.15266533),
    ),
    "welded beam": (
        {"h": (0.4, 0.1, 2), "l": (6, 0.1, 10), "d": (9, 0.1, 10), "b": (0.5, 0.1, 2)},
        "1.10471*h**2*l + 0.04811*d*b*(14 + l)",
        [
            (f"sqrt({FIRST}**2 + {FIRST}*{SECOND}*l/{R} + {SECOND}**2)/13600", None, 1),
            ("6*6000*14/(b*d**2)/30000", None, 1),
            ("h/b", None, 1),
            ("4*6000*14**3/(30e6*d**3*b)", None, 0.25),
            ("4.013*30e6*d*b**3/6/14**2*(1 - d/28*sqrt(30/48))/6000", 1, None),
        ],
        1.724852,
        (0.205730, 3.470489, 9.036624, 0.205730),
    ),
    "pressure vessel, continuous": (
        {"x1": (1, 0.0625, 6), "x2": (1, 0.0625, 6), "x3": (50, 10, 200), "x4": (100, 10, 200)},
        VESSEL,
        VESSEL_LIMITS,
        5885.33,
        None,
    ),
    "spring": (
        {"d": (0.06, 0.05, 2), "D": (0.5, 0.25, 1.3), "N": (8, 2, 15)},
        "(N + 2)*D*d**2",
        [
            ("D**3*N/(71785*d**4)", 1, None),
            ("(4*D**2 - d*D)/(12566*(D*d**3 - d**4)) + 1/(5108*d**2)", None, 1),
            ("140.45*d/(D**2*N)", 1, None),
            ("(D + d)/1.5", None, 1),
        ],
        0.012665233,
        (0.0516891, 0.3567177, 11.288966),
    ),
}


@pytest.mark.parametrize("method", ["slsqp", "ipopt"])
@pytest.mark.parametrize("name", CASES)
def test_optimum(name, method):
    variables, objective, limits, least, at = CASES[name]
    best = solve(variables, objective, limits, method=method)
    assert best.success, best.message
    assert best.fun == pytest.approx(least, rel=1e-6)
    assert best.violation <= 1e-6
    if at is not None:
        np.testing.assert_allclose(list(best.x.values()), at, rtol=1e-3)


def test_pressure_vessel_of_plates_that_are_sold():
    """Shell and head in sixteenths of an inch."""
    variables = CASES["pressure vessel, continuous"][0]
    plates = [k / 16 for k in range(1, 97)]
    sizes = [da.Catalogue({"x1": plates}), da.Catalogue({"x2": plates})]
    best = solve(variables, VESSEL, VESSEL_LIMITS, vary=[*sizes, "x3", "x4"])
    assert best.success, best.message
    assert best.fun == pytest.approx(6059.714335048436, rel=1e-6)
    assert (best.x["x1"], best.x["x2"]) == (0.8125, 0.4375)
    assert best.x["x3"] == pytest.approx(42.0984455958549, rel=1e-6)


def test_speed_reducer():
    """Teeth are whole; x5 ≥ 7.3."""
    variables = {
        "x1": (3.1, 2.6, 3.6),
        "x2": (0.75, 0.7, 0.8),
        "x3": (20, 17, 28),
        "x4": (7.8, 7.3, 8.3),
        "x5": (7.8, 7.3, 8.3),
        "x6": (3.4, 2.9, 3.9),
        "x7": (5.25, 5.0, 5.5),
    }
    mass = (
        "0.7854*x1*x2**2*(3.3333*x3**2 + 14.9334*x3 - 43.0934) - 1.508*x1*(x6**2 + x7**2)"
        " + 7.4777*(x6**3 + x7**3) + 0.7854*(x4*x6**2 + x5*x7**2)"
    )
    limits = [
        "27/(x1*x2**2*x3)",
        "397.5/(x1*x2**2*x3**2)",
        "1.93*x4**3/(x2*x3*x6**4)",
        "1.93*x5**3/(x2*x3*x7**4)",
        "sqrt((745*x4/(x2*x3))**2 + 16.9e6)/(110*x6**3)",
        "sqrt((745*x5/(x2*x3))**2 + 157.5e6)/(85*x7**3)",
        "x2*x3/40",
        "5*x2/x1",
        "x1/(12*x2)",
        "(1.5*x6 + 1.9)/x4",
        "(1.1*x7 + 1.9)/x5",
    ]
    vary = [da.Integer("x3") if name == "x3" else name for name in variables]
    best = solve(variables, mass, [(one, None, 1) for one in limits], vary=vary)
    assert best.success, best.message
    assert best.fun == pytest.approx(2994.471, rel=1e-6)
    assert best.x["x3"] == 17 and best.violation <= 1e-6


def test_gear_train():
    """Four numbers of teeth for a ratio of 1/6.931 (Sandgren 1990): all 49⁴ trains compared."""
    variables = {f"x{k}": (30, 12, 60) for k in range(1, 5)}
    best = solve(
        variables,
        "(1/6.931 - x2*x3/(x1*x4))**2",
        vary=[da.Integer(name) for name in variables],
        method="enumeration",
    )
    assert best.success, best.message
    assert best.fun == pytest.approx(2.700857e-12, rel=1e-6)
    assert {best.x["x2"], best.x["x3"]} == {16, 19} and {best.x["x1"], best.x["x4"]} == {43, 49}
    assert best.runs <= 3
