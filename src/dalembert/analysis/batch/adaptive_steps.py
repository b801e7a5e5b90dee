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

from dalembert.analysis.batch.fixed_steps import FixedSteps
from dalembert.analysis.batch.one_by_one import STOPPED
from dalembert.analysis.batch.starts import starting_mode
from dalembert.analysis.batch.states import MarchedStates
from dalembert.errors import SingularityError
from dalembert.integrators.base import Attempt
from dalembert.integrators.marching.method_choice import MOST, STIFF
from dalembert.model.model import Model
from dalembert.symbolic.evaluation.lane_march import LaneMarch, in_groups
from dalembert.symbolic.once import once

ATTEMPTS = 64
"""Attempts of each design in a call."""
LONGEST = 20_000
"""Attempts after which a design is left to a run of its own."""
SUSPECTED = 256
"""Attempts from which on a design is judged stiff."""
USUAL = 500
"""Attempts of a design that are expected when machine code is weighed."""


class AdaptiveSteps(FixedSteps):
    """One execution of a batch with error control."""

    same_instants = False

    @classmethod
    def serves(cls, analysis: Any, model: Model) -> bool:
        """Whether attempts of explicit steps are all that runs take."""
        if analysis.events or model.closure.lost:
            return False
        if analysis.strict and model.closure.recipe.projected:
            return False
        kernel = analysis.kernel(model)
        if kernel.contacts is not None or kernel.equations.switches.count:
            return False
        if kernel.methods[0].implicit:
            return False
        try:
            variant = kernel.variants[starting_mode(kernel, model)]
        except SingularityError:  # the nominal start is no measure of the others
            return False
        attempt = variant.attempt
        side_by_side = attempt is not None and attempt.function.is_a("SXFunction")
        return side_by_side and variant.conditioning is None and variant.step.begin is None

    def _march(
        self, known: np.ndarray, report: Callable[[float], None]
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
        columns = kernel.backend.columns(function, True, (1,))
        work = USUAL * known.size
        self.marching = march = LaneMarch(function, columns, kernel.backend, work)
        longest = kernel.integrator.longest_in(run.end - self.start)
        head = np.array([self.start, min(run.first_step, longest), *attempt.memory])
        begins = np.full((self.count, times.size, size + 2), np.nan)
        self._taken = np.zeros(self.count, dtype=int)

        def go(group: np.ndarray) -> None:
            x0 = self.starts.x0[group]
            ends = np.tile([run.end, longest], (group.size, 1))
            fixed = np.hstack([ends, self.starts.p[known[group]]])
            state = np.hstack([np.tile(head, (group.size, 1)), x0, np.zeros((group.size, 5))])
            begins[known[group]] = self._states(march, state, fixed, times, head.size, known[group])

        threads = self.workers if march.threaded else 1
        done = in_groups(go, np.arange(known.size), march.width, threads, report)
        for k in known[~done]:
            self.statuses[int(k)] = STOPPED
        known = known[done]
        x = np.full((self.count, times.size, size), np.nan)
        (found,) = self.starts.evaluate(
            variant.step.function,
            begins[known, :, 0].reshape(-1, 1),
            begins[known, :, 1].reshape(-1, 1),
            begins[known, :, 2:].reshape(-1, size),
            np.repeat(self.starts.p[known], times.size, axis=0),
        )
        x[known] = found.reshape(known.size, times.size, size)
        arrived = begins[known, :, 1] == 0
        x[known] = np.where(arrived[..., None], begins[known][..., 2:], x[known])
        finite = np.all(np.isfinite(x[known]), axis=(1, 2))
        self.alone += [int(k) for k in known[~finite]]
        known = known[finite]
        x[np.setdiff1d(np.arange(self.count), known)] = np.nan
        self.outputs = np.searchsorted(times, self.times)
        states = MarchedStates(
            self.model,
            variant.bodies,
            kernel.backend,
            times,
            self.starts.p,
            x,
            self.workers,
            kernel=kernel,
            mode=self.mode,
        )
        return states, known

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
        found = np.full((len(state), times.size, size + 2), np.nan)
        found[:, 0] = np.hstack([state[:, :1], np.zeros((len(state), 1)), state[:, head:-5]])
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
                _place(found[k], times, old[taken, head:-5], t[taken], h[taken], new[taken, 0])
            steps = self._taken[designs]
            late = (steps > SUSPECTED) & (stiff >= MOST * steps)
            if not np.all(np.isfinite(state)) or np.any(late):
                lost = late | ~np.all(np.isfinite(state), axis=1)
                found[lost], state[lost] = np.nan, state[np.argmin(lost)]
                if lost.all():
                    break
        return found

    @property
    def steps_of_a_design(self) -> int:
        """The mean of what they took."""
        return round(float(np.mean(self._taken[self._taken > 0]))) if self._taken.any() else 0


def _place(found: np.ndarray, times: np.ndarray, x: np.ndarray, t, h, ends) -> None:
    """Parts of steps to the times that lie in them."""
    if not t.size:
        return
    first, last = np.searchsorted(times, [t[0], ends[-1]], side="right")
    wanted = np.arange(first, last)
    step = np.searchsorted(ends, times[wanted])
    found[wanted, 0], found[wanted, 2:] = t[step], x[step]
    found[wanted, 1] = np.where(times[wanted] == ends[step], h[step], times[wanted] - t[step])


@once
def _recorded(attempt: Attempt) -> ca.Function:
    """``([state; record], fixed) → [state; record]`` of one attempt."""
    function = attempt.function
    count, more = function.numel_in(0), function.numel_out(1)
    both, fixed = ca.SX.sym("s", count + more), ca.SX.sym("f", function.numel_in(1))
    out = function.call([both[:count], fixed])
    return ca.Function("recorded", [both, fixed], [ca.densify(ca.vertcat(*out))])
