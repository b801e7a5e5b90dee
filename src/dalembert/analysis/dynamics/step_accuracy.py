"""Estimated error of a run: its steps are repeated in halves.

With steps of half the length a method of order q makes an error smaller by 2^q, so that the
difference of both runs is the error of the first, but for a factor of ``2^q / (2^q − 1)``. All
steps are repeated, so that the estimate follows how errors cancel and how the motion amplifies
them. Of runs too long for that a few steps are repeated, those in which the state changes fastest
among them; their errors are added up.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.step_outputs import alike
from dalembert.errors import SolverFailure
from dalembert.integrators.marching.checkpoints import Checkpoints
from dalembert.integrators.marching.steps import Steps

ALLOWED, TARGET = 1e-2, 5e-3
"""Estimated error, relative to the motion, up to which fixed steps raise no warning; that of the
steps that a warning proposes."""
ENOUGH = 10.0
"""A stated tolerance is kept up to this factor."""
ENTRIES, OPERATIONS = 2e7, 1e9
"""Numbers of states, and operations, up to which all steps are repeated."""
FASTEST, EVEN = 24, 16
"""Steps that are repeated of longer runs: where the state changes fastest, and evenly spaced."""
CANDIDATES = 20_000
"""Steps among which the fastest are looked for."""
SMALL = 1e-2
"""Way or speed, relative to the largest of the same unit: minimum size of an entry."""
REST = 1e-8
"""The same by natural sizes, for what stands still: rounding moves it, too."""


@dataclass(frozen=True)
class ErrorEstimate:
    """Largest estimated error over a run.

    Attributes
    ----------
    share : relative to the range of the coordinate, or to the largest magnitude of the speed;
        infinite where steps half as long fail
    name : of the coordinate or speed
    time : at which it is largest [s]
    """

    share: float
    name: str
    time: float

    def __str__(self) -> str:
        return self.text

    @property
    def text(self) -> str:
        if not self.name:
            return f"not known, because steps half as long fail at t = {self.time:.6g} s"
        of_motion = f"{self.share:.2g} times" if self.share >= 10 else f"{self.share:.2g} of"
        return f"{of_motion} its range or largest value, in {self.name} at t = {self.time:.6g} s"


class StepAccuracy:
    """The error of a run of steps of a one-step method.

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
        """The estimate, without bound where shorter steps fail; None where nothing moves."""
        if not self.steps.lasting.size:
            return None
        try:
            return self._of_all if self._affordable else self._of_some
        except SolverFailure:
            return ErrorEstimate(np.inf, "", float(self.steps.t[0]))

    def exceeds(self, limit: float) -> bool:
        """The estimate is above a limit."""
        return self.estimate is not None and self.estimate.share > limit

    @property
    def of_fixed_steps(self) -> list[str]:
        """Warning where fixed steps are too long for the motion."""
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

    def of_tolerance(self, rtol: float) -> list[str]:
        """Warning where a run with a relative tolerance for the whole does not keep it."""
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
    def _of_all(self) -> ErrorEstimate | None:
        halved = self.steps.divided(2)
        repeated = self.kernel.fixed.repeat(halved, self.steps.x[:, 0], self.p)
        if repeated.interrupted:
            raise KeyboardInterrupt
        if repeated.message:
            return ErrorEstimate(np.inf, "", repeated.end)
        ends = np.cumsum(np.where(self.steps.h > 0, 2, 1))
        x = self.steps.x[:, 1:][: self.size]
        order = self._order(int(self.steps.lasting[0]))
        error = (x - repeated.x[:, ends][: self.size]) * (2**order / (2**order - 1))
        start = self.steps.x[:, :1][: self.size]
        return self._largest(error, np.column_stack([start, x]), self.steps.t + self.steps.h)

    def _order(self, k: int) -> int:
        return self.kernel.variants[int(self.steps.mode[k])].integrator.convergence_order

    def _largest(self, error, seen: np.ndarray, times: np.ndarray) -> ErrorEstimate | None:
        """Where an error over some time is largest, relative to the motion."""
        sizes = self._sizes(seen)
        moving = np.flatnonzero(sizes > 0)
        if not moving.size:
            return None
        share = np.abs(error[moving]) / sizes[moving, None]
        share = np.where(np.isfinite(share), share, np.inf)
        row, k = np.unravel_index(int(np.argmax(share)), share.shape)
        names = [*self.kernel.view.names, *self.kernel.view.speed_names]
        speed = "" if moving[row] < self.positions else "speed of "
        name = speed + names[moving[row]]
        return ErrorEstimate(float(share[row, k]), name, float(times[k]))

    def _sizes(self, seen: np.ndarray) -> np.ndarray:
        """(n,) range of each coordinate, largest magnitude of each speed."""
        view = self.kernel.view
        way = np.ptp(seen[: self.positions], axis=1)
        speed = np.abs(seen[self.positions :]).max(axis=1)
        found = np.concatenate([_at_least(way, view.units), _at_least(speed, view.speed_units)])
        scales = self.kernel.equations.scales
        natural = REST * np.concatenate([scales.coordinates, scales.speeds])
        return np.maximum(found, np.where(found > 0, natural, 0.0))

    # some steps --------------------------------------------------------------------
    @property
    def _of_some(self) -> ErrorEstimate | None:
        """Errors of single steps, added up as if none cancelled and none were amplified."""
        x, chosen, share = self._chosen
        begins = self.steps.x[:, chosen]
        once, twice = self._ends(chosen, begins, 1), self._ends(chosen, begins, 2)
        order = self._order(int(chosen[0]))
        factor = 2**order / (2**order - 1)
        error = np.abs(once - twice) * factor
        error = (error * share).sum(axis=1, keepdims=True)
        end = np.array([self.steps.end])
        return self._largest(error, np.column_stack([x, once]), end)

    @property
    def _chosen(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """States looked at, numbers of some steps, and for how many steps each one stands."""
        steps, lasting = self.steps, self.steps.lasting
        kept = steps.x.number[:-1] if isinstance(steps.x, Checkpoints) else lasting
        kept = np.intersect1d(kept, lasting)
        kept = kept[:: max(1, kept.size // CANDIDATES)]
        x = steps.x[:, kept][: self.size]
        change = np.zeros(kept.size)
        if kept.size > 2:
            speeds = x[self.positions :]
            apart = np.abs(np.diff(speeds, axis=1)) / np.maximum(
                self._sizes(x)[self.positions :, None], 1e-300
            )
            change[1:] = apart.max(axis=0, initial=0.0)
        fastest = np.argsort(change)[::-1][:FASTEST]
        even = ((np.arange(EVEN) + 0.5) / EVEN * kept.size).astype(int)
        even = np.setdiff1d(even, fastest)
        places = np.concatenate([fastest, even])
        each = np.ones(places.size)
        each *= lasting.size / kept.size
        if even.size:
            each[fastest.size :] *= max(1.0, (kept.size - fastest.size) / even.size)
        return x, kept[places], each

    def _ends(self, chosen: np.ndarray, begins: np.ndarray, parts: int) -> np.ndarray:
        """Positions and speeds after some steps, each taken in so many parts."""
        x, t, h = begins.copy(), self.steps.t[chosen], self.steps.h[chosen] / parts
        for i in range(parts):
            for mode, some in alike(self.steps.mode[chosen], np.arange(chosen.size)):
                p = np.tile(self.p[:, None], some.size)
                step = self.kernel.over(self.kernel.variants[mode].step.function, some.size)
                (x[:, some],) = step(t[some] + i * h[some], h[some], x[:, some], p)
        return x[: self.size]


def _at_least(sizes: np.ndarray, units: list[str]) -> np.ndarray:
    """Sizes of entries, no smaller than a share of the largest one of the same unit."""
    kinds = np.array(units)
    largest = [sizes[kinds == unit].max() for unit in units]
    return np.maximum(sizes, SMALL * np.array(largest))
