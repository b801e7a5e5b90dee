"""What a response is.

A response samples a scalar measure along a motion, ``m_k = m(t_k)``, and reduces the samples to
a number ``R(m_1 … m_K)``. A new one gives ``reduce`` and its derivative ``weights``; gradients of
any analysis by any method follow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.motion import Motion
from dalembert.symbolic.expression import Expression


@dataclass(frozen=True)
class Response:
    """A named number drawn from a motion.

    Parameters
    ----------
    measure : name or formula, in Python also an Expression; scalar
    name : label; made from the measure if empty
    """

    measure: str | Expression
    name: str = ""

    @property
    def label(self) -> str:
        """The name, or one made of the reduction and the measure."""
        if self.name:
            return self.name
        text = self.measure if isinstance(self.measure, str) else self.measure.name or "formula"
        return f"{type(self).__name__.lower()}({text})"

    def named(self, name: str) -> Response:
        """The same response under a name."""
        from dataclasses import replace

        return replace(self, name=name)

    def sample_times(self, motion: Motion) -> np.ndarray | None:
        """Own sampling times, or None for the outputs of the motion."""
        return None

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        """``R`` of the samples."""
        raise NotImplementedError

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        """``∂R/∂m_k``."""
        raise NotImplementedError

    def unit(self, unit: str) -> str:
        """Unit of the response for a measure in ``unit``."""
        return unit


def scalar_measure(motion: Motion, response: Response) -> Expression:
    """The response's measure as an expression of the model.

    Raises
    ------
    AnalysisError
        It is a vector; a response needs one component or a norm.
    """
    expression = motion.expression(response.measure)
    if len(expression) != 1:
        raise AnalysisError(
            f"response {response.label}: the measure has {len(expression)} components; "
            "take .x, .y or a norm"
        )
    return expression


def as_responses(responses: Response | Sequence[Response]) -> list[Response]:
    """One response or several as a list with different labels."""
    listed = [responses] if isinstance(responses, Response) else list(responses)
    labels = [r.label for r in listed]
    twice = next((label for label in labels if labels.count(label) > 1), None)
    if twice:
        raise AnalysisError(f"two responses are called {twice!r}; name them")
    return listed


def evaluate(motion: Motion, response: Response) -> float:
    """Value of a response on a motion."""
    times = response.sample_times(motion)
    sampled = motion if times is None else motion.at(times)
    samples = sampled.values(scalar_measure(motion, response))
    return response.reduce(sampled.time, samples)
