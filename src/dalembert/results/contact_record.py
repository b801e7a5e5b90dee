"""Impulses of contacts, step by step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class ContactRecord:
    """What contacts did in each of K steps, at whose ends ``t`` (K+1,) the states are known.

    Attributes
    ----------
    t : (K+1,) [s]
    y, v : (n, K+1) states of the bodies
    a, multiplier : (n, K), (m, K) means over the steps; of all equations
    work : (2, K+1) dissipated energy and input
    names : elements that have gaps
    step, owner : (c,) in which step, and of which element, each impulse was
    impulse : (c, k) [N s], the normal component first
    loss : (K,) energy that contacts took [J]
    penetration : (K+1,) of the deepest gap [m]
    residual : (K,) of the conditions of contact, as a speed [m/s]
    rounds : (K,) of the proximal method
    """

    t: np.ndarray
    y: np.ndarray
    v: np.ndarray
    a: np.ndarray
    multiplier: np.ndarray
    work: np.ndarray
    names: tuple[str, ...]
    step: np.ndarray
    owner: np.ndarray
    impulse: np.ndarray
    loss: np.ndarray
    penetration: np.ndarray
    residual: np.ndarray
    rounds: np.ndarray

    @property
    def pressing(self) -> np.ndarray:
        """(K,) how many contacts press."""
        return np.bincount(self.step, minlength=self.loss.size)

    def summed(self, times: np.ndarray, values: np.ndarray) -> np.ndarray:
        """(times, elements) sums of a number per impulse since the time before."""
        found = np.zeros((times.size, len(self.names)))
        slack = 1e-12 * max(abs(self.t[0]), abs(self.t[-1]))
        place = np.searchsorted(times, self.t[self.step + 1] - slack)
        seen = place < times.size
        np.add.at(found, (place[seen], self.owner[seen]), values[seen])
        return found
