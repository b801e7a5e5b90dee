"""Error estimate of a nonsmooth run by repetition with steps of twice the length.

The schemes are of first order. With force laws alone, and for ``AnticipatedImpacts`` in the plane
without impacts, they are of second order: the error of the run is the difference of both runs, or a
third of it. The estimate includes errors of the instants of impacts and their amplification by the
motion. Only coordinates are compared, as speeds jump.
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
        count = record.t.size
        if count < 3:
            return None
        chosen = np.unique(np.append(np.arange(0, count, 2), count - 1))
        try:
            positions, status = self._repeat(record.t[chosen])
        except SingularityError:
            return ErrorEstimate(np.inf, "", float(record.t[0]), "twice")
        if status.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if not status.success:
            return ErrorEstimate(np.inf, "", float(status.time), "twice")
        y = record.ends.y
        turns = bool(model.equations.manifold.attitudes)  # gyroscopic moments are of first order
        lasting = self.step.scheme.anticipates and not (turns or record.kept.any())
        order = 2 if lasting or self.step.force_laws.are_all else 1
        error = (y[:, chosen] - positions) / (2**order - 1)
        ranges = np.ptp(y, axis=1)
        sizes = motion_sizes(ranges, model.guesses.units, model.scales.coordinates)
        if self.step.scheme.anticipates:  # clearances of gaps are not errors of the steps
            resolved = CLEARANCE / TARGET * model.scales.coordinates
            sizes = np.maximum(sizes, np.where(sizes > 0, resolved, 0.0))
        return largest_error(error, sizes, model.guesses.names, record.t[chosen])

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
                f"the motion depends on the step of {h:.3g} s: with steps twice as long it "
                f"differs by {estimate.text}; its impacts amplify small differences, or the step "
                "is far too long"
            ]
        shorter = h * TARGET / estimate.share
        return [
            f"steps of {h:.3g} s are long for this motion: their estimated error is "
            f"{estimate.text}; use steps below {shorter:.2g} s"
        ]
