"""A random variable as a function ``x(u)`` of a standard normal one."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import fields, replace
from typing import Any

import numpy as np

from dalembert.errors import ModelError


class Distribution(ABC):
    """A random variable ``x = F⁻¹(Φ(u))``, ``u`` standard normal."""

    @abstractmethod
    def from_normal(self, u: Any) -> Any:
        """``x(u)``."""

    @abstractmethod
    def to_normal(self, x: Any) -> Any:
        """``u(x)``."""

    @abstractmethod
    def slope(self, u: Any) -> Any:
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
        """Name → number of what describes it."""
        every = {f.name: getattr(self, f.name) for f in fields(self)}  # type: ignore[arg-type]
        return {n: v for n, v in every.items() if isinstance(v, (int, float))}

    def changes(self, u: float) -> dict[str, float]:
        """Number → derivative of ``x(u)`` by it, by central differences."""
        made = {}
        for name, value in self.numbers.items():
            if math.isfinite(value):
                step = 1e-5 * (abs(value) or self.moments[1])
                ends = [replace(self, **{name: value + s}) for s in (-step, step)]  # type: ignore[type-var]
                low, high = (float(end.from_normal(u)) for end in ends)
                made[name] = (high - low) / (2 * step)
        return made

    def _need(self, right: bool, what: str) -> None:
        if not right:
            raise ModelError(f"{what}", repr(self))


def normal_points(count: int = 64) -> tuple[np.ndarray, np.ndarray]:
    """Points and weights of ``∫ φ(u) · du``, by Gauss and Hermite."""
    points, weights = np.polynomial.hermite_e.hermegauss(count)
    return points, weights / weights.sum()


def density(u: Any) -> Any:
    """``φ(u)``."""
    return np.exp(-0.5 * np.square(u)) / math.sqrt(2 * math.pi)
