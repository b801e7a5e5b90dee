"""What data tell about unknowns: Fisher's information, covariance, and what cannot be told.

``F = JᵀJ`` of residuals in standard deviations; covariance ``F⁻¹``. The singular values of ``J D``,
``D`` the sizes of the unknowns, are the reciprocals of the relative standard deviations along the
singular vectors: a small one is a combination that the data do not show.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

BLIND = 1e-8
"""Singular value, relative to the largest, below which a combination is not seen at all."""
WEAK = 0.2
"""Relative standard deviation from which a combination counts as poorly known."""


@dataclass(frozen=True)
class Combination:
    """A combination of unknowns, and how well the data tell it.

    Attributes
    ----------
    direction : unknown → relative change, of length one
    deviation : relative standard deviation along it; infinite where the data are blind to it
    """

    direction: dict[str, float]
    deviation: float

    def __str__(self) -> str:
        parts = sorted(self.direction.items(), key=lambda item: -abs(item[1]))
        shown = [f"{v:+.2f} Δ{n}/{n}" for n, v in parts if abs(v) >= 0.05]
        how = "not seen at all" if np.isinf(self.deviation) else f"known to {self.deviation:.2g}"
        return f"{' '.join(shown)}: {how}"


@dataclass(frozen=True)
class Information:
    """Singular value decomposition of a Jacobian scaled by the sizes of the unknowns.

    Parameters
    ----------
    labels : of the unknowns
    jacobian : (N, n) of residuals in standard deviations
    sizes : (n,) of the unknowns
    """

    labels: tuple[str, ...]
    jacobian: np.ndarray
    sizes: np.ndarray

    def decomposed(self) -> tuple[np.ndarray, np.ndarray]:
        """(n,) singular values, large ones first, and (n, n) vectors in rows."""
        n = self.sizes.size
        _, s, rows = np.linalg.svd(
            self.jacobian * self.sizes, full_matrices=self.jacobian.shape[0] < n
        )
        return np.append(s, np.zeros(n - s.size)), rows

    def seen(self) -> np.ndarray:
        """(n,) which combinations the data see."""
        s, _ = self.decomposed()
        return s > BLIND * max(float(s[0]), 1e-300)

    def covariance(self, factor: float = 1.0) -> np.ndarray:
        """(n, n) covariance; infinite variance of what takes part in an unseen combination."""
        s, rows = self.decomposed()
        seen = self.seen()
        some = rows[seen] / s[seen, None]
        found = factor * (some.T @ some) * np.outer(self.sizes, self.sizes)
        lost = np.any(abs(rows[~seen]) > 1e-6, axis=0)
        found[lost, :] = found[:, lost] = np.nan
        found[lost, lost] = np.inf
        return found

    def combinations(self, factor: float = 1.0) -> list[Combination]:
        """All combinations, the worst known first."""
        s, rows = self.decomposed()
        made = []
        for value, seen, row in zip(s[::-1], self.seen()[::-1], rows[::-1], strict=True):
            row = row * np.sign(row[np.argmax(abs(row))])
            deviation = float(np.sqrt(factor) / value) if seen else np.inf
            made.append(
                Combination(dict(zip(self.labels, map(float, row), strict=True)), deviation)
            )
        return made

    def determinant(self) -> float:
        """``log det`` of the information over the sizes: what D-optimal designs maximise."""
        s, _ = self.decomposed()
        return float(2 * np.sum(np.log(np.maximum(s, BLIND * max(float(s[0]), 1e-300)))))


def inflation(residual: np.ndarray, loss: str, unknowns: int) -> float:
    """Factor on ``(JᵀJ)⁻¹`` for an M-estimate, ``⟨ψ²⟩/⟨ψ'⟩²`` (Huber, Robust Statistics, 7.6)."""
    z, left = residual**2, max(residual.size - unknowns, 1)
    first, second = _weights(z, loss)
    psi, slope = first * residual, first + 2 * z * second
    return float(np.sum(psi**2) / left / np.mean(slope) ** 2)


def _weights(z: np.ndarray, loss: str) -> tuple[np.ndarray, np.ndarray]:
    """``ρ'`` and ``ρ''`` of SciPy's losses of ``z = r²``."""
    if loss == "soft_l1":
        return (1 + z) ** -0.5, -0.5 * (1 + z) ** -1.5
    if loss == "huber":
        far = np.maximum(z, 1.0)
        return far**-0.5, np.where(z > 1, -0.5 * far**-1.5, 0.0)
    if loss == "cauchy":
        return 1 / (1 + z), -1 / (1 + z) ** 2
    if loss == "arctan":
        return 1 / (1 + z**2), -2 * z / (1 + z**2) ** 2
    return np.ones_like(z), np.zeros_like(z)
