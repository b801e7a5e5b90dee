"""Sampled responses: sampling times, measure and weights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from dalembert.analysis.events import Occurrence
from dalembert.responses.base import Response, scalar_measure
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression

R = TypeVar("R", bound=Result)


@dataclass(frozen=True)
class Sample(Generic[R]):
    """A response and the samples it is computed from.

    Attributes
    ----------
    motion : the result at the sampling times
    measure : scalar expression
    value : ``R(m)``
    weights : (K,) ``∂R/∂m_k``
    time_weights : (K,) ``∂R/∂t_k``
    shares : (K,) derivative of each sampling time by the last one [-]
    moves_with : the event at whose instant the last sample is taken, or None
    """

    response: Response
    motion: R
    measure: Expression
    value: float
    weights: np.ndarray
    time_weights: np.ndarray
    shares: np.ndarray
    moves_with: Occurrence | None = None


def weights_change(sample: Sample, change: np.ndarray) -> np.ndarray:
    """(K,) change of the weights for a change of the samples."""
    values = sample.motion.values(sample.measure)
    return sample.response.weights_change(sample.motion.time, values, change)


def take_sample(motion: Result, response: Response) -> Sample[Any]:
    """Evaluate a response and its weights on a motion."""
    sampled = response.sampled(motion)
    measure = scalar_measure(motion, response)
    moves_with = response.moves_with(motion)
    values, response = sampled.values(measure), response.over(motion)
    return Sample(
        response,
        sampled,
        measure,
        response.reduce(sampled.time, values),
        response.weights(sampled.time, values),
        response.time_weights(sampled.time, values),
        response.shares(sampled.time),
        moves_with,
    )
