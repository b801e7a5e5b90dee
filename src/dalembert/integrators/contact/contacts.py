"""Possible contacts of a step, in arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

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
