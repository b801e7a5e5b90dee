"""Error estimate of a run by repetition with halved steps.

With steps of half the length the error of a method of order q is smaller by 2^q, so the error of
the run is the difference of both runs times ``2^q / (2^q − 1)``. All steps are repeated, so the
estimate includes cancellation of errors and their amplification by the motion. Of long runs only
some steps are repeated, among them those in which the state changes fastest, and their errors are
added.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.step_outputs import columns_by_mode
from dalembert.analysis.error_estimate import ErrorEstimate, largest_error, motion_sizes
from dalembert.errors import SolverFailure
from dalembert.integrators.marching.checkpoints import Checkpoints
from dalembert.integrators.marching.steps import Steps

ALLOWED, TARGET = 1e-2, 5e-3
"""Estimated error, relative to the motion: threshold for a warning about fixed steps, and target of
the proposed steps."""
ENOUGH = 10.0
"""Threshold for a warning: factor by which the estimate exceeds the relative tolerance."""
ENTRIES, OPERATIONS = 2e7, 1e9
"""Upper limits for a repetition of all steps: number of state entries, and of operations."""
FASTEST, EVEN = 24, 16
"""Numbers of repeated steps of longer runs: fastest changes of the state, and evenly spaced."""
CANDIDATES = 20_000
"""Upper limit of the number of steps in the search for the fastest changes."""


class StepAccuracy:
    """Error of a run of a one-step method.

    Parameters
    ----------
    kernel : DynamicsKernel of the run
    steps : Steps taken
    p : (np,) parameters
    """

    def __init__(self, kernel: DynamicsKernel, steps: Steps, p: np.ndarray):
        self.kernel, self.steps, self.p = kernel, steps, p
        e = kernel.equations
        self.positions, self.size = e.coordinate_count, e.coordinate_count + e.speed_count

    @cached_property
    def estimate(self) -> ErrorEstimate | None:
        """The estimate, infinite where shorter steps fail; None where nothing moves."""
        if not self.steps.lasting.size:
            return None
        try:
            return self._from_all_steps if self._affordable else self._from_some_steps
        except SolverFailure:
            return ErrorEstimate(np.inf, "", float(self.steps.t[0]), "half")

    def exceeds(self, limit: float) -> bool:
        """The estimate is above a limit."""
        return self.estimate is not None and self.estimate.share > limit

    @property
    def fixed_step_warnings(self) -> list[str]:
        """Warning if fixed steps are too long for the motion."""
        if not self.exceeds(ALLOWED) or self.estimate is None:
            return []
        lasting = self.steps.lasting
        h, order = float(np.median(self.steps.h[lasting])), self._order(int(lasting[0]))
        shorter = h * (TARGET / min(self.estimate.share, 1.0)) ** (1 / order)
        return [
            f"steps of {h:.3g} s are long for this motion: their estimated error is "
            f"{self.estimate.text}; use steps below {shorter:.2g} s, or an integrator with error "
            "control"
        ]

    def tolerance_warnings(self, rtol: float) -> list[str]:
        """Warning if a run exceeds its relative tolerance for the whole run."""
        if not self.exceeds(ENOUGH * rtol) or self.estimate is None:
            return []
        text = f"the estimated error of the run is {self.estimate.text}, above rtol = {rtol:g}"
        if self.estimate.share > ALLOWED:
            return [
                f"{text}: the motion amplifies small differences, or it is as small as the "
                "absolute tolerance; use a smaller rtol and atol"
            ]
        return [f"{text}, because errors of the steps accumulate; use a smaller rtol and atol"]

    # all steps ---------------------------------------------------------------------
    @property
    def _affordable(self) -> bool:
        modes, counts = np.unique(self.steps.mode[self.steps.lasting], return_counts=True)
        steps = [self.kernel.variants[int(mode)].step for mode in modes]
        operations = sum(2 * n * step.work for n, step in zip(counts, steps, strict=True))
        return operations <= OPERATIONS and 3 * counts.sum() * steps[0].size <= ENTRIES

    @property
    def _from_all_steps(self) -> ErrorEstimate | None:
        halved = self.steps.divided(2)
        repeated = self.kernel.fixed.repeat(halved, self.steps.x[:, 0], self.p)
        if repeated.interrupted:
            raise KeyboardInterrupt
        if repeated.message:
            return ErrorEstimate(np.inf, "", repeated.end, "half")
        ends = np.cumsum(np.where(self.steps.h > 0, 2, 1))
        x = self.steps.x[:, 1:][: self.size]
        order = self._order(int(self.steps.lasting[0]))
        error = (x - repeated.x[:, ends][: self.size]) * (2**order / (2**order - 1))
        start = self.steps.x[:, :1][: self.size]
        return self._largest(error, np.column_stack([start, x]), self.steps.t + self.steps.h)

    def _order(self, k: int) -> int:
        return self.kernel.variants[int(self.steps.mode[k])].integrator.convergence_order

    def _largest(self, error, states: np.ndarray, times: np.ndarray) -> ErrorEstimate | None:
        """Largest error over some times, relative to the motion."""
        view = self.kernel.view
        names = [*view.names, *(f"speed of {name}" for name in view.speed_names)]
        return largest_error(error, self._sizes(states), names, times)

    def _sizes(self, states: np.ndarray) -> np.ndarray:
        """(n,) range of each coordinate, largest magnitude of each speed."""
        view, scales = self.kernel.view, self.kernel.equations.scales
        ranges = np.ptp(states[: self.positions], axis=1)
        speeds = np.abs(states[self.positions :]).max(axis=1)
        return np.concatenate(
            [
                motion_sizes(ranges, view.units, scales.coordinates),
                motion_sizes(speeds, view.speed_units, scales.speeds),
            ]
        )

    # some steps --------------------------------------------------------------------
    @property
    def _from_some_steps(self) -> ErrorEstimate | None:
        """Sum of the errors of single steps, without cancellation or amplification."""
        x, chosen, share = self._sample
        begins = self.steps.x[:, chosen]
        whole, halved = self._ends(chosen, begins, 1), self._ends(chosen, begins, 2)
        order = self._order(int(chosen[0]))
        factor = 2**order / (2**order - 1)
        error = np.abs(whole - halved) * factor
        error = (error * share).sum(axis=1, keepdims=True)
        end = np.array([self.steps.end])
        return self._largest(error, np.column_stack([x, whole]), end)

    @property
    def _sample(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Candidate states, numbers of the sampled steps, and number of steps each represents."""
        steps, lasting = self.steps, self.steps.lasting
        candidates = steps.x.number[:-1] if isinstance(steps.x, Checkpoints) else lasting
        candidates = np.intersect1d(candidates, lasting)
        candidates = candidates[:: max(1, candidates.size // CANDIDATES)]
        x = steps.x[:, candidates][: self.size]
        change = np.zeros(candidates.size)
        if candidates.size > 2:
            speeds = x[self.positions :]
            changes = np.abs(np.diff(speeds, axis=1)) / np.maximum(
                self._sizes(x)[self.positions :, None], 1e-300
            )
            change[1:] = changes.max(axis=0, initial=0.0)
        fastest = np.argsort(change)[::-1][:FASTEST]
        even = ((np.arange(EVEN) + 0.5) / EVEN * candidates.size).astype(int)
        even = np.setdiff1d(even, fastest)
        sampled = np.concatenate([fastest, even])
        represented = np.ones(sampled.size)
        represented *= lasting.size / candidates.size
        if even.size:
            represented[fastest.size :] *= max(1.0, (candidates.size - fastest.size) / even.size)
        return x, candidates[sampled], represented

    def _ends(self, chosen: np.ndarray, begins: np.ndarray, parts: int) -> np.ndarray:
        """Positions and speeds after some steps, each divided into equal parts."""
        x, t, h = begins.copy(), self.steps.t[chosen], self.steps.h[chosen] / parts
        for i in range(parts):
            for mode, some in columns_by_mode(self.steps.mode[chosen], np.arange(chosen.size)):
                p = np.tile(self.p[:, None], some.size)
                step = self.kernel.over(self.kernel.variants[mode].step.function, some.size)
                (x[:, some],) = step(t[some] + i * h[some], h[some], x[:, some], p)
        return x[: self.size]
