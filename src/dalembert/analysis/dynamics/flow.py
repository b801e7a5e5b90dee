"""The numerical motion inside its steps, and rates of measures along it.

Inside step ``k`` the motion is a partial step from its beginning, ``x(t_k + s) = step(t_k, s, x_k,
p)``. The rate of a measure along the discrete motion is

    ṁ = ∂m/∂t + (∂m/∂x) ∂step/∂s,

where accelerations and multipliers in ``m`` are functions of the state.
"""

from __future__ import annotations

import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.variant import Variant
from dalembert.integrators.marching.checkpoints import ended_states
from dalembert.integrators.marching.steps import Steps
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.formulas.expression import Expression


class Flow:
    """States and measures inside the steps of a run.

    Parameters
    ----------
    kernel : DynamicsKernel of the run
    steps : Steps taken
    p : (np,) parameters
    """

    def __init__(self, kernel: DynamicsKernel, steps: Steps, p: np.ndarray):
        self.kernel, self.steps, self.p = kernel, steps, p

    def state(self, k: int, length: float) -> np.ndarray:
        """(n,) state ``length`` seconds after the beginning of step ``k``."""
        x = self.steps.x[:, k]
        if length == 0.0:
            return x
        step = Kernel(self._variant(k).step.function)
        return step(self.steps.t[k], length, x, self.p)[0].ravel()

    def bodies(self, k: int, length: float) -> tuple[np.ndarray, np.ndarray]:
        """(n,) coordinates and (n,) speeds of the bodies at that instant."""
        variant = self._variant(k)
        x = self.state(k, length)[: variant.step.state_size]
        y, v, *_ = Kernel(variant.bodies)(self.steps.t[k] + length, x, self.p)
        return y.ravel(), v.ravel()

    def shortened(self, k: int, length: float) -> Steps:
        """The steps up to the ``k``-th, whose length becomes ``length``."""
        steps = self.steps.cut(k + 1)
        steps.h, steps.corrected = steps.h.copy(), steps.corrected.copy()
        steps.h[k], steps.corrected[k] = length, True
        steps.x = ended_states(steps.x, k + 1, self.state(k, length))
        return steps

    def value(self, measure: Expression, k: int, length: float) -> float:
        """The measure at that instant."""
        function = Kernel(self._variant(k).measured(measure).function)
        x = self.state(k, length)[: self._variant(k).step.state_size]
        return float(function(self.steps.t[k] + length, x, self.p)[0].item())

    def rate(self, measure: Expression, k: int, length: float) -> float:
        """``ṁ`` at that instant [unit of the measure per second]."""
        size = self._variant(k).step.state_size
        x = self.state(k, length)[:size]
        by_times = Kernel(self._variant(k).step.by_times)
        x_rate = by_times(self.steps.t[k], length, self.steps.x[:, k], self.p)[1]
        tangent = Kernel(self._variant(k).measured(measure).tangent)
        still = np.zeros(self.p.size)
        t = self.steps.t[k] + length
        return float(tangent(t, x, self.p, 1.0, x_rate.ravel()[:size], still)[0].item())

    def _variant(self, k: int) -> Variant:
        return self.kernel.variants[self.steps.mode[k] if self.steps.count else self.kernel.latest]
