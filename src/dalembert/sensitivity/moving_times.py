"""Contributions of parameter-dependent times to gradients at fixed times.

If the instants ``t_k`` of a response are formulas of parameters, as with ``duration="2*pi/speed"``,

    dR/dp = (dR/dp at fixed times) + Σ (∂R/∂t_k + w_k ṁ_k) dt_k/dp,

with the dot along the motion, which does not depend on the output times. The ends of fixed steps
move with the times that define them (see ``marching/moving_instants.py``); adaptive steps are
frozen, since they affect only the error of the integrator.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dalembert.analysis.dynamics.event_search import end_by_event
from dalembert.analysis.kinematics.kinematics import Kinematics
from dalembert.analysis.nonsmooth.nonsmooth import Nonsmooth
from dalembert.analysis.timeline import checked_span
from dalembert.analysis.times import follow_parameters, slopes
from dalembert.errors import UnsupportedError
from dalembert.responses.base import Response
from dalembert.results.result import Result
from dalembert.sensitivity.engine import Engine
from dalembert.sensitivity.marching.moving_instants import step_slopes
from dalembert.sensitivity.marching.stable_steps import with_stable_steps
from dalembert.sensitivity.registry import engine_for
from dalembert.sensitivity.samples import Sample, take_sample


def of_moving_times(
    motion: Result, responses: Sequence[Response], columns: Sequence[int]
) -> np.ndarray:
    """(responses, columns) terms added to derivatives at fixed times.

    Raises
    ------
    UnsupportedError
        The start of a motion depends on one of these parameters, or the analysis provides no rates.
    """
    terms = np.zeros((len(responses), len(columns)))
    if not follow_parameters(motion.analysis):
        return terms
    motion = with_stable_steps(motion)
    moving = MovingTimes(motion, columns)
    if moving.none:
        return terms
    samples = [take_sample(motion, response) for response in responses]
    engine = engine_for(motion)(samples)
    for row, response, sample in zip(terms, responses, samples, strict=True):
        row += moving.term(response, sample, engine)
    return terms


class MovingTimes:
    """``dt/dp`` of the instants of a run.

    Parameters
    ----------
    motion : the run
    columns : numbers of the parameters
    """

    def __init__(self, motion: Result, columns: Sequence[int]):
        self.motion, self.analysis = motion, motion.analysis
        analysis: Any = motion.analysis
        p, numbers = motion.parameters, list(columns)

        def slope(time: Any) -> np.ndarray:
            """(columns,) derivatives of a time."""
            return slopes(time, motion.model, p)[numbers]

        span = getattr(analysis, "t_span", None)
        ends = (0.0, analysis.duration) if span is None else span
        self.span = checked_span(getattr(analysis, "duration", None), span)
        self.start, self.end = map(slope, ends)
        self.step = slope(analysis.step)
        outputs = analysis.outputs
        self.listed = [slope(t) for t in outputs] if np.ndim(outputs) else None
        ends = step_slopes(motion)
        self.ends = None if ends is None else ends[:, numbers]
        every = self.start, self.end, *(self.listed or ()), self.ends
        self.none = not any(s is not None and np.any(s) for s in every)
        if np.any(self.start) and not isinstance(analysis, Kinematics):
            raise UnsupportedError(
                "a gradient by parameters that the start of the run follows is not available: the "
                "whole motion shifts with it; use a fixed start time"
            )
        fixed = motion.model.kind == "structure" or isinstance(analysis, Nonsmooth)
        if fixed and (np.any(self.step) or (analysis.step is None and np.any(self.end))):
            raise UnsupportedError(
                f"a gradient by parameters that the step of the {analysis.display_name} follows is "
                "not available; give step= as a number"
            )
        self.ended = end_by_event(motion) is not None

    def term(self, response: Response, sample: Sample, engine: Engine) -> np.ndarray:
        """(columns,) contribution of the moving instants to the gradient of a response."""
        if response.has_fixed_times(self.motion):
            return np.zeros(self.end.size)
        times = sample.motion.time
        if np.array_equal(times, self.motion.time):
            instants = samples = self.of_outputs(times)
        elif self.ends is not None:  # samples in the steps of the run, all of which may move
            instants = samples = self.of_steps(times)
        else:  # samples in the steps of the run, the last of which grows
            end = np.zeros_like(self.end) if self.ended else self.end
            instants = np.outer(np.eye(1, times.size, times.size - 1), end)
            samples = np.outer(sample.time_derivatives, end)
        added: np.ndarray = sample.time_weights @ instants
        for k in np.flatnonzero(sample.weights * np.any(samples, axis=1)):
            added = added + sample.weights[k] * self._rate(engine, sample, int(k)) * samples[k]
        return added

    def of_outputs(self, times: np.ndarray) -> np.ndarray:
        """(K, columns) derivatives of the output times."""
        analysis: Any = self.analysis
        begin, end = self.span
        shares = ((times - begin) / (end - begin))[:, None]
        rates = (1 - shares) * self.start + shares * self.end
        if self.listed is not None:
            rates[:] = np.array(self.listed)[: times.size]
        elif analysis.outputs is None and self.ends is not None:
            rates = self.of_steps(times)
        elif analysis.outputs is None and not self._divides:
            rates = self.start + np.arange(times.size)[:, None] * self.step
            rates[-1] = self.end
        if self.ended:  # the event determines the last instant
            rates[-1] = 0.0
        return rates

    def of_steps(self, times: np.ndarray) -> np.ndarray:
        """(K, columns) derivatives of times at fixed fractions of their steps."""
        assert self.ends is not None
        steps = self.motion.record.steps  # type: ignore[attr-defined]
        ends = np.append(steps.t[: steps.count], steps.end)
        return np.column_stack([np.interp(times, ends, column) for column in self.ends.T])

    @property
    def _divides(self) -> bool:
        """True if the steps are fractions of the time span and scale with it."""
        adaptive = getattr(getattr(self.analysis, "integrator", None), "adaptive", False)
        return self.analysis.step is None and not adaptive  # type: ignore[attr-defined]

    def _rate(self, engine: Engine, sample: Sample, k: int) -> float:
        try:
            return engine.rate(sample, k)
        except NotImplementedError:
            kind = type(self.analysis).__name__
            raise UnsupportedError(
                f"a gradient by parameters that the duration of a {kind} follows is not "
                "available; give the duration as a number"
            ) from None
