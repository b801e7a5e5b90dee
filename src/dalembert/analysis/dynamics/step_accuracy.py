"""Whether the steps of a run were short enough, told after it by taking a few of them in parts.

A step taken in two halves ends elsewhere by nearly its own error. Errors of that size in all steps
add up to an estimate of how far off the run is; it neither knows how they cancel nor how the motion
lets them grow. Violations that are fed back decay faster than such steps: there it would mislead.
"""

from __future__ import annotations

import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.step_outputs import alike
from dalembert.errors import SolverFailure
from dalembert.integrators.marching.checkpoints import Checkpoints
from dalembert.integrators.marching.steps import Steps

ALLOWED = 1e-2
"""Errors of all steps together, relative to the way and the speeds, that nobody is warned of."""
EVERY, MOST = 25, 16
"""One in so many steps is looked at, and so many at most."""
HALVINGS = 12
"""Of a step, in search of one that is short enough."""
SMALL = 1e-2
"""Way or speed, relative to the largest, by which a coordinate is measured at least."""

REST = 1e-8
"""Way or speed, by natural sizes, that what stands still is measured by: rounding moves it, too."""


class StepAccuracy:
    """A few steps of a run of fixed steps, looked at again.

    Parameters
    ----------
    kernel : DynamicsKernel of the run
    steps : Steps taken
    p : (np,) parameters
    """

    def __init__(self, kernel: DynamicsKernel, steps: Steps, p: np.ndarray):
        self.kernel, self.steps, self.p = kernel, steps, p
        e = kernel.equations
        self.positions, self.size = e.coordinate_count, e.coordinate_count + e.speed_count
        count = min(MOST, -(-steps.lasting.size // EVERY))
        kept = steps.x.number[:-1] if isinstance(steps.x, Checkpoints) else np.arange(steps.count)
        kept = kept[steps.h[kept] > 0]  # changes take no time
        count = min(count, kept.size)
        middle = (np.arange(count) + 0.5) / count
        self.chosen = np.unique(kept[(middle * kept.size).astype(int)])
        self.begins = steps.x[:, self.chosen]

    @property
    def doubts(self) -> list[str]:
        """What to say where the steps are too long for the motion; else nothing."""
        if not self.chosen.size:
            return []
        try:
            ends = [self._ends(1), self._ends(2)]
            way = self._way(ends[0])
            share = self._share(ends[0] - ends[1], way)
            if not share > ALLOWED:
                return []
            halvings, most = 0, self._most_halvings()
            while self._share(ends[-2] - ends[-1], way) > ALLOWED and halvings < most:
                halvings += 1
                ends.append(self._ends(2 ** (halvings + 1)))
            enough = self._share(ends[-2] - ends[-1], way) <= ALLOWED
        except SolverFailure:
            return []
        of_motion = f"{share:.0%} of it" if share < 10 else f"{share:.2g} times as much"
        h = float(np.median(self.steps.h[self.chosen]))
        text = (
            f"steps of {h:.3g} s are long for this motion: their errors add up to about "
            f"{of_motion}; steps {'of' if enough else 'below'} {h / 2**halvings:.2g} s or an "
            "integrator with error control do better"
        )
        return [text]

    def _most_halvings(self) -> int:
        """The search takes no more steps than the run did."""
        affordable = np.log2(max(1.0, self.steps.count / (2 * self.chosen.size)))
        return min(HALVINGS, int(affordable))

    def _ends(self, parts: int) -> np.ndarray:
        """Positions and speeds after the chosen steps, each taken in so many parts."""
        x, t, h = self.begins.copy(), self.steps.t[self.chosen], self.steps.h[self.chosen] / parts
        for i in range(parts):
            for mode, some in alike(self.steps.mode[self.chosen], np.arange(self.chosen.size)):
                p = np.tile(self.p[:, None], some.size)
                step = self.kernel.over(self.kernel.variants[mode].step.function, some.size)
                (x[:, some],) = step(t[some] + i * h[some], h[some], x[:, some], p)
        return x[: self.size]

    def _way(self, after: np.ndarray) -> np.ndarray:
        """(n,) how far the run goes in each coordinate, how fast in each speed."""
        first, last = (self.steps.x[: self.size, k] for k in (0, -1))
        seen = np.column_stack([first, last, self.begins[: self.size], after])
        way = np.ptp(seen[: self.positions], axis=1)
        speed = np.abs(seen[self.positions :]).max(axis=1)
        found = np.concatenate([np.maximum(w, SMALL * w.max(initial=0.0)) for w in (way, speed)])
        scales = self.kernel.equations.scales
        natural = REST * np.concatenate([scales.coordinates, scales.speeds])
        return np.maximum(found, np.where(found > 0, natural, 0.0))

    def _share(self, error: np.ndarray, way: np.ndarray) -> float:
        """Errors of all steps, relative to the way, where that is most."""
        moving = way > 0
        if not np.all(np.isfinite(error)) or not moving.any():
            return 0.0
        added = self.steps.lasting.size * np.abs(error[moving]).mean(axis=1)
        return float(np.max(added / way[moving]))
