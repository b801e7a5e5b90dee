"""Base class of distributions: random variables ``x(u)`` of a standard normal variable."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import fields, replace

import numpy as np

from dalembert.errors import ModelError
from dalembert.units.measured import check_measured

Values = float | np.ndarray
"""A number, or an array of numbers."""


class Distribution(ABC):
    """A random variable ``x = F⁻¹(Φ(u))``, ``u`` standard normal."""

    @abstractmethod
    def from_normal(self, u: Values) -> Values:
        """``x(u)``."""

    @abstractmethod
    def to_normal(self, x: Values) -> Values:
        """``u(x)``."""

    @abstractmethod
    def slope(self, u: Values) -> Values:
        """``dx/du``."""

    @property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation."""
        u, w = normal_points()
        x = self.from_normal(u)
        mean = float(w @ x)
        return mean, math.sqrt(float(w @ (x - mean) ** 2))

    @property
    def numbers(self) -> dict[str, float]:
        """Parameters of the distribution, name → number."""
        parameters = {f.name: getattr(self, f.name) for f in fields(self)}  # type: ignore[arg-type]
        return {n: v for n, v in parameters.items() if isinstance(v, (int, float))}

    def check_units(self, unit: str, name: str = "") -> None:
        """Check that the units of its numbers fit the unit of the random parameter.

        Raises
        ------
        ExpressionError
            Names the parameter and the value.
        """
        for number, value in self.numbers.items():
            entity = f"{name}.{number}" if name else number
            check_measured([value], "1" if number == "shape" else unit, entity)
        for inner in (getattr(self, f.name) for f in fields(self)):  # type: ignore[arg-type]
            if isinstance(inner, Distribution):
                inner.check_units(unit, name)

    def changes(self, u: float) -> dict[str, float]:
        """Number → derivative of ``x(u)`` by it, by central differences."""
        derivatives = {}
        for name, value in self.numbers.items():
            if math.isfinite(value):
                step = 1e-5 * (abs(value) or self.moments[1])
                ends = [replace(self, **{name: value + s}) for s in (-step, step)]  # type: ignore[type-var]
                low, high = (float(end.from_normal(u)) for end in ends)
                derivatives[name] = (high - low) / (2 * step)
        return derivatives

    def _require(self, condition: bool, requirement: str) -> None:
        if not condition:
            raise ModelError(requirement, repr(self))


def normal_points(count: int = 64) -> tuple[np.ndarray, np.ndarray]:
    """Points and weights of Gauss–Hermite quadrature for ``∫ φ(u) · du``."""
    points, weights = np.polynomial.hermite_e.hermegauss(count)
    return points, weights / weights.sum()


def density(u: Values) -> Values:
    """``φ(u)``."""
    return np.exp(-0.5 * np.square(u)) / math.sqrt(2 * math.pi)
