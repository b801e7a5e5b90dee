"""Frictional contact in one step: which impulses let nothing pass and nothing pull.

    u = H P + b,    0 ≤ u_N ⟂ P_N ≥ 0,    P_T = −μ P_N u_T / |u_T|  or  |P_T| ≤ μ P_N, u_T = 0

for all contacts at once; ``H = W M⁻¹ Wᵀ`` (Acary & Brogliato, Numerical Methods for Nonsmooth
Dynamical Systems, 2008, ch. 13). Restitution is in ``b``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True, eq=False)
class FrictionProblem:
    """Contacts of one step; components of a contact follow each other, the normal one first.

    Attributes
    ----------
    matrix : (n k, n k) ``H``, positive semidefinite
    velocity : (n, k) ``b``
    friction : (n,) ``μ``
    scale : size of the speeds, to which residuals are compared at least
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
        """(n,) change of speed by impulse along the normal, and the largest one along the
        surface."""
        diagonal = self.matrix.diagonal().reshape(self.shape)
        normal = np.where(diagonal[:, 0] > 0, diagonal[:, 0], 1.0)
        along = diagonal[:, 1:].sum(axis=1)
        return normal, np.where(along > 0, along, normal)

    def size(self, impulses: np.ndarray) -> float:
        """Largest speed that takes part, those by which an impulse moves its own contact too."""
        moved = np.linalg.norm(impulses, axis=1) * self.mobility[0]
        return max(self.scale, float(np.nan_to_num(moved).max(initial=0.0)))

    def projected(self, impulses: np.ndarray, speeds: np.ndarray) -> np.ndarray:
        """``proj(P − ρ u)``: the normal part on ``≥ 0``, the other on the disc of ``μ P_N``."""
        normal, along = self.mobility
        pressed = np.maximum(0.0, impulses[:, 0] - speeds[:, 0] / normal)
        rubbed = impulses[:, 1:] - speeds[:, 1:] / along[:, None]
        return np.column_stack([pressed, limited(rubbed, self.friction * pressed)])

    def residual(self, impulses: np.ndarray) -> float:
        """Largest speed by which the conditions are missed, ``|P − proj(P − ρ u)| / ρ``."""
        missed = np.abs(impulses - self.projected(impulses, self.speeds(impulses)))
        normal, along = self.mobility
        sizes = np.column_stack([normal, np.repeat(along[:, None], self.shape[1] - 1, axis=1)])
        worst = (missed * sizes).max(initial=0.0)
        return float(worst) if np.isfinite(impulses).all() else np.inf


def limited(vectors: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """Vectors, none longer than its radius."""
    lengths = np.linalg.norm(vectors, axis=1)
    far = lengths > radii
    shares = np.where(far, radii / np.where(far, lengths, 1.0), 1.0)
    return vectors * shares[:, None]
