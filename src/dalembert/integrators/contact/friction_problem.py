"""Frictional contact problem of one step: nonpenetration and Coulomb friction.

    u = H P + b,    0 ≤ u_N ⟂ P_N ≥ 0,    P_T = −μ P_N u_T / |u_T|  or  |P_T| ≤ μ P_N, u_T = 0

for all contacts together; ``H = W M⁻¹ Wᵀ`` (Acary & Brogliato, Numerical Methods for Nonsmooth
Dynamical Systems, 2008, ch. 13). Restitution is included in ``b``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True, eq=False)
class FrictionProblem:
    """Frictional contact problem; components of each contact are consecutive, normal first.

    Attributes
    ----------
    matrix : (n k, n k) ``H``, positive semidefinite
    velocity : (n, k) ``b``
    friction : (n,) ``μ``
    scale : lower limit of the speed that residuals are compared with [m/s]
    """

    matrix: np.ndarray
    velocity: np.ndarray
    friction: np.ndarray
    scale: float = 1.0

    @property
    def shape(self) -> tuple[int, int]:
        """Number of contacts, components of each."""
        return self.velocity.shape  # type: ignore[return-value]

    def speeds(self, impulses: np.ndarray) -> np.ndarray:
        """(n, k) ``u``."""
        return (self.matrix @ impulses.ravel()).reshape(self.shape) + self.velocity

    @cached_property
    def mobility(self) -> tuple[np.ndarray, np.ndarray]:
        """(n,) change of speed per impulse in normal direction, and its upper bound in tangential
        directions."""
        diagonal = self.matrix.diagonal().reshape(self.shape)
        normal = np.where(diagonal[:, 0] > 0, diagonal[:, 0], 1.0)
        along = diagonal[:, 1:].sum(axis=1)
        return normal, np.where(along > 0, along, normal)

    def size(self, impulses: np.ndarray) -> float:
        """Reference speed: the scale or the largest change of speed of a contact by its impulse."""
        changes = np.linalg.norm(impulses, axis=1) * self.mobility[0]
        return max(self.scale, float(np.nan_to_num(changes).max(initial=0.0)))

    def project(self, impulses: np.ndarray, speeds: np.ndarray) -> np.ndarray:
        """``proj(P − ρ u)``: normal part onto ``≥ 0``, tangential part onto the disc ``μ P_N``."""
        normal, along = self.mobility
        pressure = np.maximum(0.0, impulses[:, 0] - speeds[:, 0] / normal)
        tangential = impulses[:, 1:] - speeds[:, 1:] / along[:, None]
        return np.column_stack([pressure, clip_lengths(tangential, self.friction * pressure)])

    def residual(self, impulses: np.ndarray) -> float:
        """Largest violation of the conditions as a speed, ``|P − proj(P − ρ u)| / ρ``."""
        violation = np.abs(impulses - self.project(impulses, self.speeds(impulses)))
        normal, along = self.mobility
        sizes = np.column_stack([normal, np.repeat(along[:, None], self.shape[1] - 1, axis=1)])
        worst = (violation * sizes).max(initial=0.0)
        return float(worst) if np.isfinite(impulses).all() else np.inf


def clip_lengths(vectors: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """Vectors shortened to their radii."""
    lengths = np.linalg.norm(vectors, axis=1)
    outside = lengths > radii
    factors = np.where(outside, radii / np.where(outside, lengths, 1.0), 1.0)
    return vectors * factors[:, None]
