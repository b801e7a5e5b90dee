"""Fixed steps whose ends are formulas of parameters, such as ``T/50``.

A step ``x_{k+1} = S(t_k, h_k, x_k, p)`` then also depends on the parameters by its time and length:

    dx_{k+1} = (∂S/∂x) dx_k + (∂S/∂p) dp + (∂S/∂t) dt_k + (∂S/∂h) (dt_{k+1} − dt_k).

Marches propagate the sum of all terms. At outputs they return derivatives at fixed times, without
the rate of the numerical motion times ``dt_k``; ``moving_times`` adds the motion of outputs.
Instants of impacts and events are fixed here.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.step_outputs import alike
from dalembert.analysis.timeline import checked_span, checked_step, uniform_grid
from dalembert.analysis.times import follow_parameters, slopes
from dalembert.integrators.marching.march import branches
from dalembert.integrators.marching.steps import Steps
from dalembert.integrators.step import Step
from dalembert.results.result import Result
from dalembert.results.status import Outcome
from dalembert.symbolic.once import once


def step_slopes(motion: Result) -> np.ndarray | None:
    """(K + 1, np) derivatives of the ends of fixed steps by the parameters; None if all vanish.

    Ends of steps follow the grid of the run, except at impacts and at an event that ends the run.
    """
    analysis: Any = motion.analysis
    kernel = getattr(motion.record, "kernel", None)
    if not isinstance(kernel, DynamicsKernel) or kernel.integrator.controls_error:
        return None
    if not follow_parameters(analysis):
        return None
    span = analysis.t_span
    ends = (0.0, analysis.duration) if span is None else span
    start, end = checked_span(analysis.duration, span)
    along = [slopes(t, motion.model, motion.parameters) for t in ends]
    step = checked_step(analysis.step, start, end)
    grid = uniform_grid(start, end, step)
    if analysis.step is None:
        by_step = (along[1] - along[0]) / (grid.size - 1)
    else:
        by_step = slopes(analysis.step, motion.model, motion.parameters)
    of_grid = along[0] + np.arange(grid.size)[:, None] * by_step
    of_grid[-1] = along[1]
    if not of_grid.any():
        return None
    steps: Steps = motion.record.steps
    times = np.append(steps.t[: steps.count], steps.end)
    of_ends = np.column_stack([np.interp(times, grid, column) for column in of_grid.T])
    instants = np.flatnonzero(steps.h == 0)
    of_ends[np.concatenate([instants, instants + 1]).astype(int)] = 0.0
    if motion.status.outcome is Outcome.TERMINATED:
        of_ends[-1] = 0.0
    return of_ends


class MovingSteps:
    """Contributions of moving ends of steps to changes of the states.

    Parameters
    ----------
    kernel, steps, p : kernel, steps and parameters of the run
    slopes : (K + 1, np) derivatives of the ends of its steps
    """

    def __init__(self, kernel: DynamicsKernel, steps: Steps, p: np.ndarray, slopes: np.ndarray):
        self.slopes, self.by_time, self.by_length = slopes, *_by_times(kernel, steps, p)

    def push(self, begin: int, end: int, unit: np.ndarray) -> np.ndarray:
        """(n, steps, c) contributions of these steps along directions (np, c)."""
        ends = self.slopes[begin : end + 1] @ unit[: self.slopes.shape[1]]
        by_time, by_length = (b[:, begin:end, None] for b in (self.by_time, self.by_length))
        added: np.ndarray = by_time * ends[None, :-1] + by_length * np.diff(ends, axis=0)[None]
        return added

    def pull(self, begin: int, end: int, weights: np.ndarray) -> np.ndarray:
        """(np,) weights of the parameters from weights (n, steps) of states after the steps."""
        by_time, by_length = (
            np.einsum("nk,nk->k", b[:, begin:end], weights) for b in (self.by_time, self.by_length)
        )
        ends = self.slopes[begin : end + 1]
        added: np.ndarray = by_time @ ends[:-1] + by_length @ np.diff(ends, axis=0)
        return added


def _by_times(kernel: DynamicsKernel, steps: Steps, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n, K) derivatives of the states after the steps by the time and the length of each."""
    size = steps.x.shape[0]
    by_time_and_length = np.zeros((2, size, steps.count))
    lasting = steps.lasting
    for mode, same_mode in alike(steps.mode[lasting], lasting):
        step = kernel.variants[mode].step
        for corrected in np.unique(steps.corrected[same_mode]):
            part = same_mode[steps.corrected[same_mode] == corrected]
            plain = branches(step, kernel.fixed.period) and not corrected
            rates = kernel.over(by_times(step.plain if plain else step), part.size)
            point = steps.t[part], steps.h[part], steps.x[:, part], np.tile(p[:, None], part.size)
            by_time_and_length[:, :, part] = rates(*point)
    return by_time_and_length[0], by_time_and_length[1]


@once
def by_times(step: Step) -> ca.Function:
    """``(t, h, x, p) → ∂S/∂t, ∂S/∂h``."""
    step = step.moving
    t, h, x, p = (ca.MX.sym(name, step.function.numel_in(i)) for i, name in enumerate("thxp"))
    new = step.function(t, h, x, p)
    zeros = ca.MX(x.numel(), 2), ca.MX(p.numel(), 2)
    both = step.function.forward(2)(t, h, x, p, new, ca.DM([[1, 0]]), ca.DM([[0, 1]]), *zeros)
    rates = [ca.densify(both[:, 0]), ca.densify(both[:, 1])]
    return ca.Function("by_times", [t, h, x, p], rates)
