"""Instants that move with the parameters: ends of fixed steps, impacts and switches.

The ends of fixed steps may be formulas of parameters, such as ``T/50``. A step
``x_{k+1} = S(t_k, h_k, x_k, p)`` then also depends on the parameters by its time and length:

    dx_{k+1} = (∂S/∂x) dx_k + (∂S/∂p) dp + (∂S/∂t) dt_k + (∂S/∂h) (dt_{k+1} − dt_k).

Marches propagate the sum of all terms. At outputs they return derivatives at fixed times, without
the rate of the numerical motion times ``dt_k``; ``moving_times`` adds the motion of outputs.

At the instant ``t*`` of an impact or a switch a measure may jump from ``m⁻`` to ``m⁺``, and outputs
at the ends of all steps include it. So responses change, in addition to their change at fixed
times, by

    dR = Σ (m⁻ − m⁺) dt*          of an integral,
    dR = Σ (w_k ṁ_k + ∂R/∂t_k) dt*  of samples at the instant,

with ``dt* = −dg/ġ`` of the guard ``g`` that reaches zero, a function of the state before.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.analysis.contact.change import ContactChange
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.step_outputs import columns_by_mode
from dalembert.analysis.dynamics.transition import Transition
from dalembert.analysis.dynamics.variant import Variant
from dalembert.analysis.timeline import run_times, uniform_grid
from dalembert.analysis.times import follow_parameters, slopes
from dalembert.integrators.marching.steps import Steps
from dalembert.results.result import Result
from dalembert.results.status import Outcome
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.evaluation.kernel import Kernel


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
    start, end, step, _ = run_times(analysis)
    along = [slopes(t, motion.model, motion.parameters) for t in ends]
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
    for mode, same_mode in columns_by_mode(steps.mode[lasting], lasting):
        marched = kernel.fixed.marched(mode)
        for corrected in np.unique(steps.corrected[same_mode]):
            part = same_mode[steps.corrected[same_mode] == corrected]
            plain = marched.branches and not corrected
            step = marched.step.plain if plain else marched.step
            rates = kernel.over(step.by_times, part.size)
            point = steps.t[part], steps.h[part], steps.x[:, part], np.tile(p[:, None], part.size)
            by_time_and_length[:, :, part] = rates(*point)
    return by_time_and_length[0], by_time_and_length[1]


@dataclass(frozen=True)
class MovingInstant:
    """Contribution of one instant to a response, as weights of the state before it and of p.

    Attributes
    ----------
    number : number of the state
    x, p : (n,) and (np,) weights
    """

    number: int
    x: np.ndarray
    p: np.ndarray


def moving_instants(sample: Sample) -> list[MovingInstant]:
    """Moving instants with nonzero weight in a sampled response of a dynamic run."""
    record, p = sample.motion.record, sample.motion.parameters
    kernel: DynamicsKernel = record.kernel
    steps: Steps = record.steps
    instants: list[MovingInstant] = []
    weight_of: Callable[[int, int], float] | None = None
    for first, last, guarded in _instants(kernel, steps):
        weight_of = _weight_function(sample) if weight_of is None else weight_of
        weight = weight_of(first, last)
        if weight == 0.0:
            continue
        slopes = Kernel(kernel.variants[steps.mode[guarded]].instant.adjoint)
        size = kernel.variants[0].step.state_size
        _, by_x, by_p = slopes(steps.t[guarded], steps.x[:size, guarded], p, 1.0)
        x = np.zeros(steps.x.shape[0])
        x[:size] = weight * by_x.ravel()
        instants.append(MovingInstant(guarded, x, weight * by_p.ravel()))
    return instants


def _instants(kernel: DynamicsKernel, steps: Steps) -> list[tuple[int, int, int]]:
    """First and last transition of every instant, and the transition whose guard vanishes."""
    changes = np.flatnonzero(steps.h == 0)
    cuts = np.flatnonzero(np.diff(changes) > 1) + 1
    groups = np.split(changes, cuts) if changes.size else []
    instants = []
    for group in groups:
        guarded = [k for k in group if _moves(kernel.variants[steps.mode[k]])]
        if guarded and group[0] > 0 and group[-1] + 1 < steps.count:
            instants.append((int(group[0]), int(group[-1]), int(guarded[0])))
    return instants


def _moves(change: Variant) -> bool:
    if isinstance(change, ContactChange):
        return change.guard is not None
    return isinstance(change, Transition) and change.moving


def _weight_function(sample: Sample) -> Callable[[int, int], float]:
    """``(first, last) → dR/dt*`` of the instant of these transitions."""
    motion, response = sample.motion, sample.response
    times, values = motion.time, motion.values(sample.measure)
    quadrature = motion.record.quadrature
    if quadrature is not None:

        def jump(first: int, last: int) -> float:
            before, after = quadrature.beside(first, last)
            return response.jump_weight(times, values, values[before], values[after])

        return jump
    if motion.analysis.outputs is not None or response.has_fixed_times(motion):
        return lambda first, last: 0.0
    places = motion.record.places
    active = (sample.weights != 0) | (sample.time_weights != 0)
    if places.modes is not None:
        active &= places.modes < 0  # other outputs depend on the instant explicitly
    begins = np.flatnonzero((places.length == 0) & active)

    def shift(first: int, last: int) -> float:
        here = begins[(places.index[begins] >= first) & (places.index[begins] <= last + 1)]
        return float(
            sum(
                sample.weights[i] * _rate(sample, int(places.index[i])) + sample.time_weights[i]
                for i in here
            )
        )

    return shift


def _rate(sample: Sample, k: int) -> float:
    """``ṁ`` at the start of step ``k``; for a transition, along the motion before it."""
    record, p = sample.motion.record, sample.motion.parameters
    variant, t = record.kernel.variants[record.steps.mode[k]], record.steps.t[k]
    x = record.steps.x[: variant.step.state_size, k]
    rate = Kernel(variant.rate.function)(t, x, p)[0].ravel()
    tangent = Kernel(variant.measured(sample.measure).tangent)
    return float(tangent(t, x, p, 1.0, rate, np.zeros(p.size))[0].item())
