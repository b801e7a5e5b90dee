"""Nataf's transformation: correlated random variables as functions of independent normal ones.

``x_i = F_i⁻¹(Φ(z_i))``, ``z = L u``, where ``L Lᵀ = R₀`` and ``R₀`` is such that ``x`` has the
wanted linear correlation (Liu and Der Kiureghian 1986).
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
    """``u ↦ x`` and its derivative.

    Parameters
    ----------
    random : name → distribution
    correlation : pair of names → linear correlation, or the whole matrix
    """

    random: Mapping[str, Distribution]
    correlation: Correlation = None
    factor: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        wanted = correlation_matrix(list(self.random), self.correlation)
        listed, n = list(self.random.values()), len(self.random)
        normal = np.eye(n)
        for i in range(n):
            for j in range(i):
                if wanted[i, j]:
                    found = _of_normal(listed[i], listed[j], wanted[i, j], self._pair(i, j))
                    normal[i, j] = normal[j, i] = found
        refuse_indefinite(normal, "of the normal variables behind it")
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


def correlation_matrix(names: list[str], given: Correlation) -> np.ndarray:
    """(n, n) linear correlation.

    Raises
    ------
    ModelError
        Not a correlation: unknown names, not symmetric, or not positive definite.
    """
    n = len(names)
    if given is None:
        return np.eye(n)
    if isinstance(given, Mapping):
        made = np.eye(n)
        for pair, value in given.items():
            if not (isinstance(pair, tuple) and len(pair) == 2 and pair[0] != pair[1]):
                raise ModelError(f"{pair!r} is no pair of two names", "correlation")
            for name in pair:
                if name not in names:
                    raise ModelError(unknown("random parameter", name, names), "correlation")
            i, j = map(names.index, pair)
            made[i, j] = made[j, i] = float(value)
    else:
        made = np.asarray(given, dtype=float)
        if made.shape != (n, n):
            raise ModelError(f"has shape {made.shape}; it needs ({n}, {n})", "correlation")
        if not (np.allclose(made, made.T) and np.allclose(np.diag(made), 1)):
            raise ModelError("must be symmetric with ones on its diagonal", "correlation")
    if not np.all(np.isfinite(made)):
        raise ModelError("holds numbers that are none", "correlation")
    refuse_indefinite(made, "given")
    return made


def refuse_indefinite(matrix: np.ndarray, which: str) -> None:
    """A correlation matrix is positive definite.

    Raises
    ------
    ModelError
        With its smallest eigenvalue.
    """
    least = float(np.linalg.eigvalsh(matrix)[0])
    if least <= 1e-12:
        raise ModelError(
            f"the matrix {which} is not positive definite (smallest eigenvalue {least:.3g}): no "
            "variables can be correlated so; make the correlations smaller",
            "correlation",
        )


def _of_normal(a: Distribution, b: Distribution, wanted: float, pair: str) -> float:
    """Correlation of the normal variables with which two others have the wanted one."""
    if isinstance(a, Normal) and isinstance(b, Normal):
        return wanted
    if isinstance(a, Lognormal) and isinstance(b, Lognormal):
        (_, s), (_, r) = a.logarithm, b.logarithm
        ratio = wanted * (a.std / a.mean) * (b.std / b.mean)
        if ratio > -1 and abs(found := float(np.log1p(ratio)) / (s * r)) < 1:
            return found
    from scipy.optimize import brentq

    reach = 1 - 1e-9
    low, high = (_correlation(a, b, r) for r in (-reach, reach))
    if not low < wanted < high:
        raise ModelError(
            f"{pair} cannot have a correlation of {wanted:g}; with their distributions it lies "
            f"between {low:.4g} and {high:.4g}",
            "correlation",
        )
    return float(brentq(lambda r: _correlation(a, b, r) - wanted, -reach, reach, xtol=1e-13))


def _correlation(a: Distribution, b: Distribution, normal: float) -> float:
    """Correlation of two variables whose normal ones have this correlation."""
    u, w = normal_points()
    (mean_a, std_a), (mean_b, std_b) = a.moments, b.moments
    other = normal * u[:, None] + np.sqrt(1 - normal**2) * u
    first, second = (a.from_normal(u) - mean_a) / std_a, (b.from_normal(other) - mean_b) / std_b
    return float((w * first) @ (second @ w))
