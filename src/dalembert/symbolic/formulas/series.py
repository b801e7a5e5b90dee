"""Power series that stand for functions of an angle near zero, where these are 0/0."""

from __future__ import annotations

from collections.abc import Sequence
from math import factorial

import casadi as ca

TERMS = 10
"""Of series in the square of an angle, exact to rounding for turns by up to 1.5 rad."""


def power_series(argument: ca.SX, factors: Sequence[float]) -> ca.SX:
    """``Σ cₖ xᵏ`` by Horner's rule."""
    total = ca.SX(0)
    for factor in reversed(factors):
        total = total * argument + factor
    return total


def alternating(square: ca.SX, first: int) -> ca.SX:
    """``Σ (−θ²)^k / (2k + first)!`` of ``θ²``: ``sin θ/θ``, ``(1 − cos θ)/θ²``, …"""
    factors = [(-1) ** k / factorial(2 * k + first) for k in range(TERMS)]
    return power_series(square, factors)


def angle_over_sine(versine: ca.SX, terms: int) -> ca.SX:
    """``θ/sin θ`` of ``1 − cos θ``."""
    factors = [2**k * factorial(k) ** 2 / factorial(2 * k + 1) for k in range(terms)]
    return power_series(versine, factors)
