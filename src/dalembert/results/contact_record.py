"""Impulses of contacts, step by step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.results.recording import Trajectory


@dataclass(frozen=True, eq=False)
class ContactRecord:
    """What contacts did in each of K steps.

    Attributes
    ----------
    ends : Trajectory of K+1 states, at the start and at the ends of the steps; accelerations and
        multipliers are means over the step before, at the start over the first
    names : elements that have gaps
    step, owner, key : (c,) in which step, of which element, and of which gap each impulse was
    impulse : (c, k) [N s], the normal component first
    loss : (K,) energy that contacts took [J]
    penetration : (K+1,) of the deepest gap [m]
    residual : (K,) of the conditions of contact, as a speed [m/s]
    rounds : (K,) of the proximal method
    """

    ends: Trajectory
    names: tuple[str, ...]
    step: np.ndarray
    owner: np.ndarray
    key: np.ndarray
    impulse: np.ndarray
    loss: np.ndarray
    penetration: np.ndarray
    residual: np.ndarray
    rounds: np.ndarray

    @property
    def t(self) -> np.ndarray:
        """(K+1,) ends of the steps [s]."""
        return self.ends.t

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
