"""Linearised maps of a state: ``G(z, q) = 0``, ``x⁺ = F(z, q)``, with ``q = (x, t, p)``.

    dz = −G_z⁻¹ G_q dq,      dx⁺ = F_z dz + F_q dq

``G_z`` is sparse and may be singular if unknowns are not unique, as for impulses of redundant
contacts; unique quantities do not depend on the proximal term of its factors. Where redundant
contacts contradict each other, so that some open or slip, whichever depends on the direction of the
change, speeds satisfy them on average.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dalembert.sensitivity.nonsmooth.contact_equations import ContactEquations
from dalembert.sensitivity.nonsmooth.proximal_factors import ProximalFactors, arbitrary
from dalembert.sensitivity.nonsmooth.triplets import Sparse


@dataclass(frozen=True, eq=False)
class MapAt:
    """Map at one state, with its derivatives.

    Attributes
    ----------
    z : unknowns: speeds, joint multipliers, impulses
    following : ``x⁺``
    factors : of ``G_z``
    by_q : ``G_q`` of the equations without contacts
    next_by_z, next_by_q : ``F_z`` without the columns of impulses, ``F_q``
    contacts : equations of the contacts
    forced : (1, n_q) derivatives of the largest change of a normal speed by forces, where offsets
        depend on it, followed by those by the speeds of the path if the change is a mean over it
    path : map of the speeds at the end of the path over which means of gaps are taken
    """

    z: np.ndarray
    following: np.ndarray
    factors: ProximalFactors
    by_q: Sparse
    next_by_z: Sparse
    next_by_q: Sparse
    contacts: ContactEquations | None = None
    forced: Sparse | None = None
    path: MapAt | None = None

    def change(self, dq: np.ndarray) -> np.ndarray:
        """Change ``dz`` (n, c) of the unknowns."""
        right = self.by_q @ dq
        if self.contacts is not None:
            speeds = self.contacts.gaps.directions.shape[1]
            path = None if self.path is None else self.path.change(dq)[:speeds]
            momentum, rows = self.contacts.push(dq, path)
            right[: momentum.shape[0]] -= momentum
            if self.forced is not None:
                by = dq if path is None or self.forced.shape[1] == dq.shape[0] else [*dq, *path]
                rows += self.contacts.by_forced[:, None] * (self.forced @ np.asarray(by))
            right = np.concatenate([right, rows])
        return -self.factors.solve(right)

    def weights(self, z_bar: np.ndarray) -> np.ndarray:
        """Weights of ``q`` from those of the unknowns."""
        inner = -self.factors.solve(z_bar, transposed=True)
        size = self.by_q.shape[0]
        q_bar = self.by_q.T @ inner[:size]
        if self.contacts is not None:
            speeds = self.contacts.gaps.directions.shape[1]
            q_bar += self.contacts.pull(-inner[:speeds], inner[size:])
            forced_bar = np.zeros((0, z_bar.shape[1]))
            if self.forced is not None:
                forced_bar = self.forced.T @ (self.contacts.by_forced @ inner[size:])[None]
                q_bar += forced_bar[: q_bar.shape[0]]
            if self.path is not None:
                path_bar = np.zeros((self.path.z.size, z_bar.shape[1]))
                path_bar[:speeds] = self.contacts.pull_path(-inner[:speeds], inner[size:])
                rest = forced_bar[q_bar.shape[0] :]
                path_bar[: rest.shape[0]] += rest
                q_bar += self.path.weights(path_bar)
        return np.asarray(q_bar)

    def impact_law(self, keys: np.ndarray) -> MapAt:
        """The same map if the contacts with some keys follow Newton's law, on the path, too."""
        path = None if self.path is None else self.path.impact_law(keys)
        contacts = self.contacts
        if contacts is not None:
            contacts = contacts.impact_law(np.isin(contacts.keys, keys))
        return replace(self, contacts=contacts, path=path)

    def push(self, dx: np.ndarray, dt: float, dp: np.ndarray) -> np.ndarray:
        """Change (n, c) of ``x⁺``."""
        dq = np.vstack([dx, np.full((1, dx.shape[1]), dt), dp])
        dz = self.change(dq)[: self.next_by_z.shape[1]]
        return np.asarray(self.next_by_z @ dz + self.next_by_q @ dq)

    def pull(self, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights of the state and of the parameters from those of ``x⁺``."""
        z_bar = np.zeros((self.z.size, weights.shape[1]))
        z_bar[: self.next_by_z.shape[1]] = self.next_by_z.T @ weights
        q_bar = self.weights(z_bar) + self.next_by_q.T @ weights
        return q_bar[: weights.shape[0]], q_bar[weights.shape[0] + 1 :]

    @property
    def consistent(self) -> bool:
        """Whether the equations have a solution for an arbitrary change of ``q``."""
        if self.factors.regular:
            return True
        change = arbitrary(self.by_q.shape[1])
        self.change(change)
        return self.factors.consistent
