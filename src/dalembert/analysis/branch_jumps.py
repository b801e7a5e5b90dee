"""Whether a run has gone over to another assembly of its mechanism.

A correction of positions finds the nearest assembly. Where a step is long, that may be another one
than the motion was in: then positions jump farther than the speeds on either side lead.
"""

from __future__ import annotations

import numpy as np

from dalembert.analysis.dynamics_kernel import DynamicsKernel
from dalembert.integrators.checkpoints import Checkpoints
from dalembert.integrators.steps import Steps

FARTHER = 2.0
"""Way, over that of the faster end of the step, from which on it is a jump."""
LEAST = 1e-2
"""Of a jump, in natural sizes."""


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
    def doubts(self) -> list[str]:
        """Where the first jump is, and between which positions; mostly nothing."""
        x, k = self.steps.x, self.steps.lasting
        e = self.kernel.equations
        if isinstance(x, Checkpoints) or not k.size or not e.speed_count:
            return []
        n, sizes = e.coordinate_count, e.scales.displacements[:, None]
        with np.errstate(all="ignore"):
            y, v = x[:n], np.abs(x[n : n + e.speed_count])
            way = np.abs(e.manifold.lead(y[:, k], y[:, k + 1])) / sizes
            led = np.maximum(v[:, k], v[:, k + 1]) * self.steps.h[k] / sizes
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
