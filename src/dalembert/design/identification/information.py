"""Fisher information: covariance, identifiable combinations and D-optimal experiments.

``F = JᵀJ`` of residuals in standard deviations; covariance ``F⁻¹``. The singular values of ``J D``,
``D`` the scales of the unknowns, are the reciprocals of the relative standard deviations along the
singular vectors: a small one belongs to a combination that the data do not determine.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dalembert.design.identification.misfit import Misfit, Unknowns
from dalembert.errors import AnalysisError

SINGULAR = 1e-8
"""Threshold of the relative singular value of an undetermined combination [-]."""
WEAK = 0.2
"""Threshold of the relative standard deviation of a poorly determined combination [-]."""


@dataclass(frozen=True)
class Combination:
    """Combination of unknowns and its uncertainty.

    Attributes
    ----------
    direction : unknown → relative change, of unit length
    deviation : relative standard deviation along it; infinite if the data do not determine it
    """

    direction: dict[str, float]
    deviation: float

    def __str__(self) -> str:
        parts = sorted(self.direction.items(), key=lambda item: -abs(item[1]))
        terms = [f"{v:+.2f} Δ{n}/{n}" for n, v in parts if abs(v) >= 0.05]
        certainty = (
            "not determined"
            if np.isinf(self.deviation)
            else f"relative deviation {self.deviation:.2g}"
        )
        return f"{' '.join(terms)}: {certainty}"


@dataclass(frozen=True)
class Information:
    """Singular value decomposition of a Jacobian scaled by the unknowns.

    Parameters
    ----------
    labels : of the unknowns
    jacobian : (N, n) of residuals in standard deviations
    sizes : (n,) scales of the unknowns
    """

    labels: tuple[str, ...]
    jacobian: np.ndarray
    sizes: np.ndarray

    def decompose(self) -> tuple[np.ndarray, np.ndarray]:
        """(n,) singular values in descending order, and (n, n) singular vectors in rows."""
        n = self.sizes.size
        _, s, rows = np.linalg.svd(
            self.jacobian * self.sizes, full_matrices=self.jacobian.shape[0] < n
        )
        return np.append(s, np.zeros(n - s.size)), rows

    def determined(self) -> np.ndarray:
        """(n,) mask of the combinations that the data determine."""
        s, _ = self.decompose()
        return s > SINGULAR * max(float(s[0]), 1e-300)

    def covariance(self, factor: float = 1.0) -> np.ndarray:
        """(n, n) covariance; infinite variance of unknowns in an undetermined combination."""
        s, rows = self.decompose()
        determined = self.determined()
        scaled_rows = rows[determined] / s[determined, None]
        covariance = factor * (scaled_rows.T @ scaled_rows) * np.outer(self.sizes, self.sizes)
        undetermined = np.any(abs(rows[~determined]) > 1e-6, axis=0)
        covariance[undetermined, :] = covariance[:, undetermined] = np.nan
        covariance[undetermined, undetermined] = np.inf
        return covariance

    def combinations(self, factor: float = 1.0) -> list[Combination]:
        """All combinations, the most uncertain first."""
        s, rows = self.decompose()
        combinations = []
        for value, determined, row in zip(
            s[::-1], self.determined()[::-1], rows[::-1], strict=True
        ):
            row = row * np.sign(row[np.argmax(abs(row))])
            deviation = float(np.sqrt(factor) / value) if determined else np.inf
            combinations.append(
                Combination(dict(zip(self.labels, map(float, row), strict=True)), deviation)
            )
        return combinations

    def determinant(self) -> float:
        """``log det`` of the scaled information, which D-optimal designs maximise."""
        s, _ = self.decompose()
        return float(2 * np.sum(np.log(np.maximum(s, SINGULAR * max(float(s[0]), 1e-300)))))


def inflation(residual: np.ndarray, loss: str, unknowns: int) -> float:
    """Factor on ``(JᵀJ)⁻¹`` for an M-estimate, ``⟨ψ²⟩/⟨ψ'⟩²`` (Huber, Robust Statistics, 7.6)."""
    z, freedom = residual**2, max(residual.size - unknowns, 1)
    first, second = _loss_derivatives(z, loss)
    psi, slope = first * residual, first + 2 * z * second
    return float(np.sum(psi**2) / freedom / np.mean(slope) ** 2)


def _loss_derivatives(z: np.ndarray, loss: str) -> tuple[np.ndarray, np.ndarray]:
    """``ρ'`` and ``ρ''`` of SciPy's losses of ``z = r²``."""
    if loss == "soft_l1":
        return (1 + z) ** -0.5, -0.5 * (1 + z) ** -1.5
    if loss == "huber":
        clipped = np.maximum(z, 1.0)
        return clipped**-0.5, np.where(z > 1, -0.5 * clipped**-1.5, 0.0)
    if loss == "cauchy":
        return 1 / (1 + z), -1 / (1 + z) ** 2
    if loss == "arctan":
        return 1 / (1 + z**2), -2 * z / (1 + z**2) ** 2
    return np.ones_like(z), np.zeros_like(z)


def rank_experiments(
    misfit: Misfit,
    before: Information,
    x: np.ndarray,
    factor: float,
    candidates: Mapping[str, Mapping[str, float]],
) -> list[dict[str, Any]]:
    """Rank candidate experiments; see ``IdentificationResult.advise``."""
    rows = []
    for name, parameters in candidates.items():
        jacobian = _candidate_jacobian(misfit, x, name, parameters)
        after = Information(before.labels, np.vstack([before.jacobian, jacobian]), before.sizes)
        deviation = np.sqrt(np.diag(after.covariance(factor)))
        rows.append(
            {
                "name": name,
                "gain": after.determinant() - before.determinant(),
                "deviation": dict(zip(before.labels, map(float, deviation), strict=True)),
            }
        )
    return sorted(rows, key=lambda row: -row["gain"])


def _candidate_jacobian(
    misfit: Misfit, x: np.ndarray, name: str, parameters: Mapping[str, float]
) -> np.ndarray:
    """(N, n) Jacobian of the first experiment repeated with other parameters."""
    first = misfit.observations[0]
    for parameter in parameters:
        if parameter in misfit.unknowns.where[0]:
            raise AnalysisError(
                f"candidate {name!r} sets {parameter!r}, which is unknown; leave it out"
            )
    all_parameters = {**first.experiment.parameters, **parameters}
    observation = replace(
        first, name=name, experiment=replace(first.experiment, parameters=all_parameters)
    )
    shared = misfit.unknowns
    unknowns = Unknowns(
        shared.labels, shared.start, shared.lower, shared.upper, shared.where[:1], shared.delays
    )
    single = Misfit(misfit.model, [observation], unknowns)
    single.noise = [misfit.noise[0]]
    return single.jacobian(x)
