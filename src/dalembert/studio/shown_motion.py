"""Motions of pictures, which end after a time of computation with the part so far."""

from __future__ import annotations

import time

from dalembert.results.result import Result
from dalembert.results.status import Outcome
from dalembert.studio.problems import Problem

USUAL, STATED = 5.0, 60.0
"""Upper limits of the processor time of a motion, of a file without and with an analysis [s]."""


class MotionLimit:
    """Progress report of a run, which ends it after a time as Ctrl-C does.

    Parameters
    ----------
    is_stated : whether the file states the analysis
    seconds : upper limit of the processor time; by default ``STATED`` or ``USUAL`` [s]
    """

    def __init__(self, is_stated: bool, seconds: float | None = None):
        self.is_stated = is_stated
        self.seconds = (STATED if is_stated else USUAL) if seconds is None else seconds
        self._end = time.process_time() + self.seconds

    def __call__(self, share: float) -> None:
        """Receive the completed fraction of the run.

        Raises
        ------
        KeyboardInterrupt
            The time is over; the run ends with the motion so far.
        """
        if time.process_time() > self._end and share < 1.0:
            raise KeyboardInterrupt

    def problem(self, result: Result) -> Problem:
        """The end of a run that did not succeed; a warning if this limit ended it."""
        if result.status.outcome is not Outcome.INTERRUPTED:
            return Problem("error", str(result.status))
        remedy = (
            "shorten its duration, or export the page, which has all of it"
            if self.is_stated
            else "state [analysis] with a shorter duration, or draw with fewer or stiffer parts"
        )
        return Problem(
            "warning",
            f"the motion is shown until t = {result.status.time:.3g} s, the part that was computed "
            f"in {self.seconds:g} s; {remedy}",
        )
