"""Going on from the end of a run: the same march, longer.

State, sides of switches, phases of contacts and the memory of the integrator are those with which
the earlier run ended. The steps of both are one march from the first start, so that what is read
off a run holds for the whole: outputs, events, energy, integrals, replays and gradients.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.analysis.contact.change import ContactChange
from dalembert.analysis.dynamics.run import DynamicsRun
from dalembert.analysis.dynamics.transition import Transition
from dalembert.errors import AnalysisError
from dalembert.integrators.marching.steps import Steps, Watch
from dalembert.results.motion import Motion
from dalembert.results.status import Outcome

GOES_ON = Outcome.COMPLETED, Outcome.TERMINATED, Outcome.INTERRUPTED
"""Runs that can be gone on with."""
OF_CONTACTS = "closed at one time", "closed after ever shorter bounces"


AT_ONCE = 1e-9
"""Part of what follows, in which an event that ended the run before is found again."""


def refuse_ended(motion: Motion, before: float) -> None:
    """A run that an event ended by some time does not go on.

    Raises
    ------
    AnalysisError
        Names the event.
    """
    if motion.status.outcome is Outcome.TERMINATED and motion.status.time <= before:
        raise AnalysisError(
            f"this run was ended by event {motion.events[-1].name!r} at "
            f"t = {motion.status.time:.9g} s; continue it with other events=, or events={{}} for "
            "none"
        )


class ContinuedRun(DynamicsRun):
    """A run that goes on from the end of another.

    Parameters
    ----------
    motion : the run before
    analysis : that of the whole, from the first start to the new end
    step : length of the steps that follow [s]

    Raises
    ------
    AnalysisError
        The run before broke down.
    """

    def __init__(self, motion: Motion, analysis: Any, step: float):
        if motion.status.outcome not in GOES_ON or not motion.record.steps.count:
            raise AnalysisError(f"this run cannot be continued, it ended {motion.status}")
        super().__init__(analysis, motion.model, motion.parameters)
        self.before, self.step = motion, step
        self.past: Steps = motion.record.steps
        self.begin = self.past.end
        if self.contacts is not None:
            self.contacts.impacts = list(motion.impacts)

    def initial_state(self) -> tuple[np.ndarray, int]:
        """The end of the run before, and the variant of the steps that follow."""
        super().initial_state()  # what is doubted about the start
        if self.contacts is not None:
            self.contacts.trouble = ""
        return np.asarray(self.past.x[:, self.past.count]), self._following()

    def _following(self) -> int:
        variants, mode = self.kernel.variants, int(self.past.mode[-1])
        last = variants[mode]
        if isinstance(last, ContactChange):
            return variants.index(last.after)
        return variants.index(last.variant) if isinstance(last, Transition) else mode

    @property
    def first_step(self) -> float:
        """One of the last two, of which the last was cut at the end."""
        return float(self.past.h[self.past.lasting[-2:]].max())

    @property
    def instants(self) -> np.ndarray:
        return np.append(self.before.time, self.grid[1:])

    def march(self, x0: np.ndarray, mode: int, watch: Watch) -> Steps:
        return self.kernel.fixed.joined(self.past, super().march(x0, mode, watch), self.p)

    def execute(self, progress: Any) -> Motion:
        made = super().execute(progress)
        refuse_ended(made, before=self.begin + AT_ONCE * (self.end - self.begin))
        for name in OF_CONTACTS:
            told = [m.statistics[name] for m in (self.before, made) if name in m.statistics]
            if told:
                made.statistics[name] = ", ".join(told)
        return made
