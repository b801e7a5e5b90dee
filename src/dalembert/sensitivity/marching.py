"""Gradients through time: exact derivatives of the steps that were taken.

Direct differentiation carries ``∂x/∂p`` along with the steps. The adjoint carries the weight of
the state backwards, ``x̄_k = (∂x_{k+1}/∂x_k)ᵀ x̄_{k+1} + (what the response sees at k)``, and
collects the weight of the parameters on its way to the initial state.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics_kernel import DynamicsKernel
from dalembert.integrators.march import Steps
from dalembert.integrators.step import ExplicitStep
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.implicit import ImplicitFunction
from dalembert.symbolic.kernel import Kernel

CHUNK = 500


class MarchGradient:
    """Gradient of one sampled response of a dynamic run."""

    def __init__(self, sample: Sample):
        self.sample, self.motion = sample, sample.motion
        record = self.motion.record
        self.kernel: DynamicsKernel = record.kernel
        self.steps: Steps = record.steps
        self.branches = record.branches
        self.model = self.motion.model
        self.p = self.motion.parameters
        self.step: ExplicitStep = self.kernel.step
        self.states = self.kernel.branch_states(self.steps, self.branches, self.p)
        self.measured = self.model.compiled(
            ("measured", self.kernel, sample.measure),
            lambda: _measured(self.kernel, self.model.measurable(sample.measure.sx)),
        )

    # adjoint -------------------------------------------------------------------------
    def adjoint(self) -> np.ndarray:
        """(np,) gradient by one backward march."""
        count, p = self.motion.time.size, self.p
        tiled = np.tile(p[:, None], count)
        weights = self.sample.weights.reshape(1, -1)
        _, x_bar, p_bar = Kernel(self.measured.adjoint.map(count))(
            self.motion.time, self.states, tiled, weights
        )
        gradient = p_bar.sum(axis=1)
        injected, more = self._inject(x_bar)
        first, marched = self._march_back(injected)
        gradient += more + marched
        return gradient + self._through_start(first)

    def _inject(self, x_bar: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights of the sampled states moved to the step ends they branch from."""
        steps, k, length = self.steps, self.branches.index, self.branches.length
        injected = np.zeros((self.step.size, steps.count + 1))
        if not steps.count:
            return x_bar.sum(axis=1, keepdims=True), np.zeros(self.p.size)
        begins = length == 0
        ends = ~begins & np.isclose(length, steps.h[k], rtol=1e-12, atol=0)
        np.add.at(injected.T, k[begins], x_bar[:, begins].T)
        np.add.at(injected.T, k[ends] + 1, x_bar[:, ends].T)
        inside = np.flatnonzero(~begins & ~ends)
        if not inside.size:
            return injected, np.zeros(self.p.size)
        mapped = self.step.adjoint.map(inside.size)
        back, p_bar = mapped(
            steps.t[k[inside]],
            length[inside],
            steps.x[:, k[inside]],
            np.tile(self.p[:, None], inside.size),
            x_bar[:, inside],
        )
        np.add.at(injected.T, k[inside], back.full().T)
        return injected, p_bar.full().sum(axis=1)

    def _march_back(self, injected: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        n, steps = self.step.size, self.steps
        carried = np.concatenate([injected[:, -1], np.zeros(self.p.size)])
        for stop in range(steps.count, 0, -CHUNK):
            part = np.arange(stop - 1, max(stop - CHUNK, 0) - 1, -1)
            (carried,) = self._backward(part.size)(
                carried,
                steps.t[part],
                steps.h[part],
                steps.corrected[part],
                steps.x[:, part],
                injected[:, part],
                self.p,
            )
            carried = carried.ravel()
        return carried[:n], carried[n:]

    def _backward(self, count: int) -> Kernel:
        """``count`` backward steps in one call."""

        def make() -> Kernel:
            n, m = self.step.size, self.p.size
            single = self._backward_step().mapaccum(count)
            carried, p = ca.MX.sym("c", n + m), ca.MX.sym("p", m)
            t, h, flag = (ca.MX.sym(s, 1, count) for s in ("t", "h", "flag"))
            x, inject = ca.MX.sym("x", n, count), ca.MX.sym("i", n, count)
            out = single(carried, t, h, flag, x, inject, ca.repmat(p, 1, count))
            return Kernel(
                ca.Function("backward", [carried, t, h, flag, x, inject, p], [out[:, -1]])
            )

        return self.model.compiled(("backward", self.kernel, count), make)

    def _backward_step(self) -> ca.Function:
        def make() -> ca.Function:
            n, m = self.step.size, self.p.size
            both = self.kernel.fixed.period > 1 and self.step.correction is not None
            kind: Any = ca.MX if both else ca.SX
            carried, x, inject = kind.sym("c", n + m), kind.sym("x", n), kind.sym("i", n)
            t, h, flag, p = kind.sym("t"), kind.sym("h"), kind.sym("flag"), kind.sym("p", m)
            adjoint = self.step.adjoint
            if both:
                plain = ExplicitStep(self.step.tableau, self.step.rhs, None).adjoint
                branch = ca.Function.if_else("branch", adjoint, plain)
                x_bar, p_bar = branch(flag, t, h, x, p, carried[:n])
            else:
                x_bar, p_bar = adjoint(t, h, x, p, carried[:n])
            following = ca.vertcat(x_bar + inject, carried[n:] + p_bar)
            inputs = [carried, t, h, flag, x, inject, p]
            return ca.Function("backward_step", inputs, [following])

        return self.model.compiled(("backward_step", self.kernel), make)

    def _through_start(self, x_bar: np.ndarray) -> np.ndarray:
        """Weight of the parameters through the assembled initial state."""
        e, x0 = self.model.equations, self.steps.x[:, 0]
        n = e.coordinate_count
        adjoint = self.model.initial_state.adjoint
        start = float(self.steps.t[0])
        parts = adjoint(start, x0[:n], self.p, x_bar[:n], x_bar[n : n + e.speed_count])
        return parts[2].full().ravel()

    # direct --------------------------------------------------------------------------
    def direct(self, changes: list[np.ndarray]) -> np.ndarray:
        """(np,) gradient from ``∂x/∂p`` at every step, as ``march_tangents`` gives it."""
        m = self.p.size
        k, length = self.branches.index, self.branches.length
        weights = self.sample.weights
        gradient = np.zeros(m)
        measured, stepped = self.measured.tangent, self.step.tangent
        for j in np.flatnonzero(weights):
            dx = changes[k[j]]
            if length[j] > 0 and np.isclose(length[j], self.steps.h[k[j]], rtol=1e-12, atol=0):
                dx = changes[k[j] + 1]
            elif length[j] > 0:
                dx = stepped.map(m)(
                    self.steps.t[k[j]], length[j], self.steps.x[:, k[j]], self.p, dx, np.eye(m)
                ).full()
            rates = measured.map(m)(
                self.motion.time[j], self.states[:, j], self.p, 0, dx, np.eye(m)
            )
            gradient += weights[j] * rates.full().ravel()
        return gradient

    def march_tangents(self) -> list[np.ndarray]:
        """``∂x_k/∂p`` (n, np) at the beginning of every step and at the end."""
        m, steps, e = self.p.size, self.steps, self.model.equations
        n = e.coordinate_count
        start = self.model.initial_state.tangent.map(m)(
            float(steps.t[0]), steps.x[:n, 0], self.p, 0, np.zeros((n, m)), np.eye(m)
        )
        dx = np.vstack([start[0].full(), start[1].full(), np.zeros((2, m))])
        found = [dx]
        for begin in range(0, steps.count, CHUNK):
            part = slice(begin, min(begin + CHUNK, steps.count))
            count = part.stop - begin
            out = self._forward(count)(
                found[-1],
                steps.t[part],
                steps.h[part],
                steps.corrected[part],
                steps.x[:, part],
                self.p,
            ).full()
            found += [out[:, j * m : (j + 1) * m] for j in range(count)]
        return found

    def _forward(self, count: int) -> ca.Function:
        """Tangents of ``count`` steps for all parameters in one call."""

        def make() -> ca.Function:
            n, m = self.step.size, self.p.size
            dx, p = ca.MX.sym("dx", n, m), ca.MX.sym("p", m)
            t, h, flag = (ca.MX.sym(s) for s in ("t", "h", "flag"))
            x = ca.MX.sym("x", n)
            tangent = self.step.tangent
            if self.kernel.fixed.period > 1 and self.step.correction is not None:
                plain = ExplicitStep(self.step.tableau, self.step.rhs, None).tangent
                branch = ca.Function.if_else("branch", tangent, plain)
                one = [branch(flag, t, h, x, p, dx[:, i], ca.DM.eye(m)[:, i]) for i in range(m)]
            else:
                one = [tangent(t, h, x, p, dx[:, i], ca.DM.eye(m)[:, i]) for i in range(m)]
            following = ca.horzcat(*one) if one else ca.MX(n, 0)
            single = ca.Function("forward_step", [dx, t, h, flag, x, p], [following])
            ts, hs, flags = (ca.MX.sym(s, 1, count) for s in ("t", "h", "flag"))
            xs = ca.MX.sym("xs", n, count)
            out = single.mapaccum(count)(dx, ts, hs, flags, xs, ca.repmat(p, 1, count))
            return ca.Function("forward", [dx, ts, hs, flags, xs, p], [out])

        return self.model.compiled(("forward", self.kernel, count), make)


def _measured(kernel: DynamicsKernel, measure: ca.SX) -> ImplicitFunction:
    """``(t, x, p) → measure``, accelerations and multipliers included."""
    e = kernel.model.equations
    return kernel.formulation.acceleration(e, kernel.xi, [measure], "measured")
