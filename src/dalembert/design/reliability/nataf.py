"""Nataf transformation from independent normal to correlated random variables.

``x_i = F_i⁻¹(Φ(z_i))``, ``z = L u``, ``L Lᵀ = R₀``, with the matrix ``R₀`` for which ``x`` has the
prescribed linear correlation (Liu and Der Kiureghian 1986).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from dalembert.design.reliability.distribution import Distribution, normal_points
from dalembert.design.reliability.distributions import Lognormal, Normal
from dalembert.errors import ModelError
from dalembert.text.wording import unknown

Correlation = Mapping[tuple[str, str], float] | np.ndarray | None


@dataclass
class Nataf:
    """Nataf transformation ``u ↦ x`` and its derivative.

    Parameters
    ----------
    random : name → distribution
    correlation : pair of names → linear correlation, or the full matrix
    """

    random: Mapping[str, Distribution]
    correlation: Correlation = None
    factor: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        prescribed = correlation_matrix(list(self.random), self.correlation)
        distributions, n = list(self.random.values()), len(self.random)
        normal = np.eye(n)
        for i in range(n):
            for j in range(i):
                if prescribed[i, j]:
                    value = _normal_correlation(
                        distributions[i], distributions[j], prescribed[i, j], self._pair(i, j)
                    )
                    normal[i, j] = normal[j, i] = value
        check_definite(normal, "of the underlying normal variables")
        self.factor = np.linalg.cholesky(normal)

    def _pair(self, i: int, j: int) -> str:
        names = list(self.random)
        return f"{names[i]} and {names[j]}"

    @property
    def size(self) -> int:
        return len(self.random)

    def values(self, u: np.ndarray) -> np.ndarray:
        """(…, n) ``x`` of (…, n) independent standard normal ``u``."""
        z = u @ self.factor.T
        columns = [d.from_normal(z[..., i]) for i, d in enumerate(self.random.values())]
        return np.stack([np.asarray(c, dtype=float) for c in columns], axis=-1)

    def slopes(self, u: np.ndarray) -> np.ndarray:
        """(n, n) ``∂x/∂u``."""
        z = self.factor @ u
        slopes = [float(d.slope(z[i])) for i, d in enumerate(self.random.values())]
        return np.array(slopes)[:, None] * self.factor

    def normal(self, x: np.ndarray) -> np.ndarray:
        """(n,) ``u`` of ``x``."""
        z = [float(d.to_normal(v)) for d, v in zip(self.random.values(), x, strict=True)]
        return np.linalg.solve(self.factor, np.array(z))


def correlation_matrix(names: list[str], correlation: Correlation) -> np.ndarray:
    """(n, n) linear correlation.

    Raises
    ------
    ModelError
        A name is unknown, or the matrix is not symmetric or not positive definite.
    """
    n = len(names)
    if correlation is None:
        return np.eye(n)
    if isinstance(correlation, Mapping):
        matrix = np.eye(n)
        for pair, value in correlation.items():
            if not (isinstance(pair, tuple) and len(pair) == 2 and pair[0] != pair[1]):
                raise ModelError(f"{pair!r} is not a pair of two names", "correlation")
            for name in pair:
                if name not in names:
                    raise ModelError(unknown("random parameter", name, names), "correlation")
            i, j = map(names.index, pair)
            matrix[i, j] = matrix[j, i] = float(value)
    else:
        matrix = np.asarray(correlation, dtype=float)
        if matrix.shape != (n, n):
            raise ModelError(f"has shape {matrix.shape}; it needs ({n}, {n})", "correlation")
        if not (np.allclose(matrix, matrix.T) and np.allclose(np.diag(matrix), 1)):
            raise ModelError("must be symmetric with ones on its diagonal", "correlation")
    if not np.all(np.isfinite(matrix)):
        raise ModelError("contains NaN or infinite values", "correlation")
    check_definite(matrix, "given")
    return matrix


def check_definite(matrix: np.ndarray, which: str) -> None:
    """Check that a correlation matrix is positive definite.

    Raises
    ------
    ModelError
        The matrix is not positive definite; the message contains its smallest eigenvalue.
    """
    smallest = float(np.linalg.eigvalsh(matrix)[0])
    if smallest <= 1e-12:
        raise ModelError(
            f"the matrix {which} is not positive definite (smallest eigenvalue {smallest:.3g}): no "
            "variables have these correlations; reduce them",
            "correlation",
        )


def _normal_correlation(a: Distribution, b: Distribution, prescribed: float, pair: str) -> float:
    """Correlation of the normal variables for a prescribed correlation of two variables."""
    if isinstance(a, Normal) and isinstance(b, Normal):
        return prescribed
    if isinstance(a, Lognormal) and isinstance(b, Lognormal):
        (_, s), (_, r) = a.logarithm, b.logarithm
        ratio = prescribed * (a.std / a.mean) * (b.std / b.mean)
        if ratio > -1 and abs(value := float(np.log1p(ratio)) / (s * r)) < 1:
            return value
    from scipy.optimize import brentq

    largest = 1 - 1e-9
    low, high = (_correlation(a, b, r) for r in (-largest, largest))
    if not low < prescribed < high:
        raise ModelError(
            f"{pair} cannot have a correlation of {prescribed:g}; with their distributions it lies "
            f"between {low:.4g} and {high:.4g}",
            "correlation",
        )
    return float(
        brentq(lambda r: _correlation(a, b, r) - prescribed, -largest, largest, xtol=1e-13)
    )


def _correlation(a: Distribution, b: Distribution, normal: float) -> float:
    """Correlation of two variables for a correlation of the underlying normal variables."""
    u, w = normal_points()
    (mean_a, std_a), (mean_b, std_b) = a.moments, b.moments
    other = normal * u[:, None] + np.sqrt(1 - normal**2) * u
    first, second = (a.from_normal(u) - mean_a) / std_a, (b.from_normal(other) - mean_b) / std_b
    return float((w * first) @ (second @ w))
