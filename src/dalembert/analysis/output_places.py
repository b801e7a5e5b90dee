"""Places of the outputs of a run among its steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.integrators.marching.steps import Steps

NO_JUMPS = np.zeros(0, dtype=int)
SHORT = 1e-2
"""Length of a last step, relative to the previous one, whose beginning is not an output."""


@dataclass(frozen=True)
class OutputPlaces:
    """Places of outputs: ``length`` seconds after the beginning of step ``index``.

    ``modes`` are the modes that evaluate the outputs; by default, and where negative, those of the
    steps.
    """

    index: np.ndarray
    length: np.ndarray
    modes: np.ndarray | None = None

    def ends_of(self, steps: Steps) -> np.ndarray:
        """Whether each output is the end of its step."""
        if not steps.count:
            return np.zeros(self.index.size, dtype=bool)
        return (self.length > 0) & np.isclose(self.length, steps.h[self.index], rtol=1e-12, atol=0)

    def ended(self, steps: Steps) -> OutputPlaces:
        """The same places with the last output at the end of the last step."""
        return OutputPlaces(
            np.append(self.index[:-1], steps.count - 1), np.append(self.length[:-1], steps.h[-1])
        )


def place_outputs(steps: Steps, times: np.ndarray) -> OutputPlaces:
    """Places of times among the steps.

    Raises
    ------
    AnalysisError
        A time outside the run.
    """
    count = steps.count
    slack = steps.instant
    first, last = times.min(), times.max()
    if not (first >= steps.t[0] - slack and last <= steps.end + slack):
        raise AnalysisError(
            f"times {first:g}…{last:g} s leave the run {steps.t[0]:g}…{steps.end:g} s"
        )
    index = np.clip(np.searchsorted(steps.t[:count], times, side="right") - 1, 0, count - 1)
    length = np.clip(times - steps.t[index], 0.0, steps.h[index])
    length[length < slack] = 0.0
    near = np.abs(length - steps.h[index]) < slack
    length[near] = steps.h[index[near]]
    return OutputPlaces(index, length)


def outputs_of(
    steps: Steps,
    requested: np.ndarray | None,
    at_event: bool = False,
    jumps: np.ndarray = NO_JUMPS,
) -> tuple[np.ndarray, OutputPlaces]:
    """Times and places of the outputs: the requested times, or the ends of all steps.

    The end of a run that ended early is an output, too. If an event ended the run right after the
    beginning of a step, the end replaces that output. ``jumps`` are steps of zero length in which
    the state jumps; the state before is an output one rounding earlier.
    """
    count = steps.count
    if requested is None and at_event and count > 1 and steps.h[-1] < SHORT * steps.h[-2]:
        times, places = outputs_of(steps, None, jumps=jumps)
        keep = np.arange(times.size) != times.size - 2
        return times[keep], OutputPlaces(places.index[keep], places.length[keep])
    if requested is None or count == 0:
        _, first = np.unique(steps.t[jumps], return_index=True)
        before = jumps[first][steps.t[jumps[first]] > steps.t[0]]
        begins = np.union1d(steps.lasting, before)
        at = np.where(
            np.isin(begins, before), np.nextafter(steps.t[begins], -np.inf), steps.t[begins]
        )
        times = np.append(at, steps.end)
        index = np.append(begins, max(count - 1, 0))
        length = np.append(np.zeros(begins.size), steps.h[-1:] if count else 0.0)
        return times, OutputPlaces(index, length)
    slack = steps.instant
    times = requested[requested <= steps.end + slack]
    if steps.end < requested[-1] - slack and (not times.size or times[-1] < steps.end):
        times = np.append(times, steps.end)
    return times, place_outputs(steps, times)
