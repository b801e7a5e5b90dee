"""Batches of dynamics that march in lanes and threads.

All designs are assembled at once, store their states at the outputs only, and are checked at once.
Unsupported designs and designs that fail the checks run individually.
"""

from __future__ import annotations

import time as clock
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any

import numpy as np

from dalembert.analysis.batch.batch_residuals import BatchResiduals
from dalembert.analysis.batch.individual_runs import STOPPED, completed_batch
from dalembert.analysis.batch.starts import Starts, first_states, starting_mode
from dalembert.analysis.batch.states import MarchedStates
from dalembert.analysis.contact.located_pairs import collisions_of
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.run import DynamicsRun
from dalembert.analysis.dynamics.variant import Variant
from dalembert.errors import SingularityError
from dalembert.model.graph.model import Model
from dalembert.results.batch.batch import Batch
from dalembert.results.batch.designs import Designs
from dalembert.results.status import Status, reached
from dalembert.symbolic.evaluation.parallel import LaneMarch, in_groups


class DynamicsBatch(ABC):
    """Execution of a batch of dynamics.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Dynamics``
    model, designs : model and parameters of the runs
    workers : upper limit of threads
    """

    same_instants = True
    """All designs share the ends of steps, as required for integrals."""
    times: np.ndarray
    """(K,) outputs [s]."""
    marching: LaneMarch

    def __init__(self, analysis: Any, model: Model, designs: Designs, workers: int):
        self.analysis, self.model, self.designs = analysis, model, designs
        self.workers, self.count = workers, len(designs)
        self.run = DynamicsRun(analysis, model, None)  # raises errors common to all designs
        self.kernel: DynamicsKernel = self.run.kernel
        self.start = self.run.start
        self.mode = starting_mode(self.kernel, model)

    @classmethod
    @abstractmethod
    def serves(cls, analysis: Any, model: Model) -> bool:
        """Whether designs of this analysis can march together."""

    @staticmethod
    def starting_variant(analysis: Any, model: Model) -> Variant | None:
        """The variant of the nominal start; None if runs may change it."""
        if analysis.events or model.closure.lost or collisions_of(model):
            return None
        if analysis.strict and model.closure.recipe.projected:
            return None
        kernel = analysis.kernel(model)
        if kernel.contacts is not None or kernel.sampling is not None:
            return None
        try:
            variant: Variant = kernel.variants[starting_mode(kernel, model)]
        except SingularityError:  # other designs may still start
            return None
        return variant if variant.conditioning is None else None

    def execute(self, report: Callable[[float], None]) -> Batch:
        """Batch of all designs; after an interruption with the finished ones."""
        begin = clock.perf_counter()
        states, ended = self.march(report)
        started, marched = self.started - begin, clock.perf_counter() - self.started
        worst = self._verify(states, ended)
        statistics = {
            "backend": self.marching.report,
            "steps per design": self.steps_of_a_design,
            "assembly time [s]": round(started, 6),
            "integration time [s]": round(marched, 6),
        }
        interrupted = any(status is STOPPED for status in self.statuses.values())
        task = self.analysis, self.model, self.designs, self.workers
        batch = completed_batch(task, states, self.statuses, interrupted, statistics, begin)
        if states.time.size > self.times.size:  # the start or the end is not an output
            states.x = states.x[:, self.outputs]
        states.time = self.times
        batch.warnings = self._warnings(worst)
        return batch

    @property
    @abstractmethod
    def steps_of_a_design(self) -> int:
        """Number of steps, a mean where designs differ."""

    def march(self, report: Callable[[float], None]) -> tuple[MarchedStates, np.ndarray]:
        """States at the outputs, the start and the end, and numbers of the finished designs."""
        self.starts = Starts(
            self.model,
            self.designs,
            self.kernel.backend,
            self.workers,
            (self.start, self.run.end),
            self.kernel.formulation.needs_mass,
            first_states(self.kernel, self.mode),
        )
        self.statuses = self.starts.statuses
        self.started = clock.perf_counter()
        return self._march(self.starts.started, report)

    # the march ---------------------------------------------------------------------
    @abstractmethod
    def _march(
        self, started: np.ndarray, report: Callable[[float], None]
    ) -> tuple[MarchedStates, np.ndarray]:
        """States at the outputs, the start and the end, and numbers of the finished designs.

        Parameters
        ----------
        started : numbers of the designs with an assembled start
        """

    def _in_groups(
        self,
        march: LaneMarch,
        work: Callable[[np.ndarray], None],
        started: np.ndarray,
        report: Callable[[float], None],
    ) -> np.ndarray:
        """Call ``work`` for groups of started designs; return those that were not interrupted."""
        threads = self.workers if march.threaded else 1
        done = in_groups(work, np.arange(started.size), march.width, threads, report)
        for k in started[~done]:
            self.statuses[int(k)] = STOPPED
        return started[done]

    def _finite(self, x: np.ndarray, ended: np.ndarray) -> np.ndarray:
        """Designs with finite states; the others run individually."""
        finite = np.all(np.isfinite(x[ended]), axis=(1, 2))
        x[np.setdiff1d(np.arange(self.count), ended[finite])] = np.nan
        return ended[finite]

    def _marched(self, times: np.ndarray, x: np.ndarray) -> MarchedStates:
        """States (designs, times, size) of all designs."""
        self.outputs = np.searchsorted(times, self.times - 1e-12 * max(map(abs, times[[0, -1]])))
        return MarchedStates(
            self.model,
            self.kernel.variants[self.mode].bodies,
            self.kernel.backend,
            times,
            self.starts.p,
            x,
            self.workers,
            kernel=self.kernel,
            mode=self.mode,
        )

    def _partial(self, designs: np.ndarray, t, h, x: np.ndarray) -> np.ndarray:
        """(designs, count, size) states after parts of steps from (designs, count, size)."""
        count, size = x.shape[1:]
        (states,) = self.starts.evaluate(
            self.kernel.variants[self.mode].step.function,
            np.broadcast_to(t, x.shape[:2]).reshape(-1, 1),
            np.broadcast_to(h, x.shape[:2]).reshape(-1, 1),
            x.reshape(-1, size),
            np.repeat(self.starts.p[designs], count, axis=0),
        )
        return states.reshape(x.shape)

    # results ----------------------------------------------------------------------
    def _verify(self, states: MarchedStates, ended: np.ndarray) -> int | None:
        """Set the statuses of verified motions; return the design with the largest energy error."""
        if not ended.size:
            return None
        residuals = BatchResiduals(states, ended, self.outputs, self.analysis.balance)
        end, passed = reached(float(self.times[-1]), 0.0), ended[residuals.passed]
        violations = residuals.violations[residuals.passed]
        self.statuses |= {
            k: Status(end.outcome, end.message, end.time, violation)  # designs share the message
            for k, violation in zip(passed.tolist(), violations.tolist(), strict=True)
        }
        if not passed.size:
            return None
        return int(passed[np.argmax(residuals.unbalanced[residuals.passed])])

    def _warnings(self, worst: int | None) -> list[str]:
        """Warnings of the design with the largest energy error."""
        if worst is None:
            return []
        motion = self.analysis.run(self.model, self.designs.named(worst))
        return [f"design {worst}: {text}" for text in motion.warnings]
