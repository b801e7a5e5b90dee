"""Possible contacts of a step, and their frictional contact problem.

    u = H P + b,    0 ≤ u_N ⟂ P_N ≥ 0,    P_T = −μ P_N u_T / |u_T|  or  |P_T| ≤ μ P_N, u_T = 0

for all contacts together; ``H = W M⁻¹ Wᵀ`` (Acary & Brogliato, Numerical Methods for Nonsmooth
Dynamical Systems, 2008, ch. 13). Restitution is included in ``b``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from dalembert.integrators.contact.delassus import Delassus
from dalembert.symbolic.evaluation.kernel import Matrix


@dataclass(frozen=True, eq=False)
class Contacts:
    """Gaps that may close in a step; components of each gap are consecutive, normal first.

    Attributes
    ----------
    distance : (n,) ``g``
    directions : (n k, n_v) ``W``, so that the relative velocity is ``u = W v + w``
    drift : (n, k) ``w``, from motions prescribed in time [m/s]
    restitution, tangential, friction : (n,) coefficients of the impact law [-]
    key : (n,) integer that identifies a gap from step to step
    owner : (n,) number of the element of the gap
    """

    distance: np.ndarray
    directions: Matrix
    drift: np.ndarray
    restitution: np.ndarray
    tangential: np.ndarray
    friction: np.ndarray
    key: np.ndarray
    owner: np.ndarray

    @property
    def count(self) -> int:
        """Number of gaps."""
        return self.distance.size

    def speeds(self, v: np.ndarray) -> np.ndarray:
        """(n, k) ``u`` for speeds ``v`` of the model."""
        return (self.directions @ v).reshape(self.drift.shape) + self.drift

    def some(self, selected: np.ndarray) -> Contacts:
        """The selected gaps."""
        k = self.drift.shape[1]
        rows = (np.arange(self.count)[selected][:, None] * k + np.arange(k)).ravel()
        return Contacts(
            self.distance[selected],
            self.directions[rows],
            self.drift[selected],
            self.restitution[selected],
            self.tangential[selected],
            self.friction[selected],
            self.key[selected],
            self.owner[selected],
        )

    @classmethod
    def joined(cls, parts: list[Contacts]) -> Contacts:
        """Gaps of several sources."""
        if len(parts) == 1:
            return parts[0]
        columns = zip(
            *(
                (p.distance, p.drift, p.restitution, p.tangential, p.friction, p.key, p.owner)
                for p in parts
            ),
            strict=True,
        )
        distance, drift, *coefficients = (np.concatenate(column) for column in columns)
        rows = [p.directions for p in parts]
        if any(scipy.sparse.issparse(part) for part in rows):
            stacked: Matrix = scipy.sparse.csr_array(scipy.sparse.vstack(rows))
        else:
            stacked = np.vstack(rows)
        return cls(distance, stacked, drift, *coefficients)


@dataclass(frozen=True, eq=False)
class FrictionProblem:
    """Frictional contact problem; components of each contact are consecutive, normal first.

    Attributes
    ----------
    matrix : (n k, n k) ``H``, positive semidefinite; an operator for many contacts
    velocity : (n, k) ``b``
    friction : (n,) ``μ``
    scale : lower limit of the speed that residuals are compared with [m/s]
    """

    matrix: np.ndarray | Delassus
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
        worst = (violation[:, 0] * normal).max(initial=0.0)
        worst = max(worst, (violation[:, 1:] * along[:, None]).max(initial=0.0))
        return float(worst) if np.isfinite(impulses).all() else np.inf


def clip_lengths(vectors: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """Vectors shortened to their radii."""
    lengths = np.linalg.norm(vectors, axis=1)
    outside = lengths > radii
    factors = np.where(outside, radii / np.where(outside, lengths, 1.0), 1.0)
    return vectors * factors[:, None]
