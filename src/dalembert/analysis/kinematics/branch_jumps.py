"""Whether a run has gone over to another assembly of its mechanism.

A correction of positions finds the nearest assembly. Where a step is long, that may be another one
than the motion was in: then positions jump farther than the speeds on either side lead.
"""

from __future__ import annotations

import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.integrators.marching.checkpoints import Checkpoints
from dalembert.integrators.marching.steps import Steps

FARTHER = 2.0
"""Way, over that of the faster end of the step, from which on it is a jump."""
LEAST = 1e-2
"""Of a jump, in natural sizes."""
AT_ONCE = 2000
"""Steps looked at in one go."""


class BranchJumps:
    """The steps of a run whose states are all kept, looked at for jumps.

    Parameters
    ----------
    kernel : DynamicsKernel of the run
    steps : Steps taken
    """

    def __init__(self, kernel: DynamicsKernel, steps: Steps):
        self.kernel, self.steps = kernel, steps

    @property
    def warnings(self) -> list[str]:
        """Where the first jump is, and between which positions; mostly nothing."""
        x, lasting = self.steps.x, self.steps.lasting
        if isinstance(x, Checkpoints) or not self.kernel.equations.speed_count:
            return []
        parts = (lasting[i : i + AT_ONCE] for i in range(0, lasting.size, AT_ONCE))
        return next((found for part in parts if (found := self._first(x, part))), [])

    def _first(self, x: np.ndarray, k: np.ndarray) -> list[str]:
        """The first jump in some of the steps."""
        e = self.kernel.equations
        n, sizes = e.coordinate_count, e.scales.displacements[:, None]
        with np.errstate(all="ignore"):
            before, after = x[:, k], x[:, k + 1]
            speeds = slice(n, n + e.speed_count)
            way = np.abs(e.manifold.lead(before[:n], after[:n])) / sizes
            fastest = np.maximum(np.abs(before[speeds]), np.abs(after[speeds]))
            led = fastest * self.steps.h[k] / sizes
            jumps = way > FARTHER * led.max(axis=0) + LEAST
        found = np.flatnonzero(jumps.any(axis=0))
        if not found.size:
            return []
        row = int(np.argmax(way[:, found[0]]))
        name = self.kernel.view.speed_names[row]
        moved = way[row, found[0]] * float(sizes[row, 0])
        return [
            f"at t = {self.steps.t[k[found[0]]]:.6g} s {name} jumps by {moved:.3g}, farther than "
            "the speeds lead: the run has gone over to another assembly of the mechanism; use a "
            "shorter step"
        ]
