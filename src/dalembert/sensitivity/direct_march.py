"""Direct gradients through time: ``∂x/∂p`` is carried along with the steps that were taken."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.integrators.march import CHUNK, flagged
from dalembert.integrators.steps import run_length
from dalembert.sensitivity.marched_sample import MarchedSample
from dalembert.symbolic.kernel import Kernel


class DirectMarch(MarchedSample):
    """Gradient of one sampled response; all responses of a run look at the same ``changes``."""

    def gradient(self, changes: list[np.ndarray]) -> np.ndarray:
        """(np,) gradient from ``∂x/∂p`` at every step, as ``changes`` gives it."""
        m, steps = self.p.size, self.steps
        k, length = self.branches.index, self.branches.length
        ends = self.branches.ends_of(steps)
        gradient = np.zeros(m)
        for j in np.flatnonzero(self.sample.weights):
            variant = self.kernel.variants[self.modes[j]]
            dx = changes[k[j]]
            if ends[j]:
                dx = changes[k[j] + 1]
            elif length[j] > 0:
                dx = self._tangent_inside(k[j], length[j], dx)
            size = variant.step.state_size
            rates = self.measured(variant).tangent.map(m)(
                self.motion.time[j], self.states[:size, j], self.p, 0, dx[:size], np.eye(m)
            )
            gradient += self.sample.weights[j] * rates.full().ravel()
        return gradient

    def _tangent_inside(self, k: int, length: float, dx: np.ndarray) -> np.ndarray:
        """``∂x/∂p`` after the part of step ``k`` that has this length."""
        m, steps = self.p.size, self.steps
        x, p = (np.tile(column[:, None], m) for column in (steps.x[:, k], self.p))
        tangent = self.kernel.over(self.step_of(steps.mode[k]).tangent, m)
        return tangent(steps.t[k], length, x, p, dx, np.eye(m))[0]

    def changes(self) -> list[np.ndarray]:
        """``∂x_k/∂p`` (n, np) at the beginning of every step and at the end."""
        m, steps = self.p.size, self.steps
        found = [self._tangent_start()]
        begin = 0
        while begin < steps.count:
            count = run_length(steps.mode, begin, CHUNK)
            part = slice(begin, begin + count)
            (out,) = self._forward(count, int(steps.mode[begin]))(
                found[-1],
                steps.t[part],
                steps.h[part],
                steps.corrected[part],
                steps.x[:, part],
                self.p,
            )
            found += [out[:, j * m : (j + 1) * m] for j in range(count)]
            begin += count
        return found

    def _tangent_start(self) -> np.ndarray:
        m, p, t = self.p.size, self.p, float(self.steps.t[0])
        y, v = self.assembled()
        n, unit = y.size, np.eye(m)
        dy, dv = self.model.initial_state.tangent.map(m)(t, y, p, 0, np.zeros((n, m)), unit)
        dx = self.kernel.start.tangent.map(m)(t, y, v, p, 0, dy, dv, unit).full()
        first = self.first_step
        if first.begin is None:
            return dx
        x0 = self.steps.x[: first.state_size, 0]
        memory = first.begin(t, x0, p)
        more = first.begin.forward(m)(t, x0, p, memory, np.zeros((1, m)), dx, unit)
        return np.vstack([dx, more.full()])

    def _forward(self, count: int, mode: int) -> Kernel:
        """Tangents of ``count`` steps for all parameters in one call."""
        step = self.kernel.backend.repeated(self._forward_step(mode), count)

        def make() -> Kernel:
            n, m = self.size, self.p.size
            dx, p = ca.MX.sym("dx", n, m), ca.MX.sym("p", m)
            ts, hs, fs = (ca.MX.sym(s, 1, count) for s in ("t", "h", "flag"))
            xs = ca.MX.sym("xs", n, count)
            out = step.mapaccum(count)(dx, ts, hs, fs, xs, ca.repmat(p, 1, count))
            return Kernel(ca.Function("forward", [dx, ts, hs, fs, xs, p], [out]))

        return self.model.compiled(("forward", step, count), make)

    def _forward_step(self, mode: int) -> ca.Function:
        """``(dx, t, h, flag, x, p) → dx`` of one step, for all parameters."""

        def make() -> ca.Function:
            n, m = self.size, self.p.size
            dx, p = ca.MX.sym("dx", n, m), ca.MX.sym("p", m)
            t, h, flag = (ca.MX.sym(s) for s in ("t", "h", "flag"))
            x, step = ca.MX.sym("x", n), self.step_of(mode)
            call, _ = flagged(step, self.kernel.fixed.period, lambda step: step.tangent)
            unit = ca.DM.eye(m)
            one = [call(flag, t, h, x, p, dx[:, i], unit[:, i]) for i in range(m)]
            following = ca.densify(ca.horzcat(*one)) if one else ca.MX(n, 0)
            return ca.Function("forward_step", [dx, t, h, flag, x, p], [following])

        return self.model.compiled(("forward_step", self.kernel, mode), make)
