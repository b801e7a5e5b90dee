"""Outputs of runs with error control that show the motion between the ends of its steps.

Under error control steps are long where a method of high order may take long ones; straight lines
between their ends are not the motion. Each step is divided into equal parts until straight lines
between neighbouring outputs follow every coordinate, speed, acceleration and multiplier.

An output inside a step is a partial step from its beginning. So it is as accurate as the steps for
every integrator, it satisfies the constraints, and gradients differentiate it like any other
output. An interpolating polynomial has an order of its own (cubic Hermite 4, the steps of
``DormandPrince853`` 8) and leaves the constraints.
"""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from dalembert.analysis.contact.change import ContactChange
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.step_quadrature import INSIDE
from dalembert.analysis.dynamics.transition import Transition
from dalembert.analysis.kinematics.branches import Branches
from dalembert.integrators.marching.steps import Steps
from dalembert.results.recording import Trajectory

LEAST = 200
"""Intervals between outputs over the span of a run."""
IN_STRETCH = 4
"""Intervals between two changes of forces or contacts."""
FLAT = 2e-3
"""Distance of a quantity from the straight line between outputs, relative to its range."""
SMALL = 1e-6
"""Range of a quantity, relative to the largest one of its kind, that is treated as constant."""
MORE, PER_STEP = 1000, 4
"""Upper limit of the outputs that are added: a number, or so many per step."""
MOST = 100_000
"""Upper limit of the outputs that are added to any run."""
ROUNDS = 6
"""Times that a step is halved."""


class DenseOutputs:
    """Outputs at the ends of steps and inside them.

    Parameters
    ----------
    kernel, steps : of the run
    times, branches : outputs at the ends of the steps, both sides of every jump among them
    p : (np,) parameters

    Attributes
    ----------
    trajectory : at all outputs
    branches : of all outputs
    """

    def __init__(
        self,
        kernel: DynamicsKernel,
        steps: Steps,
        times: np.ndarray,
        branches: Branches,
        p: np.ndarray,
    ):
        self.kernel, self.steps, self.p = kernel, steps, p
        self.branches = branches
        self.trajectory = kernel.trajectory(times, steps, branches, p)
        self.span = (float(times[0]), float(times[-1]))
        self._add_ends()
        self.left = min(MOST, max(MORE, PER_STEP * steps.count))
        self.parts = np.ones(steps.count, dtype=int)
        if steps.count and np.all(np.isfinite(self.trajectory.y)):
            self._divide()

    def _add_ends(self) -> None:
        """Outputs just before switches, where forces jump and formulas cannot tell the sides."""
        steps = self.steps
        crossings = self.kernel.crossings(steps)
        found = [k - 1 for k, change in crossings if isinstance(change, Transition)]
        index = np.array([k for k in found if k >= 0 and steps.h[k] > 0], dtype=int)
        times = steps.t[index] + (1 - INSIDE) * steps.h[index]
        inside = (times > self.span[0]) & (times < self.span[1])
        if inside.any():
            index, times = index[inside], times[inside]
            self._add(times, Branches(index, times - steps.t[index]))

    def _divide(self) -> None:
        parts = self._at_first()
        for _ in range(ROUNDS):
            if not self._refine(parts):
                return
            parts = np.where(self._bent(), 2, 1) * self.parts

    def _at_first(self) -> np.ndarray:
        """Parts of each step by its length, and by the number of steps between two changes."""
        h = self.steps.h
        apart = (self.span[1] - self.span[0]) / LEAST
        parts = np.ceil(h / apart * (1 - 1e-9)) if apart > 0 else np.ones(h.size)
        stretch = np.cumsum(h == 0)
        together = np.bincount(stretch, h > 0)[stretch]
        return np.maximum(parts, np.ceil(IN_STRETCH / np.maximum(together, 1))).astype(int)

    def _refine(self, parts: np.ndarray) -> bool:
        """Divide steps into so many parts; False where nothing is added."""
        steps, begin, end = self.steps, *self.span
        longer = np.flatnonzero((parts > self.parts) & (steps.h > 0))
        index = np.repeat(longer, parts[longer] - 1)
        ordinal = np.concatenate([np.arange(1, n) for n in parts[longer]] or [np.zeros(0, int)])
        share = ordinal / parts[index]
        known = (ordinal * self.parts[index]) % parts[index] == 0
        times = steps.t[index] + share * steps.h[index]
        length = times - steps.t[index]  # as who looks there again finds it
        new = ~known & (times > begin) & (times < end)
        if not new.any() or np.count_nonzero(new) > self.left:
            return False
        self.left -= int(np.count_nonzero(new))
        self.parts[longer] = parts[longer]
        self._add(times[new], Branches(index[new], length[new]))
        return True

    def _add(self, times: np.ndarray, more: Branches) -> None:
        found = self.kernel.trajectory(times, self.steps, more, self.p)
        index = np.append(self.branches.index, more.index)
        length = np.append(self.branches.length, more.length)
        order = np.lexsort((length, index))
        self.branches = Branches(index[order], length[order])
        columns = [
            np.concatenate([getattr(made, f.name) for made in (self.trajectory, found)], axis=-1)
            for f in fields(Trajectory)
        ]
        self.trajectory = Trajectory(*(column[..., order] for column in columns))

    def _bent(self) -> np.ndarray:
        """Steps with an interval in which some quantity leaves its straight line."""
        s, found = self.trajectory, np.zeros(self.steps.count, dtype=bool)
        apart = np.diff(s.t)
        jump = jumps_between(self.steps, s.t, self.branches.index)
        apart = np.where(jump, 1.0, apart)
        through = ~(jump[1:] | jump[:-1])  # outputs inside a smooth stretch
        bent = np.zeros(apart.size, dtype=bool)
        for rows in (s.y, s.v, s.a, s.multiplier):
            if not rows.shape[0]:
                continue
            size = np.ptp(rows, axis=1)
            size = np.maximum(size, SMALL * np.abs(rows).max())
            size = np.where(size > 0, size, 1.0)[:, None]
            slopes = np.diff(rows, axis=1) / (apart * size)
            curvature = np.where(through, np.abs(np.diff(slopes)).max(axis=0), 0.0)
            curvature = 2 * curvature / (apart[1:] + apart[:-1])
            most = np.maximum(np.append(curvature, 0.0), np.append(0.0, curvature))
            bent |= ~(most * apart**2 / 8 <= FLAT)
        found[self.branches.index[:-1][bent & ~jump]] = True
        return found


def jumps_between(steps: Steps, times: np.ndarray, index: np.ndarray) -> np.ndarray:
    """Intervals between outputs, by the steps these lie in, that are the two sides of a change."""
    apart = np.diff(times)
    return apart <= np.maximum(10 * steps.instant, 2 * INSIDE * steps.h[index[:-1]])


def contact_changes(kernel: DynamicsKernel, steps: Steps) -> np.ndarray:
    """Steps of no length with an output before them: at rigid contacts speeds or forces jump."""
    changes = [k for k, change in kernel.crossings(steps) if isinstance(change, ContactChange)]
    return np.array(changes, dtype=int)
