"""Dynamics of many designs in steps of the same lengths.

All designs are assembled at once, march side by side in lanes and threads, keep their states at the
outputs only, and are judged at once. What cannot be, or does not pass, is run on its own.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from typing import Any

import numpy as np

from dalembert.analysis.batch.judgement import Judgement
from dalembert.analysis.batch.one_by_one import STOPPED, OneByOne
from dalembert.analysis.batch.starts import Starts, first_states, starting_mode
from dalembert.analysis.batch.states import MarchedStates
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.run import DynamicsRun
from dalembert.analysis.kinematics.branches import outputs_of
from dalembert.analysis.timeline import uniform_grid
from dalembert.budget import afford
from dalembert.errors import SingularityError
from dalembert.integrators.marching.steps import Steps
from dalembert.model.model import Model
from dalembert.results.batch.batch import Batch
from dalembert.results.batch.designs import Designs
from dalembert.results.status import Status, reached
from dalembert.symbolic.evaluation.lane_march import LaneMarch, in_groups


class FixedSteps:
    """One execution of a batch.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Dynamics``
    model, designs : what is run
    workers : threads at most
    """

    same_instants = True
    """All designs are known at the same ends of steps, between which integrals are formed."""

    def __init__(self, analysis: Any, model: Model, designs: Designs, workers: int):
        self.analysis, self.model, self.designs = analysis, model, designs
        self.workers, self.count = workers, len(designs)
        self.run = DynamicsRun(analysis, model, None)  # which tells what is wrong for all designs
        self.kernel: DynamicsKernel = self.run.kernel
        self.start = self.run.start
        self.grid = uniform_grid(self.start, self.run.end, self.run.step)
        self.mode = starting_mode(self.kernel, model)

    @classmethod
    def serves(cls, analysis: Any, model: Model) -> bool:
        """Whether all designs take the same steps."""
        if analysis.integrator.adaptive or analysis.events or model.closure.lost:
            return False
        if analysis.strict and model.closure.recipe.projected:
            return False
        kernel = analysis.kernel(model)
        if kernel.contacts is not None:
            return False
        try:
            mode = starting_mode(kernel, model)
        except SingularityError:  # the nominal start is no measure of the others
            return False
        return kernel.variants[mode].conditioning is None and not kernel.fixed.at_once(mode)

    def execute(self, report: Callable[[float], None]) -> Batch:
        """All designs; after an interruption those that were finished."""
        begin = clock.perf_counter()
        states, known = self.march(report)
        started, marched = self.started - begin, clock.perf_counter() - self.started
        passed = self._judge(states, known)
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
    def steps_of_a_design(self) -> int:
        return self.grid.size - 1

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
    def _march(
        self, known: np.ndarray, report: Callable[[float], None]
    ) -> tuple[MarchedStates, np.ndarray]:
        kernel, x0, h = self.kernel, self.starts.x0, np.diff(self.grid)
        number = np.arange(1, h.size + 1)
        corrected = (number % kernel.fixed.period == 0) | (number == h.size)
        steps = Steps(self.grid[:-1], h, x0[:1].T, corrected, np.full(h.size, self.mode))
        self.times, branches = outputs_of(steps, self.run.requested)
        ends = branches.index + branches.ends_of(steps)
        wanted = np.union1d(ends, [0, h.size])
        size = kernel.variants[self.mode].step.size
        self._afford(size)
        prepared = kernel.fixed.prepared(self.mode)
        self.marching = march = LaneMarch(
            prepared.side_by_side,
            kernel.fixed.columns(self.mode),
            kernel.backend,
            h.size * known.size,
        )
        q = self.starts.evaluate(prepared.values, self.starts.p[known])[0]
        x = np.empty((self.count, wanted.size, size))
        x[known, 0] = x0
        shared = march.shared(steps.t, h, corrected.astype(float))

        def work(group: np.ndarray) -> None:
            x[known[group], 1:] = march.run(x0[group], shared, q[group], wanted[1:] - 1)

        threads = self.workers if march.threaded else 1
        done = in_groups(work, np.arange(known.size), march.width, threads, report)
        for k in known[~done]:
            self.statuses[int(k)] = STOPPED
        known = known[done]
        finite = np.all(np.isfinite(x[known, -1]), axis=1)
        self.alone += [int(k) for k in known[~finite]]
        known = known[finite]
        x[np.setdiff1d(np.arange(self.count), known)] = np.nan
        times = self.grid[wanted]
        inside = np.flatnonzero((branches.length != 0) & ~branches.ends_of(steps))
        if inside.size:
            begins = np.searchsorted(wanted, ends[inside])
            moved = self._inside(x, known, begins, branches.length[inside], times)
            times, order = np.unique(np.append(times, self.times[inside]), return_index=True)
            x = np.concatenate([x, moved], axis=1)[:, order]
        self.outputs = np.searchsorted(times, self.times - steps.instant)
        states = MarchedStates(
            self.model,
            kernel.variants[self.mode].bodies,
            kernel.backend,
            times,
            self.starts.p,
            x,
            self.workers,
            kernel=kernel,
            mode=self.mode,
        )
        return states, known

    def _inside(self, x, known, begins, length, times) -> np.ndarray:
        """States inside steps, by a part of one."""
        moved = np.full((self.count, begins.size, x.shape[2]), np.nan)
        shape = known.size, begins.size
        (found,) = self.starts.evaluate(
            self.kernel.variants[self.mode].step.function,
            np.broadcast_to(times[begins], shape).reshape(-1, 1),
            np.broadcast_to(length, shape).reshape(-1, 1),
            x[known][:, begins].reshape(-1, x.shape[2]),
            np.repeat(self.starts.p[known], begins.size, axis=0),
        )
        moved[known] = found.reshape(*shape, -1)
        return moved

    def _afford(self, size: int) -> None:
        """Refuse more outputs than can be kept."""
        afford(
            f"{self.count} designs with {self.times.size} outputs of {size} numbers",
            memory=24.0 * self.count * self.times.size * size,
            cure="ask for fewer, e.g. outputs=101, or run the designs in several batches",
        )

    # after it ----------------------------------------------------------------------
    def _judge(self, states: MarchedStates, known: np.ndarray) -> np.ndarray:
        """Designs that are motions beyond doubt; the others are left to a run of their own."""
        self.worst: int | None = None
        if not known.size:
            return known
        found = Judgement(states, known, self.outputs, self.analysis.balance)
        end = reached(float(self.times[-1]), 0.0)
        self.statuses |= {
            k: Status(end.outcome, end.message, end.time, residual)  # thousands of the same words
            for k, residual in zip(
                known[found.passed].tolist(), found.violations[found.passed].tolist(), strict=True
            )
        }
        self.alone += [int(k) for k in known[~found.passed]]
        passed = known[found.passed]
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
