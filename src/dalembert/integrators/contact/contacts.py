"""Places where things may touch in a step, all at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from dalembert.symbolic.evaluation.kernel import Matrix


@dataclass(frozen=True, eq=False)
class Contacts:
    """Gaps near enough to matter in a step; components of one follow each other, normal first.

    Attributes
    ----------
    distance : (n,) ``g``
    directions : (n k, n_v) ``W``, so that the relative velocity is ``u = W v + w``
    drift : (n, k) ``w``, of what moves by the clock
    restitution, tangential, friction : (n,) laws of impact
    key : (n,) whole number that names a gap from step to step
    owner : (n,) which element it belongs to
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
        """(n, k) ``u`` at speeds of the model."""
        return (self.directions @ v).reshape(self.drift.shape) + self.drift

    def some(self, which: np.ndarray) -> Contacts:
        """These gaps only."""
        k = self.drift.shape[1]
        rows = (np.arange(self.count)[which][:, None] * k + np.arange(k)).ravel()
        return Contacts(
            self.distance[which],
            self.directions[rows],
            self.drift[which],
            self.restitution[which],
            self.tangential[which],
            self.friction[which],
            self.key[which],
            self.owner[which],
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
        distance, drift, *rest = (np.concatenate(column) for column in columns)
        rows = [p.directions for p in parts]
        if any(scipy.sparse.issparse(part) for part in rows):
            stacked: Matrix = scipy.sparse.csr_array(scipy.sparse.vstack(rows))
        else:
            stacked = np.vstack(rows)
        return cls(distance, stacked, drift, *rest)
