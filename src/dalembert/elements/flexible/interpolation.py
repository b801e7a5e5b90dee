"""Lagrange polynomials on the unit interval and Gauss points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import leggauss


@dataclass(frozen=True)
class Lagrange:
    """Polynomials ``N_k`` through equally spaced nodes ``ξ_k = k/p`` of an element of order p."""

    order: int

    @cached_property
    def nodes(self) -> np.ndarray:
        """(p + 1,) coordinates of the nodes."""
        return np.linspace(0.0, 1.0, self.order + 1)

    @cached_property
    def shapes(self) -> list[Polynomial]:
        """``N_k``, one at its node and zero at the others."""
        return _through(self.nodes)

    def values(self, at: np.ndarray) -> np.ndarray:
        """(m, p + 1) ``N_k(ξ)``."""
        return np.stack([shape(at) for shape in self.shapes], axis=1)

    def slopes(self, at: np.ndarray) -> np.ndarray:
        """(m, p + 1) ``dN_k/dξ``."""
        return np.stack([shape.deriv()(at) for shape in self.shapes], axis=1)

    @cached_property
    def products(self) -> np.ndarray:
        """(p + 1, p + 1) ``∫ N_k N_l dξ``."""
        at, weights = gauss(self.order + 1)
        values = self.values(at)
        return values.T @ (weights[:, None] * values)

    @cached_property
    def shares(self) -> np.ndarray:
        """(p + 1,) ``∫ N_k dξ``."""
        return self.products.sum(axis=1)


def gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """(m,) Gauss–Legendre points on the unit interval, and their weights."""
    at, weights = leggauss(count)
    return (at + 1) / 2, weights / 2


def through(points: np.ndarray, at: float) -> np.ndarray:
    """(m,) weights of the values at ``points`` in their interpolating polynomial at ``at``."""
    return np.array([shape(at) for shape in _through(points)])


def _through(points: np.ndarray) -> list[Polynomial]:
    polynomials = []
    for k, node in enumerate(points):
        others = np.delete(points, k)
        shape = Polynomial.fromroots(others) if others.size else Polynomial([1.0])
        polynomials.append(shape / shape(node))
    return polynomials
