"""Dynamics of many designs that march side by side, in lanes and threads.

All designs are assembled at once, keep their states at the outputs only, and are judged at once.
What cannot be, or does not pass, is run on its own.
"""

from __future__ import annotations

import time as clock
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any

import numpy as np

from dalembert.analysis.batch.judgement import Judgement
from dalembert.analysis.batch.one_by_one import STOPPED, OneByOne
from dalembert.analysis.batch.starts import Starts, first_states, starting_mode
from dalembert.analysis.batch.states import MarchedStates
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.run import DynamicsRun
from dalembert.analysis.dynamics.variant import Variant
from dalembert.budget import check_budget
from dalembert.errors import SingularityError
from dalembert.model.model import Model
from dalembert.results.batch.batch import Batch
from dalembert.results.batch.designs import Designs
from dalembert.results.status import Status, reached
from dalembert.symbolic.evaluation.lane_march import LaneMarch, in_groups


class SideBySide(ABC):
    """One execution of a batch.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Dynamics``
    model, designs : what is run
    workers : threads at most
    """

    same_instants = True
    """All designs have the same ends of steps, between which integrals are formed."""
    times: np.ndarray
    """(K,) outputs [s]."""
    marching: LaneMarch

    def __init__(self, analysis: Any, model: Model, designs: Designs, workers: int):
        self.analysis, self.model, self.designs = analysis, model, designs
        self.workers, self.count = workers, len(designs)
        self.run = DynamicsRun(analysis, model, None)  # which tells what is wrong for all designs
        self.kernel: DynamicsKernel = self.run.kernel
        self.start = self.run.start
        self.mode = starting_mode(self.kernel, model)

    @classmethod
    @abstractmethod
    def serves(cls, analysis: Any, model: Model) -> bool:
        """Whether designs of this analysis can march so."""

    @staticmethod
    def starting_variant(analysis: Any, model: Model) -> Variant | None:
        """The variant of the nominal start; None where runs may leave it."""
        if analysis.events or model.closure.lost:
            return None
        if analysis.strict and model.closure.recipe.projected:
            return None
        kernel = analysis.kernel(model)
        if kernel.contacts is not None:
            return None
        try:
            variant: Variant = kernel.variants[starting_mode(kernel, model)]
        except SingularityError:  # the nominal start is no measure of the others
            return None
        return variant if variant.conditioning is None else None

    def execute(self, report: Callable[[float], None]) -> Batch:
        """All designs; after an interruption those that were finished."""
        begin = clock.perf_counter()
        states, ended = self.march(report)
        started, marched = self.started - begin, clock.perf_counter() - self.started
        passed = self._judge(states, ended)
        runs = OneByOne(self.analysis, self.model, self.designs)
        if self.alone and not any(s is STOPPED for s in self.statuses.values()):
            runs.run(sorted(self.alone), self.workers, lambda fraction: None)
            self.statuses |= runs.statuses
        for k in self.alone:
            self.statuses.setdefault(k, STOPPED)
        self._refuse_nothing(runs)
        states.apart = runs.results
        if passed.size < self.count:
            states.x[np.setdiff1d(np.arange(self.count), passed)] = np.nan
        self._keep_outputs(states)
        elapsed = clock.perf_counter() - begin
        statistics = {
            "workers": self.workers,
            "backend": self.marching.report,
            "steps of a design": self.steps_of_a_design,
            "designs run on their own": len(self.alone),
            "assembly time [s]": round(started, 6),
            "integration time [s]": round(marched, 6),
            "computation time [s]": round(elapsed, 6),
        }
        return Batch(
            self.model,
            self.analysis,
            self.designs,
            [self.statuses[k] for k in range(self.count)],
            states,
            runs.results,
            statistics,
            self._warnings(passed),
        )

    @property
    @abstractmethod
    def steps_of_a_design(self) -> int:
        """Number of steps, a mean where designs differ."""

    def march(self, report: Callable[[float], None]) -> tuple[MarchedStates, np.ndarray]:
        """States at the outputs, the start and the end, and the designs that have them."""
        self.starts = Starts(
            self.model,
            self.designs,
            self.kernel.backend,
            self.workers,
            (self.start, self.run.end),
            self.kernel.formulation.needs_mass,
            first_states(self.kernel, self.mode),
        )
        self.statuses, self.alone = self.starts.statuses, self.starts.alone
        self.started = clock.perf_counter()
        return self._march(self.starts.known, report)

    # the march ---------------------------------------------------------------------
    @abstractmethod
    def _march(
        self, started: np.ndarray, report: Callable[[float], None]
    ) -> tuple[MarchedStates, np.ndarray]:
        """States at the outputs, the start and the end, and the designs that have them.

        Parameters
        ----------
        started : numbers of the designs that have a start
        """

    def _in_groups(
        self,
        march: LaneMarch,
        work: Callable[[np.ndarray], None],
        started: np.ndarray,
        report: Callable[[float], None],
    ) -> np.ndarray:
        """Do ``work`` for groups of the designs that start; those that were not interrupted."""
        threads = self.workers if march.threaded else 1
        done = in_groups(work, np.arange(started.size), march.width, threads, report)
        for k in started[~done]:
            self.statuses[int(k)] = STOPPED
        return started[done]

    def _finite(self, x: np.ndarray, ended: np.ndarray) -> np.ndarray:
        """The designs whose states are finite; the others are left to a run of their own."""
        finite = np.all(np.isfinite(x[ended]), axis=(1, 2))
        self.alone += [int(k) for k in ended[~finite]]
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
        """(designs, places, size) states after parts of steps from (designs, places, size)."""
        places, size = x.shape[1:]
        (moved,) = self.starts.evaluate(
            self.kernel.variants[self.mode].step.function,
            np.broadcast_to(t, x.shape[:2]).reshape(-1, 1),
            np.broadcast_to(h, x.shape[:2]).reshape(-1, 1),
            x.reshape(-1, size),
            np.repeat(self.starts.p[designs], places, axis=0),
        )
        return moved.reshape(x.shape)

    def _afford(self, size: int) -> None:
        """Refuse more outputs than can be kept."""
        check_budget(
            f"{self.count} designs with {self.times.size} outputs of {size} numbers",
            memory=24.0 * self.count * self.times.size * size,
            cure="ask for fewer, e.g. outputs=101, or run the designs in several batches",
        )

    # after it ----------------------------------------------------------------------
    def _judge(self, states: MarchedStates, ended: np.ndarray) -> np.ndarray:
        """Designs that are motions beyond doubt; the others are left to a run of their own."""
        self.worst: int | None = None
        if not ended.size:
            return ended
        found = Judgement(states, ended, self.outputs, self.analysis.balance)
        end = reached(float(self.times[-1]), 0.0)
        self.statuses |= {
            k: Status(end.outcome, end.message, end.time, residual)  # thousands of the same words
            for k, residual in zip(
                ended[found.passed].tolist(), found.violations[found.passed].tolist(), strict=True
            )
        }
        self.alone += [int(k) for k in ended[~found.passed]]
        passed = ended[found.passed]
        if passed.size:
            self.worst = int(passed[np.argmax(found.unbalanced[found.passed])])
        return passed

    def _keep_outputs(self, states: MarchedStates) -> None:
        """Without the start and end that were judged with them, where they are no outputs."""
        if states.time.size > self.times.size:
            states.x = states.x[:, self.outputs]
        states.time = self.times

    def _refuse_nothing(self, runs: OneByOne) -> None:
        """What is wrong for all designs for one reason is no design's fault."""
        texts = {status.message for status in self.statuses.values()}
        if len(texts) == 1 and len(runs.errors) == self.count:
            raise next(iter(runs.errors.values()))

    def _warnings(self, passed: np.ndarray) -> list[str]:
        """Doubts about the design whose energy is balanced worst."""
        if self.worst is None:
            return []
        motion = self.analysis.run(self.model, self.designs.named(self.worst))
        return [f"design {self.worst}: {text}" for text in motion.warnings]
