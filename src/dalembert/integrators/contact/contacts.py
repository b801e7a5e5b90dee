"""Possible contacts of a step, and their frictional contact problem.

    u = H P + b,    0 ≤ u_N ⟂ P_N ≥ 0,    P_T = −μ P_N u_T / |u_T|  or  |P_T| ≤ μ P_N, u_T = 0

for all contacts together; ``H = W M⁻¹ Wᵀ`` (Acary & Brogliato, Numerical Methods for Nonsmooth
Dynamical Systems, 2008, ch. 13). Restitution is included in ``b``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy

from dalembert.integrators.contact.contact_laws import ContactLaws, widest_groups
from dalembert.symbolic.evaluation.kernel import Matrix, dense_array

if TYPE_CHECKING:
    from dalembert.integrators.contact.delassus import Delassus


@dataclass(frozen=True, eq=False)
class Contacts:
    """Gaps that may close in a step; components of each gap are consecutive, normal first.

    Attributes
    ----------
    distance : (n,) ``g``
    directions : (n k, n_v) ``W``, so that the relative velocity is ``u = W v + w``; an array for
        few speeds, compressed by rows for many
    drift : (n, k) ``w``, from motions prescribed in time [m/s]
    laws : restitution and friction
    groups : widths of the groups of tangential components, as in ``FrictionProblem``
    key : (n,) integer that identifies a gap from step to step
    owner : (n,) number of the element of the gap
    turning : (n, k) ``b``, half of the change of ``u`` by that of ``W``, ``w`` in the step [m/s]
    kept : (n,) mask of the gaps that keep their directions at the start of the step
    moved : (n, n_v) mask of the speeds of the bodies of each gap; None if they are those with
        stored directions
    """

    distance: np.ndarray
    directions: Matrix
    drift: np.ndarray
    laws: ContactLaws
    groups: tuple[int, ...]
    key: np.ndarray
    owner: np.ndarray
    turning: np.ndarray | float = 0.0
    kept: np.ndarray | bool = False
    moved: np.ndarray | None = None

    @property
    def count(self) -> int:
        """Number of gaps."""
        return self.distance.size

    def speeds(self, v: np.ndarray) -> np.ndarray:
        """(n, k) ``u`` for speeds ``v`` of the model, where the directions are."""
        return (self.directions @ v).reshape(self.drift.shape) + self.drift

    def at_start(self, v: np.ndarray) -> np.ndarray:
        """(n, k) ``u⁻ = W v + w − b`` for speeds at the start of the step."""
        return self.speeds(v) - self.turning

    def at_end(self, v: np.ndarray) -> np.ndarray:
        """(n, k) ``u⁺ = W v + w + b`` for speeds at the end of the step."""
        return self.speeds(v) + self.turning

    @property
    def linear(self) -> int:
        """Number of components of the velocities that are not rotations."""
        return 1 + sum(self.groups[:1])

    @property
    def normals(self) -> Matrix:
        """(n, n_v) rows of ``W`` along the normals."""
        width = self.drift.shape[1]
        if isinstance(self.directions, np.ndarray):
            return self.directions[::width]
        return self.directions[np.arange(self.count) * width]

    def some(self, selected: np.ndarray) -> Contacts:
        """The selected gaps."""
        if selected.dtype == bool and selected.all():
            return self
        k = self.drift.shape[1]
        rows = (np.arange(self.count)[selected][:, None] * k + np.arange(k)).ravel()
        return Contacts(
            self.distance[selected],
            self.directions[rows],
            self.drift[selected],
            self.laws.some(selected),
            self.groups,
            self.key[selected],
            self.owner[selected],
            self._turnings[selected],
            self.kept_mask[selected],
            None if self.moved is None else self.moved[selected],
        )

    @classmethod
    def joined(cls, parts: list[Contacts]) -> Contacts:
        """Gaps of several sources, with the widest groups of tangential components."""
        if len(parts) == 1:
            return parts[0]
        groups = parts[0].groups
        if any(part.groups != groups for part in parts):
            groups = widest_groups([part.groups for part in parts])
            parts = [part.padded(groups) for part in parts]
        parts = [part for part in parts if part.count] or parts[:1]
        if len(parts) == 1:
            return parts[0]
        rows = [(p.distance, p.drift, p.key, p.owner, p._turnings, p.kept_mask) for p in parts]
        columns = (np.concatenate(column) for column in zip(*rows, strict=True))
        distance, drift, key, owner, turning, kept = columns
        laws = ContactLaws.joined([p.laws for p in parts])
        across = [p.directions for p in parts]
        if any(scipy.sparse.issparse(part) for part in across):
            stacked: Matrix = scipy.sparse.csr_array(scipy.sparse.vstack(across))
            return cls(distance, stacked, drift, laws, groups, key, owner, turning, kept)
        directions, moved = np.concatenate(across), np.concatenate([p.moved_speeds for p in parts])
        return cls(distance, directions, drift, laws, groups, key, owner, turning, kept, moved)

    @property
    def moved_speeds(self) -> np.ndarray:
        """(n, n_v) ``moved``, or the mask of the speeds with directions that are not zero."""
        if self.moved is not None:
            return self.moved
        acting = dense_array(self.directions) != 0
        moved: np.ndarray = acting.reshape(*self.drift.shape, acting.shape[1]).any(axis=1)
        return moved

    @property
    def kept_mask(self) -> np.ndarray:
        """(n,) ``kept``."""
        if isinstance(self.kept, np.ndarray):
            return self.kept
        return np.full(self.key.shape, self.kept)

    @property
    def _turnings(self) -> np.ndarray:
        if isinstance(self.turning, np.ndarray):
            return self.turning
        return np.full(self.drift.shape, self.turning)

    def padded(self, groups: tuple[int, ...]) -> Contacts:
        """The gaps with zeros for the components of wider groups that they lack."""
        missing = ((0, 0), (0, 1 + sum(groups) - self.drift.shape[1]))
        rows = scipy.sparse.csr_array(self.directions)
        sizes = np.pad(np.diff(rows.indptr).reshape(self.drift.shape), missing)
        starts = np.concatenate([[0], np.cumsum(sizes)])
        directions: Matrix = scipy.sparse.csr_array(
            (rows.data, rows.indices, starts), shape=(sizes.size, rows.shape[1])
        )
        if not scipy.sparse.issparse(self.directions):
            directions = directions.toarray()
        return replace(
            self,
            directions=directions,
            drift=np.pad(self.drift, missing),
            turning=np.pad(self._turnings, missing),
            laws=self.laws.padded(len(groups)),
            groups=groups,
        )


FEW = 10_000
"""Upper limit of pairs of keys of which comparing all costs less than sorting."""
SHARED = "starts", "discs", "mobility", "weights"
"""Properties of a friction problem that do not depend on its velocity."""


@dataclass(frozen=True, eq=False)
class FrictionProblem:
    """Frictional contact problem; components of each contact are consecutive, normal first.

    The tangential components are divided into consecutive groups of widths ``groups``, each with
    its own disc ``|P_j| ≤ μ_j P_N``: (1,) slides in the plane, (2,) in space, (1, 1) and (2, 2, 1)
    also roll and spin. Groups after the first are rotations.

    Attributes
    ----------
    matrix : (n k, n k) ``H``, positive semidefinite; an operator for many contacts
    velocity : (n, k) ``b``
    friction : (n, groups) ``μ`` [-], of rotations [m]
    groups : widths of the groups, whose sum is k − 1
    scale : lower limit of the speed that residuals are compared with [m/s]
    minimum : (n,) or one, lower limit of the normal impulses, not negative:
        ``0 ≤ u_N ⟂ P_N − minimum ≥ 0``
    compliance : (n,) or one, part of the normal diagonal of ``H`` that is no motion of bodies
    """

    matrix: np.ndarray | Delassus
    velocity: np.ndarray
    friction: np.ndarray
    groups: tuple[int, ...]
    scale: float = 1.0
    minimum: float | np.ndarray = 0.0
    compliance: float | np.ndarray = 0.0

    @property
    def shape(self) -> tuple[int, int]:
        """Number of contacts, components of each."""
        return self.velocity.shape  # type: ignore[return-value]

    @property
    def linear(self) -> int:
        """Number of components that are not rotations."""
        return 1 + sum(self.groups[:1])

    def with_velocity(self, velocity: np.ndarray) -> FrictionProblem:
        """The problem with another ``b``, and what follows from the rest."""
        rest = self.friction, self.groups, self.scale, self.minimum, self.compliance
        problem = FrictionProblem(self.matrix, velocity, *rest)
        problem.__dict__.update((name, getattr(self, name)) for name in SHARED)
        return problem

    @cached_property
    def starts(self) -> np.ndarray:
        """(groups + 1,) first component of each group, and the number of components."""
        return np.cumsum([1, *self.groups])

    @cached_property
    def discs(self) -> list[tuple[slice, np.ndarray]]:
        """Components, and (n,) coefficients of friction, of each group."""
        limits = zip(self.starts[:-1], self.starts[1:], strict=True)
        return [(slice(*limit), self.friction[:, j]) for j, limit in enumerate(limits)]

    def speeds(self, impulses: np.ndarray) -> np.ndarray:
        """(n, k) ``u``."""
        return (self.matrix @ impulses.ravel()).reshape(self.shape) + self.velocity

    @cached_property
    def mobility(self) -> np.ndarray:
        """(n, k) ``1/ρ``: change of speed per impulse in normal direction, and its upper bound in
        the directions of each group."""
        mobility = self.matrix.diagonal().reshape(self.shape).copy()
        mobility[:, 0] = normal = np.where(mobility[:, 0] > 0, mobility[:, 0], 1.0)
        for components, _ in self.discs:
            along = mobility[:, components].sum(axis=1)
            mobility[:, components] = np.where(along > 0, along, normal)[:, None]
        return mobility

    @cached_property
    def weights(self) -> np.ndarray:
        """(n, k) residual per violation of an impulse; rotations count by their energy [m/s]."""
        weights = self.mobility.copy()
        weights[:, 0] -= self.compliance
        turning = weights[:, self.linear :]
        if turning.size:
            weights[:, self.linear :] = np.sqrt(turning * weights[:, :1])
        return weights

    def size(self, impulses: np.ndarray) -> float:
        """Reference speed: the scale or the largest change of speed of a contact by its impulse."""
        sliding = impulses[:, : self.linear]
        changes = lengths_of(sliding) * (self.mobility[:, 0] - self.compliance)
        largest = float(changes.max(initial=0.0))
        if not np.isfinite(largest):
            largest = float(np.nan_to_num(changes).max())
        return max(self.scale, largest)

    def project(self, impulses: np.ndarray, speeds: np.ndarray) -> np.ndarray:
        """``proj(P − ρ u)``: normal part onto ``≥ minimum``, each group onto its disc ``μ P_N``."""
        projected = impulses - speeds / self.mobility
        pressure = projected[:, 0] = np.maximum(self.minimum, projected[:, 0])
        for components, friction in self.discs:
            projected[:, components] = clip_lengths(projected[:, components], friction * pressure)
        return projected

    def residual(self, impulses: np.ndarray) -> float:
        """Largest violation of the conditions as a speed, ``|P − proj(P − ρ u)| / ρ``."""
        violation = np.abs(impulses - self.project(impulses, self.speeds(impulses)))
        worst = (violation * self.weights).max(initial=0.0)
        return float(worst) if np.isfinite(impulses).all() else np.inf


def among(keys: np.ndarray, others: np.ndarray) -> np.ndarray:
    """(n,) mask of the keys (n,) that are among others (m,)."""
    if keys.size * others.size > FEW:
        return np.isin(keys, others)
    mask: np.ndarray = (keys[:, None] == others).any(axis=1)
    return mask


def clip_lengths(vectors: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """Vectors shortened to their radii."""
    lengths = lengths_of(vectors)
    outside = lengths > radii
    if not outside.any():
        return vectors
    factors = np.where(outside, radii / np.where(outside, lengths, 1.0), 1.0)
    return vectors * factors[:, None]


def lengths_of(vectors: np.ndarray) -> np.ndarray:
    """(n,) lengths of vectors (n, k)."""
    if vectors.shape[1] == 1:
        return np.abs(vectors[:, 0])
    return np.asarray(np.sqrt(np.einsum("ij,ij->i", vectors, vectors)))
