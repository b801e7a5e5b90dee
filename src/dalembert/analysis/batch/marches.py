"""Batches of dynamics: fixed steps that all designs share, or individual ones by error control.

Under error control attempted steps of several designs are evaluated in parallel, one design in each
lane; a design that has reached its end waits for the others of its group. Outputs inside steps are
partial steps of all designs at once. Designs that are stiff, have events or switches, or fail the
checks run individually.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.batch.dynamics_batch import DynamicsBatch
from dalembert.analysis.batch.states import MarchedStates, check_memory
from dalembert.analysis.output_places import outputs_of
from dalembert.analysis.timeline import uniform_grid
from dalembert.integrators.base import Attempt
from dalembert.integrators.marching.method_choice import STIFF, STIFF_SHARE
from dalembert.integrators.marching.steps import Steps
from dalembert.model.graph.model import Model
from dalembert.results.batch.designs import Designs
from dalembert.symbolic.evaluation.parallel import LaneMarch
from dalembert.symbolic.once import once


class FixedSteps(DynamicsBatch):
    """Execution of a batch with fixed steps."""

    def __init__(self, analysis: Any, model: Model, designs: Designs, workers: int):
        super().__init__(analysis, model, designs, workers)
        self.grid = uniform_grid(self.start, self.run.end, self.run.step)

    @classmethod
    def serves(cls, analysis: Any, model: Model) -> bool:
        """Whether all designs take the same steps."""
        if analysis.integrator.adaptive:
            return False
        variant, kernel = cls.starting_variant(analysis, model), analysis.kernel(model)
        return variant is not None and not kernel.fixed.at_once(kernel.variants.index(variant))

    @property
    def steps_of_a_design(self) -> int:
        return self.grid.size - 1

    def _march(
        self, started: np.ndarray, report: Callable[[float], None]
    ) -> tuple[MarchedStates, np.ndarray]:
        kernel, x0, h = self.kernel, self.starts.x0, np.diff(self.grid)
        number = np.arange(1, h.size + 1)
        corrected = (number % kernel.fixed.period == 0) | (number == h.size)
        steps = Steps(self.grid[:-1], h, x0[:1].T, corrected, np.full(h.size, self.mode))
        self.times, places = outputs_of(steps, self.run.requested)
        ends = places.index + places.ends_of(steps)
        stored = np.union1d(ends, [0, h.size])
        size = kernel.variants[self.mode].step.size
        check_memory(self.count, self.times.size, size)
        prepared = kernel.fixed.marched(self.mode).forms
        single, columns = prepared.side_by_side, kernel.fixed.columns(self.mode)
        self.marching = march = LaneMarch(single, columns, kernel.backend, h.size * started.size)
        q = self.starts.evaluate(prepared.values, self.starts.p[started])[0]
        x = np.full((self.count, stored.size, size), np.nan)
        x[started, 0] = x0
        shared = march.shared(steps.t, h, corrected.astype(float))

        def work(group: np.ndarray) -> None:
            x[started[group], 1:] = march.run(x0[group], shared, q[group], stored[1:] - 1)

        ended = self._finite(x, self._in_groups(march, work, started, report))
        times = self.grid[stored]
        inside = np.flatnonzero((places.length != 0) & ~places.ends_of(steps))
        if inside.size:
            begins = np.searchsorted(stored, ends[inside])
            partial = np.full((self.count, inside.size, size), np.nan)
            arguments = times[begins], places.length[inside], x[ended][:, begins]
            partial[ended] = self._partial(ended, *arguments)
            times, order = np.unique(np.append(times, self.times[inside]), return_index=True)
            x = np.concatenate([x, partial], axis=1)[:, order]
        return self._marched(times, x), ended


ATTEMPTS = 64
"""Number of attempts of each design per call."""
LONGEST = 20_000
"""Number of attempts after which a design runs individually."""
SUSPECTED = 256
"""Minimum number of steps before a design can count as stiff."""
USUAL = 500
"""Expected number of attempts of a design in the decision on machine code."""


class AdaptiveSteps(DynamicsBatch):
    """Execution of a batch with error control."""

    same_instants = False

    @classmethod
    def serves(cls, analysis: Any, model: Model) -> bool:
        """Whether runs consist of attempts of explicit steps only."""
        variant = cls.starting_variant(analysis, model)
        if variant is None or variant.equations.switches.count or variant.integrator.implicit:
            return False
        attempt = variant.attempt
        return (
            attempt is not None
            and attempt.function.is_a("SXFunction")
            and variant.step.begin is None
        )

    @property
    def steps_of_a_design(self) -> int:
        counts = self._accepted[self._accepted > 0]
        return round(float(np.mean(counts))) if counts.size else 0

    def _march(
        self, started: np.ndarray, report: Callable[[float], None]
    ) -> tuple[MarchedStates, np.ndarray]:
        kernel, run = self.kernel, self.run
        variant = kernel.variants[self.mode]
        attempt = variant.attempt
        assert attempt is not None and run.requested is not None
        self.times = run.requested
        times = np.union1d(self.times, [self.start, run.end])
        size = variant.step.size
        check_memory(self.count, self.times.size, size)
        function = _recorded(attempt)
        columns, work = kernel.backend.columns(function, True, (1,)), USUAL * started.size
        self.marching = march = LaneMarch(function, columns, kernel.backend, work)
        longest = kernel.integrator.longest_in(run.end - self.start)
        head = np.array([self.start, min(run.first_step, longest), *attempt.memory])
        step_begins = np.full((self.count, times.size, size + 2), np.nan)
        self._accepted = np.zeros(self.count, dtype=int)

        def go(group: np.ndarray) -> None:
            x0, designs = self.starts.x0[group], started[group]
            ends = np.tile([run.end, longest], (group.size, 1))
            fixed = np.hstack([ends, self.starts.p[designs]])
            state = np.hstack([np.tile(head, (group.size, 1)), x0, np.zeros((group.size, 5))])
            step_begins[designs] = self._states(march, state, fixed, times, head.size, designs)

        ended = self._in_groups(march, go, started, report)
        t, h = step_begins[ended, :, 0], step_begins[ended, :, 1]
        x_begin = step_begins[ended, :, 2:]
        x = np.full((self.count, times.size, size), np.nan)
        partial = self._partial(ended, t, h, x_begin)
        x[ended] = np.where(h[..., None] == 0, x_begin, partial)
        ended = self._finite(x, ended)
        return self._marched(times, x), ended

    def _states(
        self,
        march: LaneMarch,
        state: np.ndarray,
        fixed: np.ndarray,
        times: np.ndarray,
        head: int,
        designs: np.ndarray,
    ) -> np.ndarray:
        """(designs, times, 2 + size) begin of the step to each time, length of the part, state.

        NaN where a design has not reached a time.
        """
        size = state.shape[1] - head - 5
        begins = np.full((len(state), times.size, size + 2), np.nan)
        begins[:, 0] = np.hstack([state[:, :1], np.zeros((len(state), 1)), state[:, head:-5]])
        stiff, attempts = np.zeros(len(state)), 0
        while attempts < LONGEST and np.any(state[:, 0] < times[-1]):
            path = march.run(state, [], fixed, np.arange(ATTEMPTS), count=ATTEMPTS)
            before = np.concatenate([state[:, None], path[:, :-1]], axis=1)
            state, attempts = path[:, -1], attempts + ATTEMPTS
            for k, (old, new) in enumerate(zip(before, path, strict=True)):
                t, h, _, accepted, stiffness = new[:, -5:].T
                lasting = np.flatnonzero((accepted > 0.5) & (h > 0))
                self._accepted[designs[k]] += lasting.size
                stiff[k] += np.sum(stiffness[lasting] > STIFF)
                _store_partial_steps(
                    begins[k],
                    times,
                    old[lasting, head:-5],
                    t[lasting],
                    h[lasting],
                    new[lasting, 0],
                )
            steps = self._accepted[designs]
            too_stiff = (steps > SUSPECTED) & (stiff >= STIFF_SHARE * steps)
            if not np.all(np.isfinite(state)) or np.any(too_stiff):
                dropped = too_stiff | ~np.all(np.isfinite(state), axis=1)
                begins[dropped] = np.nan  # these run individually from the start
                state[dropped] = state[np.argmin(dropped)]
                if dropped.all():
                    break
        return begins


def _store_partial_steps(begins: np.ndarray, times: np.ndarray, x: np.ndarray, t, h, ends) -> None:
    """Store the partial steps to the times inside steps."""
    if not t.size:
        return
    first, last = np.searchsorted(times, [t[0], ends[-1]], side="right")
    inside = np.arange(first, last)
    step = np.searchsorted(ends, times[inside])
    begins[inside, 0], begins[inside, 2:] = t[step], x[step]
    begins[inside, 1] = np.where(times[inside] == ends[step], h[step], times[inside] - t[step])


@once
def _recorded(attempt: Attempt) -> ca.Function:
    """``([state; record], fixed) → [state; record]`` of one attempt."""
    function = attempt.function
    count, record_size = function.numel_in(0), function.numel_out(1)
    state_and_record = ca.SX.sym("s", count + record_size)
    fixed = ca.SX.sym("f", function.numel_in(1))
    out = function.call([state_and_record[:count], fixed])
    return ca.Function("recorded", [state_and_record, fixed], [ca.densify(ca.vertcat(*out))])
