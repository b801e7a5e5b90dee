"""Where responses look at a motion, and with what weight."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.responses.base import Response, scalar_measure
from dalembert.results.motion import Motion
from dalembert.symbolic.expression import Expression


@dataclass(frozen=True)
class Sample:
    """A response with the samples it is made of.

    Attributes
    ----------
    motion : the motion at the sampling times
    measure : scalar expression
    value : ``R(m)``
    weights : (K,) ``∂R/∂m_k``
    """

    response: Response
    motion: Motion
    measure: Expression
    value: float
    weights: np.ndarray


def take_sample(motion: Motion, response: Response) -> Sample:
    """Evaluate a response and its weights on a motion."""
    times = response.sample_times(motion)
    sampled = motion if times is None else motion.at(times)
    measure = scalar_measure(motion, response)
    values = sampled.values(measure)
    return Sample(
        response,
        sampled,
        measure,
        response.reduce(sampled.time, values),
        response.weights(sampled.time, values),
    )
