"""Sums of products, the normal form in which equations are simplified and printed.

A sum maps products to coefficients, a product lists factors with their powers, and a factor is a
symbol or a function of sums.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property, reduce

import numpy as np

from dalembert.errors import UnsupportedError

MOST_TERMS = 400
"""Upper limit of the terms of an expression."""
ROUNDING = 1e-14
"""Threshold for coefficients that cancel, relative to the terms of the sum."""
FUNCTIONS: dict[str, Callable[..., float]] = {
    "abs": abs,
    "acos": math.acos,
    "acosh": math.acosh,
    "and": lambda a, b: float(bool(a) and bool(b)),
    "asin": math.asin,
    "asinh": math.asinh,
    "atan": math.atan,
    "atan2": math.atan2,
    "atanh": math.atanh,
    "copysign": math.copysign,
    "cos": math.cos,
    "cosh": math.cosh,
    "eq": lambda a, b: float(a == b),
    "erf": math.erf,
    "exp": math.exp,
    "floor": math.floor,
    "if": lambda a, b: b if a else 0.0,
    "le": lambda a, b: float(a <= b),
    "log": math.log,
    "lt": lambda a, b: float(a < b),
    "max": max,
    "min": min,
    "ne": lambda a, b: float(a != b),
    "not": lambda a: float(not a),
    "or": lambda a, b: float(bool(a) or bool(b)),
    "pow": lambda a, b: a**b,
    "sign": lambda a: float(np.sign(a)),
    "sin": math.sin,
    "sinh": math.sinh,
    "sqrt": math.sqrt,
    "sum": lambda a: a,
    "tan": math.tan,
    "tanh": math.tanh,
}
"""Functions of factors; ``sum`` is a sum in brackets, ``if`` a value under a condition."""


@dataclass(frozen=True)
class Factor:
    """A symbol, or a function of sums.

    Attributes
    ----------
    name : of the symbol or of the function
    arguments : empty for a symbol
    """

    name: str
    arguments: tuple[Sum, ...] = ()

    @cached_property
    def key(self) -> str:
        """Text that identifies and orders factors."""
        return (
            f"{self.name}({','.join(a.key for a in self.arguments)})"
            if self.arguments
            else self.name
        )

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Factor) and self.key == other.key

    def value(self, values: Mapping[str, float]) -> float:
        """Value for values of the symbols."""
        if not self.arguments:
            return values[self.name]
        return FUNCTIONS[self.name](*(a.value(values) for a in self.arguments))


Product = tuple[tuple[Factor, int], ...]
"""Factors in their order, with powers."""


def product(factors: Mapping[Factor, int]) -> Product:
    """Factors with nonzero powers, ordered."""
    entries = ((factor, power) for factor, power in factors.items() if power)
    return tuple(sorted(entries, key=lambda entry: entry[0].key))


def _include(terms: dict[Product, float], more: Mapping[Product, float]) -> None:
    """Add terms in place, without those that cancel."""
    for factors, coefficient in more.items():
        total = terms.get(factors, 0.0) + coefficient
        if abs(total) <= ROUNDING * (abs(coefficient) + abs(total - coefficient)):
            terms.pop(factors, None)
        else:
            terms[factors] = total
    if len(terms) > MOST_TERMS:
        raise UnsupportedError(f"an expression has more than {MOST_TERMS} terms")


class Sum:
    """Products with their coefficients.

    Parameters
    ----------
    terms : product → coefficient

    Examples
    --------
    >>> from dalembert.io.exports.latex.sums import Sum
    >>> x, y = Sum.symbol("x"), Sum.symbol("y")
    >>> ((x + y) * (x - y)).key
    '1.0*x^2+-1.0*y^2'
    """

    def __init__(self, terms: Mapping[Product, float]):
        size = max(map(abs, terms.values()), default=0.0)
        self.terms = {p: c for p, c in terms.items() if abs(c) > ROUNDING * size}
        if len(self.terms) > MOST_TERMS:
            raise UnsupportedError(f"an expression has more than {MOST_TERMS} terms")

    @classmethod
    def number(cls, value: float) -> Sum:
        """A number."""
        return cls({(): value} if value else {})

    @classmethod
    def symbol(cls, name: str) -> Sum:
        """A symbol."""
        return cls({((Factor(name), 1),): 1.0})

    @classmethod
    def of(cls, factor: Factor, power: int = 1) -> Sum:
        """A factor with a power."""
        return cls({((factor, power),): 1.0})

    @cached_property
    def key(self) -> str:
        """Text that identifies the sum."""
        parts = []
        for factors, coefficient in sorted(self.terms.items(), key=lambda term: _key(term[0])):
            parts.append(f"{coefficient!r}*{_key(factors)}")
        return "+".join(parts)

    @property
    def constant(self) -> float | None:
        """Its value if it is a number, else None."""
        if not self.terms:
            return 0.0
        return self.terms[()] if list(self.terms) == [()] else None

    @property
    def size(self) -> int:
        """Number of terms, those in arguments included."""
        inner = sum(a.size for factors in self.terms for f, _ in factors for a in f.arguments)
        return len(self.terms) + inner

    def value(self, values: Mapping[str, float]) -> float:
        """Value for values of the symbols."""
        total = 0.0
        for factors, coefficient in self.terms.items():
            parts = (factor.value(values) ** power for factor, power in factors)
            total += reduce(lambda a, b: a * b, parts, coefficient)
        return total

    def __add__(self, other: Sum) -> Sum:
        terms = dict(self.terms)
        _include(terms, other.terms)
        return Sum(terms)

    def scaled(self, factor: float) -> Sum:
        """The sum times a number."""
        return Sum({p: factor * c for p, c in self.terms.items()} if factor else {})

    def __neg__(self) -> Sum:
        return self.scaled(-1.0)

    def __sub__(self, other: Sum) -> Sum:
        return self + (-other)

    def __mul__(self, other: Sum) -> Sum:
        if len(self.terms) * len(other.terms) > MOST_TERMS**2 / 4:
            raise UnsupportedError(f"an expression has more than {MOST_TERMS} terms")
        total: dict[Product, float] = {}
        for first, a in self.terms.items():
            row: dict[Product, float] = {}
            for second, b in other.terms.items():
                factors = dict(first)
                for factor, power in second:
                    factors[factor] = factors.get(factor, 0) + power
                key = product(factors)
                row[key] = row.get(key, 0.0) + a * b
            _include(total, row)
        return Sum(total)

    def inverse(self) -> Sum:
        """One over the sum."""
        if len(self.terms) == 1:
            ((factors, coefficient),) = self.terms.items()
            return Sum({product({f: -power for f, power in factors}): 1 / coefficient})
        return Sum.of(Factor("sum", (self,)), -1)

    def power(self, exponent: float) -> Sum:
        """The sum to the power of a number."""
        if exponent == int(exponent) and abs(exponent) <= 4:
            base = self if exponent > 0 else self.inverse()
            return reduce(lambda a, b: a * b, [base] * abs(int(exponent)), Sum.number(1.0))
        if exponent == 0.5:
            return function("sqrt", self)
        return function("pow", self, Sum.number(exponent))


def function(name: str, *arguments: Sum) -> Sum:
    """A function of sums; sines and cosines of negative arguments are those of positive ones."""
    constants = [argument.constant for argument in arguments]
    if all(value is not None for value in constants):
        return Sum.number(float(FUNCTIONS[name](*constants)))
    if name in ("sin", "cos") and _leading(arguments[0]) < 0:
        flipped = Sum.of(Factor(name, (-arguments[0],)))
        return -flipped if name == "sin" else flipped
    return Sum.of(Factor(name, arguments))


def _leading(argument: Sum) -> float:
    """Coefficient of the first term."""
    return min(argument.terms.items(), key=lambda term: _key(term[0]))[1]


def _key(factors: Iterable[tuple[Factor, int]]) -> str:
    return "·".join(f.key if power == 1 else f"{f.key}^{power}" for f, power in factors)
