"""Quadrature over a run with points inside its steps.

Gauss–Lobatto points in each step, ``∫ m dt ≈ Σ_k h_k Σ_i b_i m(t_k + c_i h_k)``: its ends and
interior points. With n points the quadrature has order 2n − 2, at least that of the steps, so the
integral of a measure as smooth as the motion is as accurate as the motion. Long steps are divided,
because a measure may vary faster than the motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import Legendre

from dalembert.analysis.output_places import OutputPlaces
from dalembert.integrators.marching.steps import Steps


def lobatto(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points ``c`` in [0, 1] and weights ``b``."""
    basis = Legendre.basis(count - 1)
    points = np.concatenate([[-1.0], basis.deriv().roots(), [1.0]])
    return (1 + points) / 2, 1 / (count * (count - 1) * basis(points) ** 2)


INSIDE = 1e-9
"""Distance of a point from a switch, where measures may jump, relative to the step."""
LEAST = 200
"""Minimum number of intervals of an integral over a run."""
SAME = 1e-6
"""Relative difference below which lengths are equal."""


@dataclass(frozen=True)
class StepQuadrature:
    """Points and weights over all steps of a run; neighbouring steps share their ends.

    Parameters
    ----------
    steps : Steps taken, at least one
    order : minimum order of the quadrature
    parts : (n,) number of equal parts of each step, one by default
    """

    steps: Steps
    order: int
    parts: np.ndarray | None = None
    continuous = True

    @classmethod
    def fine(cls, steps: Steps, order: int) -> StepQuadrature:
        """The quadrature with parts of steps no longer than a share of the run."""
        longest = (steps.end - float(steps.t[0])) / LEAST
        parts = np.maximum(np.ceil((1 - SAME) * steps.h / longest), 1).astype(int)
        return cls(steps, order, parts)

    @cached_property
    def _rule(self) -> tuple[np.ndarray, np.ndarray]:
        return lobatto((self.order + 1) // 2 + 1)

    @cached_property
    def _pieces(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Step number, beginning and length of all parts; lengths as shares of the step."""
        h = self.steps.h
        parts = np.ones(h.size, int) if self.parts is None else np.where(h > 0, self.parts, 1)
        index = np.repeat(np.arange(h.size), parts)
        ordinal = np.arange(index.size) - np.repeat(np.cumsum(parts) - parts, parts)
        share = 1 / parts[index]
        return index, ordinal * share, share

    @property
    def places(self) -> OutputPlaces:
        """Positions of the points: the start, then for each part the points after its beginning.

        Points of a transition, which has no length, lie at the beginning of the following step.
        """
        inside, h = self._rule[0][1:], self.steps.h
        piece, begin, share = self._pieces
        length = h[piece][:, None] * (begin[:, None] + share[:, None] * inside)
        index, last = np.repeat(piece, inside.size), np.append(np.flatnonzero(np.diff(piece)), -1)
        length[last, -1] = h
        switched = np.flatnonzero(h[:-1] == 0)
        length[last[switched[switched > 0] - 1], -1] *= 1 - INSIDE
        length[last[switched]] = INSIDE * h[switched + 1, None]
        index += np.isin(index, switched)
        return OutputPlaces(np.append(0, index), np.append(0.0, length))

    def beside(self, first: int, last: int) -> tuple[int, int]:
        """Numbers of the points right before and right after transitions."""
        return int(self._ends[first]), int(self._ends[last + 1])

    @property
    def _ends(self) -> np.ndarray:
        """Numbers of the points at the start and at the ends of all steps."""
        parts = np.bincount(self._pieces[0], minlength=self.steps.count)
        return np.append(0, np.cumsum(parts)) * (self._rule[0].size - 1)

    @property
    def times(self) -> np.ndarray:
        places = self.places
        return self.steps.t[places.index] + places.length

    @cached_property
    def weights(self) -> np.ndarray:
        b, (piece, _, share) = self._rule[1], self._pieces
        h = self.steps.h[piece] * share
        parts = h[:, None] * b[1:]
        parts[:-1, -1] += h[1:] * b[0]
        return np.append(h[0] * b[0], parts)

    @property
    def time_derivatives(self) -> np.ndarray:
        c, (piece, begin, share) = self._rule[0][1:], self._pieces
        begins = np.where(piece == piece[-1], begin, 0.0)[:, None] + np.outer(share, c)
        return np.append(0.0, begins * (piece == piece[-1])[:, None])

    @property
    def span(self) -> float:
        return self.steps.end - float(self.steps.t[0])

    @property
    def span_weights(self) -> np.ndarray:
        return np.eye(1, self.weights.size, self.weights.size - 1).ravel()

    def time_weights(self, samples: np.ndarray) -> np.ndarray:
        """Derivative by the ends of the steps, which change the lengths of both adjacent steps."""
        b, (piece, _, share), weights = self._rule[1], self._pieces, np.zeros(samples.size)
        inside = (np.arange(piece.size) * (b.size - 1))[:, None] + np.arange(b.size)
        means = np.bincount(piece, share * (samples[inside] @ b), self.steps.count)
        means[self.steps.h == 0] = 0.0
        ends = self._ends
        weights[ends[1:]] += means
        weights[ends[:-1]] -= means
        return weights
