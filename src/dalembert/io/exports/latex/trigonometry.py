"""Simplification of sums by the theorems of trigonometry."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from dalembert.io.exports.latex.sums import Factor, Product, Sum, function, product

EQUAL = 1e-12
"""Relative difference of coefficients below which they are equal."""


def simplified(total: Sum) -> Sum:
    """The sum with squares of sines and cosines, and products of them, combined.

    ``sin² + cos² = 1``, ``cos a cos b ± sin a sin b = cos(a ∓ b)``, ``sin a cos b ± cos a sin b =
    sin(a ± b)``; every step reduces the number of terms.
    """
    while True:
        shorter = next(_steps(total), None)
        if shorter is None:
            return total
        total = shorter


def _steps(total: Sum) -> Iterator[Sum]:
    """Shorter sums, by one step."""
    for factors, coefficient in total.terms.items():
        waves = [(f, power) for f, power in factors if f.name in ("sin", "cos") and power > 0]
        for factor, power in waves:
            if power >= 2:
                yield from _squares(total, factors, coefficient, factor)
        for (first, _), (second, _) in itertools.combinations(waves, 2):
            if first.arguments[0].key != second.arguments[0].key:
                yield from _addition(total, factors, coefficient, first, second)


def _squares(total: Sum, factors: Product, coefficient: float, wave: Factor) -> Iterator[Sum]:
    """``c R sin² + c R cos² = c R``, and ``c R − c R cos² = c R sin²``."""
    other = Factor("cos" if wave.name == "sin" else "sin", wave.arguments)
    rest = _with(factors, {wave: -2})
    partner = _with(rest, {other: 2})
    if _equal(total.terms.get(partner, 0.0), coefficient):
        yield _replaced(total, [factors, partner], Sum({rest: coefficient}))
    elif _equal(total.terms.get(rest, 0.0), -coefficient):
        yield _replaced(total, [factors, rest], Sum({partner: -coefficient}))


def _addition(
    total: Sum, factors: Product, coefficient: float, first: Factor, second: Factor
) -> Iterator[Sum]:
    """The theorems of addition."""
    swapped = [Factor("cos" if f.name == "sin" else "sin", f.arguments) for f in (first, second)]
    rest = _with(factors, {first: -1, second: -1})
    partner = _with(rest, {swapped[0]: 1, swapped[1]: 1})
    value = total.terms.get(partner, 0.0)
    sign = 1 if _equal(value, coefficient) else -1 if _equal(value, -coefficient) else 0
    if not sign or partner == factors:
        return
    a, b = first.arguments[0], second.arguments[0]
    base = Sum({rest: coefficient})
    if first.name == second.name:
        # cos a cos b + s sin a sin b = cos(a − s b), and with sines first s times that
        wave = function("cos", a - b.scaled(sign))
        combined = base * wave if first.name == "cos" else base * wave.scaled(sign)
    elif first.name == "sin":
        combined = base * function("sin", a + b.scaled(sign))
    else:
        combined = base * function("sin", b + a.scaled(sign))
    yield _replaced(total, [factors, partner], combined)


def _with(factors: Product, changes: dict[Factor, int]) -> Product:
    powers = dict(factors)
    for factor, change in changes.items():
        powers[factor] = powers.get(factor, 0) + change
    return product(powers)


def _replaced(total: Sum, removed: list[Product], added: Sum) -> Sum:
    terms = {p: c for p, c in total.terms.items() if p not in removed}
    return Sum(terms) + added


def _equal(a: float, b: float) -> bool:
    return bool(a) and abs(a - b) <= EQUAL * abs(b)
