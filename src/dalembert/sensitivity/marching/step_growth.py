"""Spurious growth of step tangents at the stability limit.

An explicit step multiplies a mode ``λ`` of ``∂ẋ/∂x`` by ``R(hλ)``. Under error control a stiff run
stays at the limit ``|R| ≈ 1``: its states are accurate, because the controller limits every growth
of an error, but products of ``|R(hλ)| > 1`` amplify tangents. Power iteration with a vector ``w``
along the run gives ``ρ = |λ|`` of the dominant mode and, by the angle between ``w`` and ``J² w``,
the argument of ``λ``. The amplification is bounded by

    a(hρ) = max |R(z)|,   |z| ≤ hρ,  Re z ≤ 0.

If ``Π a(h_k ρ_k)`` is about 1, no decaying mode grows. Otherwise steps must be subdivided: for
parts of length ``h/n`` the bound is 1. ``|R(hλ)|`` itself estimates the growth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.formulations.base import state_sizes
from dalembert.integrators.marching.march import CHUNK
from dalembert.integrators.marching.steps import Steps, run_length
from dalembert.symbolic.once import once

TOLERATED = 10.0
"""Upper limit of a harmless growth, which starts near the tolerance of the run [-]."""
LARGEST = 64.0
"""Largest ``hρ`` in the table of amplifications [-]."""
VANISHING = 1e-8
"""Threshold of the rate of the iterated vector for a restart, per natural time [-]."""


@dataclass(frozen=True)
class Amplification:
    """Growth of modes by a step, ``ln |R(z)|``, and its bound ``ln a(r)`` for decaying modes.

    Parameters
    ----------
    stability : stability function ``R``
    """

    stability: Callable[[np.ndarray], np.ndarray]

    @cached_property
    def _table(self) -> tuple[np.ndarray, np.ndarray]:
        radii = np.concatenate([[0.0], np.geomspace(1e-2, LARGEST, 600)])
        angles = np.linspace(np.pi / 2, np.pi, 65)
        values = np.abs(self.stability(radii[:, None] * np.exp(1j * angles)))
        return radii, np.log(np.maximum(np.maximum.accumulate(values.max(axis=1)), 1.0))

    def at(self, z: np.ndarray) -> np.ndarray:
        """``ln |R(z)|``."""
        return np.log(np.maximum(np.abs(self.stability(z)), 1e-300))

    def bound(self, radii: np.ndarray) -> np.ndarray:
        """``ln a(r)``, zero within the radius of stability."""
        return np.interp(radii, *self._table)

    def radius(self, allowed: float) -> float:
        """Largest ``r`` with ``ln a(r)/r ≤ allowed``, the size of parts with bounded products."""
        radii, logs = self._table
        within = logs[1:] <= allowed * radii[1:]
        return float(radii[1:][within][-1]) if within.any() else float(radii[1])


class StepGrowth:
    """Amplification of decaying modes by the steps of a run under error control.

    Parameters
    ----------
    kernel : DynamicsKernel of the run
    steps : Steps taken
    p : (np,) parameters
    """

    def __init__(self, kernel: DynamicsKernel, steps: Steps, p: np.ndarray):
        self.kernel, self.steps, self.p = kernel, steps, p

    @cached_property
    def _dominant(self) -> tuple[np.ndarray, np.ndarray]:
        """(K,) ``ρ`` and the cosine between ``w`` and ``J² w`` at the start of every step.

        Both are zero for steps that cannot amplify decaying modes.
        """
        steps, begin = self.steps, 0
        dominant, carried = np.zeros((2, steps.count)), np.zeros(0)
        while begin < steps.count:
            mode = int(steps.mode[begin])
            end = begin + run_length(steps.mode, begin, CHUNK)
            if self.kernel.variants[mode].step.stability is not None and steps.h[begin] > 0:
                single = _follow(self.kernel, mode)
                carried = carried if carried.size else np.zeros(single.numel_in(0))
                columns = self.kernel.marched(single, (3,))
                points = steps.t[begin:end], steps.x[:, begin:end]
                (out,) = columns(end - begin, carried, *points, self.p)
                carried, dominant[:, begin:end] = out[:, -1], out[-2:]
            begin = end
        return dominant[0], dominant[1]

    @cached_property
    def radii(self) -> np.ndarray:
        """(K,) ``h ρ``; for oscillating modes ``ρ`` is a mean over two steps."""
        rates = self._dominant[0]
        means = np.sqrt(rates * np.append(rates[:1], rates[:-1]))
        return self.steps.h * np.minimum(means, np.append(means[1:], means[-1:]))

    @cached_property
    def bounds(self) -> np.ndarray:
        """(K,) ``ln a``."""
        return self._by_mode(lambda amplification, here: amplification.bound(self.radii[here]))

    @property
    def harmless(self) -> bool:
        """True if no decaying mode can grow beyond the tolerated factor."""
        return not self.bounds.sum() > np.log(TOLERATED)

    @cached_property
    def logarithms(self) -> np.ndarray:
        """(K,) ``ln`` of the estimated growth of the dominant mode since its minimum."""
        angle = np.pi - np.arccos(np.clip(self._dominant[1], -1, 1)) / 2
        z = self.radii * np.exp(1j * angle)
        growth = self._by_mode(lambda amplification, here: amplification.at(z[here]))
        total = np.cumsum(growth)
        return total - np.minimum.accumulate(np.minimum(total, 0.0))

    @property
    def factor(self) -> float:
        """Largest estimated growth, at most 1e300."""
        return float(np.exp(min(self.logarithms.max(initial=0.0), 690.0)))

    @property
    def begin(self) -> float:
        """First time at which the growth, or its bound, exceeds the tolerated factor [s]."""
        above = self.logarithms > np.log(TOLERATED)
        if not above.any():
            above = np.cumsum(self.bounds) > np.log(TOLERATED)
        return float(self.steps.t[np.argmax(above)])

    @property
    def parts(self) -> np.ndarray:
        """(K,) numbers of equal parts of the steps for bounded products."""
        allowed = np.log(TOLERATED) / max(float(self.radii.sum()), 1e-300)
        numbers = self._by_mode(
            lambda amplification, here: np.ceil(self.radii[here] / amplification.radius(allowed))
        )
        return np.where(self.bounds > 0, np.maximum(numbers, 1), 1).astype(int)

    def _by_mode(self, of: Callable[[Amplification, np.ndarray], np.ndarray]) -> np.ndarray:
        """(K,) values for the steps that can amplify decaying modes, zero for all others."""
        values = np.zeros(self.steps.count)
        for mode in np.unique(self.steps.mode):
            stability, here = self.kernel.variants[mode].step.stability, self.steps.mode == mode
            if stability is not None:
                values[here] = of(Amplification(stability), here)
        return values


@once
def _follow(kernel: DynamicsKernel, mode: int) -> ca.Function:
    """``([w; w₋; …], t, x, p) → [w⁺; w; ρ; c]`` with ``w⁺ = J w/ρ``, ``ρ = |J w|``, ``c = w₋·w⁺``.

    In natural sizes, for positions and speeds only: rates do not depend on the work states.
    """
    variant = kernel.variants[mode]
    e, rate = variant.equations, variant.step.rate
    assert rate is not None
    n, count = e.coordinate_count + e.speed_count, variant.step.state_size
    sizes, first = state_sizes(e)[:n], np.ones(n) / np.sqrt(n)
    carried, t = ca.MX.sym("w", 2 * n + 2), ca.MX.sym("t")
    x, p = ca.MX.sym("x", variant.step.size), ca.MX.sym("p", variant.step.parameter_count)
    w = ca.if_else(ca.sumsqr(carried[:n]) == 0, first, carried[:n])
    dx = ca.vertcat(sizes * w, ca.MX(count - n, 1))
    change = rate.tangent(t, x[:count], p, 0, dx, ca.MX(p.numel(), 1))[:n] / sizes
    size = ca.norm_2(change)
    vanishing = size * e.scales.time <= VANISHING
    new = ca.if_else(vanishing, first, change / ca.if_else(vanishing, 1, size))
    out = ca.vertcat(new, w, size, ca.dot(carried[n : 2 * n], new))
    return ca.Function("follow", [carried, t, x, p], [ca.densify(out)])
