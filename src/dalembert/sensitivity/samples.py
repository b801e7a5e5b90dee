"""Sampled responses: sampling times, measure and weights, and their outputs in a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from dalembert.analysis.events import Occurrence
from dalembert.analysis.output_places import OutputPlaces
from dalembert.integrators.marching.steps import Steps
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
    time_derivatives : (K,) derivative of each sampling time by the last one [-]
    final_event : the event at whose instant the last sample is taken, or None
    """

    response: Response
    motion: R
    measure: Expression
    value: float
    weights: np.ndarray
    time_weights: np.ndarray
    time_derivatives: np.ndarray
    final_event: Occurrence | None = None


def weights_change(sample: Sample, change: np.ndarray) -> np.ndarray:
    """(K,) change of the weights for a change of the samples."""
    values = sample.motion.values(sample.measure)
    return sample.response.weights_change(sample.motion.time, values, change)


def take_sample(motion: Result, response: Response) -> Sample[Any]:
    """Evaluate a response and its weights on a motion."""
    sampled = response.sampled(motion)
    measure = scalar_measure(motion, response)
    final_event = response.final_event(motion)
    values, response = sampled.values(measure), response.adapted_to(motion)
    return Sample(
        response,
        sampled,
        measure,
        response.reduce(sampled.time, values),
        response.weights(sampled.time, values),
        response.time_weights(sampled.time, values),
        response.time_derivatives(sampled.time),
        final_event,
    )


class SampledOutputs:
    """Outputs of a run that a sampled response depends on.

    Attributes
    ----------
    steps, places : steps of the run, and the places of the outputs among them
    ends : (K,) whether an output is the end of its step
    number : (K,) number of the state that an output is, or from which its partial step begins
    within : (K,) whether an output lies inside a step
    active : outputs with nonzero weight, in the order of ``number``
    """

    def __init__(self, sample: Sample):
        self.sample, self.motion = sample, sample.motion
        record = self.motion.record
        self.steps: Steps = record.steps
        self.places: OutputPlaces = record.places
        self.ends = self.places.ends_of(self.steps)
        self.number = self.places.index + self.ends
        self.within = (self.places.length != 0) & ~self.ends
        active = np.flatnonzero(sample.weights)
        self.active = active[np.argsort(self.number[active], kind="stable")]

    def active_outputs(self, first: int, last: int) -> np.ndarray:
        """Active outputs from state ``first`` up to but excluding state ``last + 1``."""
        begin, end = np.searchsorted(self.number[self.active], [first, last + 1])
        return self.active[begin:end]
