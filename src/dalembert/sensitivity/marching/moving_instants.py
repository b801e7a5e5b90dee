"""Instants of impacts and switches, which move with the parameters while ends of steps are fixed.

At such an instant ``t*`` a measure may jump from ``m⁻`` to ``m⁺``, and outputs at the ends of all
steps include it. So responses change, in addition to their change at fixed times, by

    dR = Σ (m⁻ − m⁺) dt*          of an integral,
    dR = Σ (w_k ṁ_k + ∂R/∂t_k) dt*  of samples at the instant,

with ``dt* = −dg/ġ`` of the guard ``g`` that reaches zero, a function of the state before.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.analysis.contact.change import ContactChange
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.transition import Transition
from dalembert.analysis.dynamics.variant import Variant
from dalembert.integrators.marching.steps import Steps
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.once import once


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
        slopes = _slopes(kernel.variants[steps.mode[guarded]])
        size = kernel.variants[0].step.state_size
        by_x, by_p = slopes(steps.t[guarded], steps.x[:size, guarded], p)
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
    if motion.analysis.outputs is not None or response.stays(motion):
        return lambda first, last: 0.0
    branches = motion.record.branches
    active = (sample.weights != 0) | (sample.time_weights != 0)
    if branches.modes is not None:
        active &= branches.modes < 0  # other outputs depend on the instant explicitly
    begins = np.flatnonzero((branches.length == 0) & active)

    def shift(first: int, last: int) -> float:
        here = begins[(branches.index[begins] >= first) & (branches.index[begins] <= last + 1)]
        return float(
            sum(
                sample.weights[i] * _rate(sample, int(branches.index[i])) + sample.time_weights[i]
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


@once
def _slopes(change: Transition | ContactChange) -> Kernel:
    """``(t, x, p) → ∂t*/∂x, ∂t*/∂p``."""
    delay = change.instant
    t, x, p = (ca.MX.sym(delay.name_in(i), delay.size_in(i)) for i in range(3))
    _, by_x, by_p = delay.reverse(1)(t, x, p, delay(t, x, p), 1.0)
    return Kernel(ca.Function("instant_slopes", [t, x, p], [ca.densify(by_x), ca.densify(by_p)]))
