"""Fixed steps whose ends are formulas of parameters, such as ``T/50``.

A step ``x_{k+1} = S(t_k, h_k, x_k, p)`` then depends on the parameters by its time and its length,
too:

    dx_{k+1} = (∂S/∂x) dx_k + (∂S/∂p) dp + (∂S/∂t) dt_k + (∂S/∂h) (dt_{k+1} − dt_k).

Marches carry the sum of all. At outputs they return derivatives at fixed times, less the rate of
the numerical motion times ``dt_k``; ``moving_times`` adds how outputs move. Instants of impacts and
events are held here, too.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.step_outputs import columns_by_mode
from dalembert.analysis.timeline import checked_span, checked_step, uniform_grid
from dalembert.analysis.times import follow_parameters, slopes
from dalembert.integrators.marching.march import branches
from dalembert.integrators.marching.steps import Steps
from dalembert.integrators.step import Step
from dalembert.results.result import Result
from dalembert.results.status import Outcome
from dalembert.symbolic.once import once


def step_slopes(motion: Result) -> np.ndarray | None:
    """(K + 1, np) derivatives of the ends of fixed steps by the parameters; None where none move.

    The ends of steps follow the grid of the run, those at impacts and at an event that ends the run
    do not.
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
        each = (along[1] - along[0]) / (grid.size - 1)
    else:
        each = slopes(analysis.step, motion.model, motion.parameters)
    moves = along[0] + np.arange(grid.size)[:, None] * each
    moves[-1] = along[1]
    if not moves.any():
        return None
    steps: Steps = motion.record.steps
    times = np.append(steps.t[: steps.count], steps.end)
    found = np.column_stack([np.interp(times, grid, column) for column in moves.T])
    still = np.flatnonzero(steps.h == 0)
    found[np.concatenate([still, still + 1]).astype(int)] = 0.0
    if motion.status.outcome is Outcome.TERMINATED:
        found[-1] = 0.0
    return found


class MovingSteps:
    """What moving ends of steps add to changes of the states.

    Parameters
    ----------
    kernel, steps, p : of the run
    slopes : (K + 1, np) of the ends of its steps
    """

    def __init__(self, kernel: DynamicsKernel, steps: Steps, p: np.ndarray, slopes: np.ndarray):
        self.slopes, self.by_time, self.by_length = slopes, *_by_times(kernel, steps, p)

    def pushed(self, begin: int, end: int, unit: np.ndarray) -> np.ndarray:
        """(n, steps, c) what these steps add along directions (np, c)."""
        ends = self.slopes[begin : end + 1] @ unit[: self.slopes.shape[1]]
        by_time, by_length = (b[:, begin:end, None] for b in (self.by_time, self.by_length))
        added: np.ndarray = by_time * ends[None, :-1] + by_length * np.diff(ends, axis=0)[None]
        return added

    def pulled(self, begin: int, end: int, weights: np.ndarray) -> np.ndarray:
        """(np,) weights of the parameters by those (n, steps) of the states after these steps."""
        by_time, by_length = (
            np.einsum("nk,nk->k", b[:, begin:end], weights) for b in (self.by_time, self.by_length)
        )
        ends = self.slopes[begin : end + 1]
        added: np.ndarray = by_time @ ends[:-1] + by_length @ np.diff(ends, axis=0)
        return added


def _by_times(kernel: DynamicsKernel, steps: Steps, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n, K) derivatives of the states after the steps by the time and the length of each."""
    size = steps.x.shape[0]
    found = np.zeros((2, size, steps.count))
    lasting = steps.lasting
    for mode, some in columns_by_mode(steps.mode[lasting], lasting):
        whole = kernel.variants[mode].step
        for corrected in np.unique(steps.corrected[some]):
            part = some[steps.corrected[some] == corrected]
            plain = branches(whole, kernel.fixed.period) and not corrected
            rates = kernel.over(by_times(whole.plain if plain else whole), part.size)
            given = steps.t[part], steps.h[part], steps.x[:, part], np.tile(p[:, None], part.size)
            found[:, :, part] = rates(*given)
    return found[0], found[1]


@once
def by_times(whole: Step) -> ca.Function:
    """``(t, h, x, p) → ∂S/∂t, ∂S/∂h``."""
    step = whole.moving
    t, h, x, p = (ca.MX.sym(name, step.function.numel_in(i)) for i, name in enumerate("thxp"))
    new = step.function(t, h, x, p)
    still = ca.MX(x.numel(), 2), ca.MX(p.numel(), 2)
    both = step.function.forward(2)(t, h, x, p, new, ca.DM([[1, 0]]), ca.DM([[0, 1]]), *still)
    rates = [ca.densify(both[:, 0]), ca.densify(both[:, 1])]
    return ca.Function("by_times", [t, h, x, p], rates)
