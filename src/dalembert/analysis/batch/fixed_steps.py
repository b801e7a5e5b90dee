"""Dynamics of many designs in steps of the same lengths.

All designs are assembled at once, march side by side in lanes and threads, keep their states at the
outputs only, and are judged at once. What cannot be, or does not pass, is run on its own.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.batch.judgement import Judgement
from dalembert.analysis.batch.one_by_one import STOPPED, OneByOne
from dalembert.analysis.batch.states import MarchedStates
from dalembert.analysis.branches import outputs_of
from dalembert.analysis.dynamics_kernel import DynamicsKernel
from dalembert.analysis.dynamics_run import DynamicsRun
from dalembert.analysis.timeline import check_driver_laws, uniform_grid
from dalembert.budget import afford
from dalembert.elements.driver import Driver
from dalembert.errors import AnalysisError
from dalembert.integrators.steps import Steps
from dalembert.model.many_starts import ManyStarts
from dalembert.model.model import Model
from dalembert.results.batch import Batch
from dalembert.results.designs import Designs
from dalembert.results.status import Outcome, Status
from dalembert.symbolic.expression import stack
from dalembert.symbolic.lane_march import LaneMarch, in_groups
from dalembert.symbolic.once import once
from dalembert.symbolic.shared_columns import in_blocks


class FixedSteps:
    """One execution of a batch.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Dynamics``
    model, designs : what is run
    workers : threads at most
    """

    def __init__(self, analysis: Any, model: Model, designs: Designs, workers: int):
        self.analysis, self.model, self.designs = analysis, model, designs
        self.workers, self.count = workers, len(designs)
        self.run = DynamicsRun(analysis, model, None)  # which tells what is wrong for all designs
        self.kernel: DynamicsKernel = self.run.kernel
        self.start = self.run.start
        self.grid = uniform_grid(self.start, self.run.end, self.run.step)
        self.statuses: dict[int, Status] = {}
        self.alone: list[int] = []

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
        mode = _mode(kernel, model)
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
            "steps of a design": self.grid.size - 1,
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

    def march(self, report: Callable[[float], None]) -> tuple[MarchedStates, np.ndarray]:
        """States at the outputs, the start and the end, and the designs that have them."""
        self.p = self._parameters()
        known = np.setdiff1d(np.arange(self.count), self.alone)
        self.x0, known = self._starts(known)
        self.started = clock.perf_counter()
        return self._march(known, report)

    # before the march --------------------------------------------------------------
    def _parameters(self) -> np.ndarray:
        """(designs, n) all that functions take for parameters; what may be wrong runs alone."""
        table, model = self.designs.values, self.model
        suspect = model.doubtful(table)
        p = np.tile(model.nominal, (self.count, 1))
        if model.parts.space.computed:
            for k in np.flatnonzero(~suspect):
                p[k] = model.completed(table[k])
        else:
            p[~suspect] = table[~suspect]
        suspect |= self._lose_mass(p)
        if any(isinstance(c, Driver) and c.positive for c in model.constraints):
            instants = np.linspace(self.start, self.run.end, 1001)
            for k in np.flatnonzero(~suspect):
                try:
                    check_driver_laws(model, instants, p[k])
                except AnalysisError:
                    suspect[k] = True
        self.alone = [int(k) for k in np.flatnonzero(suspect)]
        return p

    def _lose_mass(self, p: np.ndarray) -> np.ndarray:
        """(designs,) where a mass is zero that was not when the model was built."""
        if not self.analysis.formulation.needs_mass:
            return np.zeros(self.count, dtype=bool)
        y = np.tile(self.model.start.y, (self.count, 1))
        (mass,) = self._evaluate(_masses(self.model), y, p)
        mass[:, list(self.model.equations.massless)] = 1.0
        return np.any(mass == 0, axis=1)

    def _evaluate(self, function: ca.Function, *arguments: np.ndarray) -> list[np.ndarray]:
        return in_blocks(self.kernel.backend.columns(function), self.workers, *arguments)

    def _starts(self, known: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First states of the designs that can be assembled, and which these are."""
        many, p = ManyStarts(self.model.closure, self._evaluate), self.p[known]
        y, reached, found = many.positions(p, self.start)
        first = self.model.closure.anchor[0]
        if (lost := np.flatnonzero(~found)).size:
            there = first + reached[lost, None] * (p[lost] - first)
            for k, row, gap in zip(
                known[lost], *many.gaps(self.start, y[lost], there), strict=True
            ):
                self.statuses[int(k)] = self._open(int(row), float(gap))
        p, known = p[found], known[found]
        t = np.full((known.size, 1), self.start)
        (x0,) = self._evaluate(self._first_states, t, y[found], p)
        defined = np.all(np.isfinite(x0), axis=1)
        self.alone += [int(k) for k in known[~defined]]
        self.y0 = np.full((self.count, y.shape[1]), np.nan)
        self.y0[known] = y[found]
        return x0[defined], known[defined]

    def _open(self, row: int, gap: float) -> Status:
        """Of a design that cannot be assembled; what stays open most stands for all."""
        name, unit = "an initial condition", ""
        if row >= 0:
            constraint, k = self.model.closure.owners[row]
            name, unit = constraint.name, constraint.units()[k]
        return Status(
            Outcome.NOT_ASSEMBLED,
            f"cannot be assembled at t = {self.start:g} s: {name} stays open by {gap:.3g} {unit}; "
            "the design alone tells more",
            float("nan"),
            gap,
        )

    @property
    def _first_states(self) -> ca.Function:
        """``(t, y, p) → x`` with speeds, and memory."""
        return _first_states(self.kernel, self.mode)

    @cached_property
    def mode(self) -> int:
        return _mode(self.kernel, self.model)

    # the march ---------------------------------------------------------------------
    def _march(
        self, known: np.ndarray, report: Callable[[float], None]
    ) -> tuple[MarchedStates, np.ndarray]:
        kernel, x0, h = self.kernel, self.x0, np.diff(self.grid)
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
            prepared.called or prepared.function,
            kernel.fixed.columns(self.mode),
            kernel.backend,
            h.size * known.size,
        )
        q = self._evaluate(prepared.values, self.p[known])[0]
        x = np.empty((self.count, wanted.size, size))
        x[known, 0] = x0
        shared = [steps.t, h, corrected.astype(float)]

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
        states = MarchedStates(self.model, self.kernel, self.mode, times, self.p, x, self.workers)
        return states, known

    def _inside(self, x, known, begins, length, times) -> np.ndarray:
        """States inside steps, by a part of one."""
        moved = np.full((self.count, begins.size, x.shape[2]), np.nan)
        shape = known.size, begins.size
        (found,) = self._evaluate(
            self.kernel.variants[self.mode].step.function,
            np.broadcast_to(times[begins], shape).reshape(-1, 1),
            np.broadcast_to(length, shape).reshape(-1, 1),
            x[known][:, begins].reshape(-1, x.shape[2]),
            np.repeat(self.p[known], begins.size, axis=0),
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
        end, text = float(self.times[-1]), f"reached t = {self.times[-1]:g} s"
        for k, residual in zip(known[found.passed], found.violations[found.passed], strict=True):
            self.statuses[int(k)] = Status(Outcome.COMPLETED, text, end, float(residual))
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


def _mode(kernel: DynamicsKernel, model: Model) -> int:
    """The variant of the nominal start."""
    start, p = model.start, model.nominal
    x = kernel.start.function(0.0, start.y, start.v, p).full().ravel()
    return kernel.choose(0.0, x, p)


@once
def _masses(model: Model) -> ca.Function:
    """``(y, p) →`` diagonal of the mass matrix."""
    e = model.all_equations
    return ca.Function("masses", [e.y, e.p], [ca.densify(stack([ca.diag(e.mass)]))])


@once
def _first_states(kernel: DynamicsKernel, mode: int) -> ca.Function:
    """``(t, y, p) → x`` of assembled positions."""
    model = kernel.model
    t, y, p = (ca.SX.sym(s, n) for s, n in zip("typ", model.initial_state.input_sizes, strict=True))
    place, speeds = model.initial_state.function(t, y, p)
    x = kernel.start.function(t, place, speeds, p)
    step = kernel.variants[mode].step
    if step.begin is None:
        return ca.Function("first", [t, y, p], [x], {"cse": True})
    first = ca.Function("first", [t, y, p], [x])
    given = [ca.MX.sym(s, n) for s, n in zip("typ", model.initial_state.input_sizes, strict=True)]
    state = first(*given)
    memory = step.begin(given[0], state, given[2])
    return ca.Function("first", given, [ca.densify(ca.vertcat(state, memory))])
