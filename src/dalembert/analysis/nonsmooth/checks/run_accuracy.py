"""Error estimate of a nonsmooth run by repetition with longer steps.

With steps of ``q`` times the length, the error of a run is the difference of both runs over ``q −
1``, as the schemes are of first order, or over ``q² − 1`` with force laws alone, and for
``AnticipatedImpacts`` without impacts. The estimate includes errors of the instants of
impacts and their amplification by the motion. An impact is applied at an end of a step: half of
those of ``q = 2`` are among the ends of steps of the run, so that both runs often have the same
error, and those of periodic motions again and again. Therefore eight steps are repeated as five.
Only coordinates are compared, as speeds jump.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from dalembert.analysis.error_estimate import ErrorEstimate, largest_error, motion_sizes
from dalembert.analysis.nonsmooth.contact_step import CLEARANCE, ContactStep
from dalembert.errors import SingularityError
from dalembert.results.nonsmooth_motion import ContactRecord
from dalembert.results.status import Outcome, Status

ALLOWED, TARGET = 0.05, 0.02
"""Estimated error, relative to the motion: threshold for a warning, and target of the proposed
step."""
SHORT, LONG = 8, 5
"""Numbers of steps of the run and of the repetition between instants at which both are compared."""
RATIO = f"{SHORT / LONG:g} times"
"""Length of the steps of the repetition, relative to those of the run, as text."""
UNPREDICTABLE = 0.5
"""Estimated error above which the motion is one of several that the steps may lead to [-]."""
ENTRIES = 2e5
"""Upper limit of the number of entries of the states of a run whose warnings have the estimate."""


class RunAccuracy:
    """Error of a run with contacts.

    Parameters
    ----------
    step : ContactStep of the run
    record : ContactRecord of the run
    repeat : run on another grid of times, ``grid → positions, status``
    """

    def __init__(
        self,
        step: ContactStep,
        record: ContactRecord,
        repeat: Callable[[np.ndarray], tuple[np.ndarray, Status]],
    ):
        self.step, self.record, self._repeat = step, record, repeat

    @cached_property
    def estimate(self) -> ErrorEstimate | None:
        """The estimate, infinite where longer steps fail; None for one step, or where nothing
        moves."""
        record, model = self.record, self.step.model
        if record.t.size < 3:
            return None
        grid, compared = longer_steps(record.t)
        try:
            positions, status = self._repeat(grid)
        except SingularityError:
            return ErrorEstimate(np.inf, "", float(record.t[0]), RATIO)
        if status.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if not status.success:
            return ErrorEstimate(np.inf, "", float(status.time), RATIO)
        y, times = record.ends.y, record.t[compared]
        lasting = self.step.scheme.anticipates and not record.kept.any()
        order = 2 if lasting or self.step.force_laws.are_all else 1
        error = y[:, compared] - positions[:, np.searchsorted(grid, times)]
        error = error / ((SHORT / LONG) ** order - 1)
        ranges = np.ptp(y, axis=1)
        sizes = motion_sizes(ranges, model.guesses.units, model.scales.coordinates)
        if self.step.scheme.anticipates:  # clearances of gaps are not errors of the steps
            resolved = CLEARANCE / TARGET * model.scales.coordinates
            sizes = np.maximum(sizes, np.where(sizes > 0, resolved, 0.0))
        return largest_error(error, sizes, model.guesses.names, times)

    @property
    def warnings(self) -> list[str]:
        """Warning if the steps are too long for the motion; of short runs and few bodies."""
        if self.record.ends.y.size > ENTRIES:
            return []
        estimate = self.estimate
        if estimate is None or not estimate.name or estimate.share <= ALLOWED:
            return []
        h = float(np.median(np.diff(self.record.t)))
        if estimate.share > UNPREDICTABLE:
            return [
                f"the motion depends on the step of {h:.3g} s: with steps {RATIO} as long it "
                f"differs by {estimate.text}; its impacts amplify small differences, or the step "
                "is far too long"
            ]
        shorter = h * TARGET / estimate.share
        return [
            f"steps of {h:.3g} s are long for this motion: their estimated error is "
            f"{estimate.text}; use steps below {shorter:.2g} s"
        ]


def longer_steps(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A grid of longer steps, and the numbers of the ends of steps that it contains.

    Parameters
    ----------
    t : (K+1,) ends of the steps of a run; the last ones may be fewer than ``SHORT``
    """
    compared = np.unique(np.append(np.arange(0, t.size, SHORT), t.size - 1))
    counts = np.maximum(np.round(np.diff(compared) * LONG / SHORT), 1).astype(int)
    parts = [
        np.linspace(t[i], t[j], count + 1)[:-1]
        for i, j, count in zip(compared[:-1], compared[1:], counts, strict=True)
    ]
    return np.append(np.concatenate(parts), t[-1]), compared
