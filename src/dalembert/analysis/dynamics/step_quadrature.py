"""Integrals over a run by points inside the steps that were taken.

Gauss–Lobatto points in each step, ``∫ m dt ≈ Σ_k h_k Σ_i b_i m(t_k + c_i h_k)``: its ends and
parts of it. With n points the quadrature has order 2n − 2, taken no less than that of the
steps, so that the integral is as exact as the motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import Legendre

from dalembert.analysis.kinematics.branches import Branches
from dalembert.integrators.marching.steps import Steps


def lobatto(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points ``c`` in [0, 1] and weights ``b``."""
    basis = Legendre.basis(count - 1)
    points = np.concatenate([[-1.0], basis.deriv().roots(), [1.0]])
    return (1 + points) / 2, 1 / (count * (count - 1) * basis(points) ** 2)


INSIDE = 1e-9
"""Share of a step by which a point keeps away from a switch, where measures may jump."""


@dataclass(frozen=True)
class StepQuadrature:
    """Points and weights of all steps of a run, the ends of steps shared.

    Parameters
    ----------
    steps : Steps taken, at least one
    order : of the quadrature at least
    """

    steps: Steps
    order: int
    continuous = True

    @cached_property
    def _rule(self) -> tuple[np.ndarray, np.ndarray]:
        return lobatto((self.order + 1) // 2 + 1)

    @property
    def branches(self) -> Branches:
        """Where the points lie: the start, then of each step those after its beginning.

        Those of a transition, which has no length, are the beginning of the step after it.
        """
        inside, h = self._rule[0][1:], self.steps.h
        length, index = h[:, None] * inside, np.repeat(np.arange(h.size), inside.size)
        length[:, -1] = h
        switched = np.flatnonzero(h[:-1] == 0)
        before = switched[switched > 0] - 1
        length[before, -1] *= 1 - INSIDE
        length[switched] = INSIDE * h[switched + 1, None]
        index += np.isin(index, switched)
        return Branches(np.append(0, index), np.append(0.0, length))

    def beside(self, first: int, last: int) -> tuple[int, int]:
        """Numbers of the points right before and right after transitions."""
        width = self._rule[0].size - 1
        return first * width, (last + 1) * width

    @property
    def times(self) -> np.ndarray:
        branches = self.branches
        return self.steps.t[branches.index] + branches.length

    @cached_property
    def weights(self) -> np.ndarray:
        b, h = self._rule[1], self.steps.h
        parts = h[:, None] * b[1:]
        parts[:-1, -1] += h[1:] * b[0]
        return np.append(h[0] * b[0], parts)

    @property
    def shares(self) -> np.ndarray:
        c = self._rule[0][1:]
        return np.append(np.zeros(self.weights.size - c.size), c)

    @property
    def span(self) -> float:
        return self.steps.end - float(self.steps.t[0])

    @property
    def span_weights(self) -> np.ndarray:
        return np.eye(1, self.weights.size, self.weights.size - 1).ravel()

    def time_weights(self, samples: np.ndarray) -> np.ndarray:
        """By the ends of the steps, with which the lengths of the steps beside them change."""
        b, found = self._rule[1], np.zeros(samples.size)
        ends = np.arange(self.steps.count + 1) * (b.size - 1)
        inside = ends[:-1, None] + np.arange(b.size)
        means = np.where(self.steps.h > 0, samples[inside] @ b, 0.0)
        found[ends[1:]] += means
        found[ends[:-1]] -= means
        return found
