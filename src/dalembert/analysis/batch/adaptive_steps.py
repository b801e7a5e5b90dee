"""Dynamics of many designs under error control, each with steps of its own.

Attempted steps of several designs are evaluated side by side, one in each lane; a design that has
come to its end waits for the others of its group. Outputs inside steps follow by parts of steps, of
all designs at once. What is stiff, has events or switches, or does not pass the checks runs alone.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.batch.side_by_side import SideBySide
from dalembert.analysis.batch.states import MarchedStates
from dalembert.integrators.base import Attempt
from dalembert.integrators.marching.method_choice import STIFF, STIFF_SHARE
from dalembert.model.model import Model
from dalembert.symbolic.evaluation.lane_march import LaneMarch
from dalembert.symbolic.once import once

ATTEMPTS = 64
"""Attempts of each design in a call."""
LONGEST = 20_000
"""Attempts after which a design is left to a run of its own."""
SUSPECTED = 256
"""Attempts from which on a design is judged stiff."""
USUAL = 500
"""Attempts of a design that are expected when machine code is weighed."""


class AdaptiveSteps(SideBySide):
    """One execution of a batch with error control."""

    same_instants = False

    @classmethod
    def serves(cls, analysis: Any, model: Model) -> bool:
        """Whether attempts of explicit steps are all that runs take."""
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
        return round(float(np.mean(self._taken[self._taken > 0]))) if self._taken.any() else 0

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
        self._afford(size)
        function = _recorded(attempt)
        columns, work = kernel.backend.columns(function, True, (1,)), USUAL * started.size
        self.marching = march = LaneMarch(function, columns, kernel.backend, work)
        longest = kernel.integrator.longest_in(run.end - self.start)
        head = np.array([self.start, min(run.first_step, longest), *attempt.memory])
        begins = np.full((self.count, times.size, size + 2), np.nan)
        self._taken = np.zeros(self.count, dtype=int)

        def go(group: np.ndarray) -> None:
            x0, designs = self.starts.x0[group], started[group]
            ends = np.tile([run.end, longest], (group.size, 1))
            fixed = np.hstack([ends, self.starts.p[designs]])
            state = np.hstack([np.tile(head, (group.size, 1)), x0, np.zeros((group.size, 5))])
            begins[designs] = self._states(march, state, fixed, times, head.size, designs)

        ended = self._in_groups(march, go, started, report)
        t, h, x_begin = begins[ended, :, 0], begins[ended, :, 1], begins[ended, :, 2:]
        x = np.full((self.count, times.size, size), np.nan)
        moved = self._partial(ended, t, h, x_begin)
        x[ended] = np.where(h[..., None] == 0, x_begin, moved)
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

        NaN where a design has not come to a time.
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
                taken = np.flatnonzero((accepted > 0.5) & (h > 0))
                self._taken[designs[k]] += taken.size
                stiff[k] += np.sum(stiffness[taken] > STIFF)
                _place(begins[k], times, old[taken, head:-5], t[taken], h[taken], new[taken, 0])
            steps = self._taken[designs]
            late = (steps > SUSPECTED) & (stiff >= STIFF_SHARE * steps)
            if not np.all(np.isfinite(state)) or np.any(late):
                lost = late | ~np.all(np.isfinite(state), axis=1)
                begins[lost], state[lost] = np.nan, state[np.argmin(lost)]  # lost from the start
                if lost.all():
                    break
        return begins


def _place(begins: np.ndarray, times: np.ndarray, x: np.ndarray, t, h, ends) -> None:
    """Parts of steps to the times that lie in them."""
    if not t.size:
        return
    first, last = np.searchsorted(times, [t[0], ends[-1]], side="right")
    wanted = np.arange(first, last)
    step = np.searchsorted(ends, times[wanted])
    begins[wanted, 0], begins[wanted, 2:] = t[step], x[step]
    begins[wanted, 1] = np.where(times[wanted] == ends[step], h[step], times[wanted] - t[step])


@once
def _recorded(attempt: Attempt) -> ca.Function:
    """``([state; record], fixed) → [state; record]`` of one attempt."""
    function = attempt.function
    count, more = function.numel_in(0), function.numel_out(1)
    both, fixed = ca.SX.sym("s", count + more), ca.SX.sym("f", function.numel_in(1))
    out = function.call([both[:count], fixed])
    return ca.Function("recorded", [both, fixed], [ca.densify(ca.vertcat(*out))])
