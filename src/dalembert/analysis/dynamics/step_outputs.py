"""States of all bodies at the outputs of a run, and cubic Hermite polynomials inside its steps.

Slopes of the polynomials are rates times the length of the step.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.variant import Variant
from dalembert.analysis.output_places import OutputPlaces
from dalembert.integrators.marching.checkpoints import States
from dalembert.integrators.marching.steps import Steps
from dalembert.model.graph.equations import Equations
from dalembert.results.recording import Trajectory
from dalembert.symbolic.once import CacheOwner

BLOCK = 5000
"""Upper limit of the columns of a mapped function, to bound its memory."""


class StepOutputs(CacheOwner):
    """Evaluation of outputs, each by the variant of its part of the motion.

    Attributes
    ----------
    variants : variants used by runs so far
    equations : Equations of the run
    """

    variants: list[Variant]
    equations: Equations

    @property
    def latest(self) -> int:
        """The mode of a run without steps."""
        raise NotImplementedError

    def over(self, function: ca.Function, count: int) -> Callable[..., list[np.ndarray]]:
        """The function for ``count`` columns at once."""
        raise NotImplementedError

    def output_states(self, steps: Steps, places: OutputPlaces, p: np.ndarray) -> np.ndarray:
        """States at the outputs: stored ends of steps, else the result of a partial step."""
        k, ends = places.index, places.ends_of(steps)
        states = steps.x[:, k + ends]
        inside = np.flatnonzero((places.length != 0) & ~ends)
        for mode, part in columns_by_mode(steps.mode[k[inside]], inside):
            (states[:, part],) = self.over(self.variants[mode].step.function, part.size)(
                steps.t[k[part]],
                places.length[part],
                states[:, part],
                np.tile(p[:, None], part.size),
            )
        return states

    def between(
        self, times: np.ndarray, states: np.ndarray, mode: int, p: np.ndarray, parts: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Times and states at fractions of steps, by cubics; padded to a power of two of steps."""
        count = times.size - 1
        whole = np.minimum(np.arange((1 << (count - 1).bit_length()) + 1), count)
        t, x = times[whole], states[:, whole]
        rate = self.over(self.variants[mode].rate.function, t.size)
        (slope,) = rate(t, x, np.tile(p[:, None], t.size))
        h, c = np.diff(t)[:, None], parts
        ends = [a[:, :, None] for a in (x[:, :-1], x[:, 1:], slope[:, :-1], slope[:, 1:])]
        inside = cubic(c, ends[0], ends[1], h * ends[2], h * ends[3])
        return (t[:-1, None] + h * c).ravel(), inside.reshape(x.shape[0], -1)

    def modes(self, steps: Steps, places: OutputPlaces) -> np.ndarray:
        """Variant of each output."""
        if not steps.count:
            return np.full(places.index.size, self.latest)
        following = np.minimum(places.index + 1, steps.count - 1)
        modes = steps.mode[np.where(places.ends_of(steps), following, places.index)]
        if places.modes is None:
            return modes
        return np.where(places.modes < 0, modes, places.modes)

    def mapped(
        self,
        function_of: Callable[[Variant], ca.Function],
        modes: np.ndarray,
        times: np.ndarray,
        states: States,
        p: np.ndarray,
        *columns: np.ndarray,
    ) -> list[np.ndarray]:
        """``(t, x, p, …)`` functions of the variants over outputs, each by its own variant."""
        results: list[np.ndarray] = []
        size = self.variants[0].step.state_size
        for mode, part in columns_by_mode(modes, np.arange(modes.size)):
            function = function_of(self.variants[mode])
            parts = self.over(function, part.size)(
                times[part],
                states[:size, part],
                np.tile(p[:, None], part.size),
                *(column[:, part] for column in columns),
            )
            results = results or [np.zeros((r.shape[0], modes.size)) for r in parts]
            for whole, piece in zip(results, parts, strict=True):
                whole[:, part] = piece
        return results

    def trajectory(
        self, times: np.ndarray, steps: Steps, places: OutputPlaces, p: np.ndarray
    ) -> Trajectory:
        """Poses, speeds, accelerations and multipliers of all bodies at the outputs."""
        states = self.output_states(steps, places, p)
        modes = self.modes(steps, places)
        y, v, a, multiplier = self.mapped(lambda s: s.bodies, modes, times, states, p)
        n = self.equations.coordinate_count + self.equations.speed_count
        work = states[n : n + 2] - steps.x[n : n + 2, :1]
        return Trajectory(times, y, v, a, multiplier, work)


def columns_by_mode(modes: np.ndarray, chosen: np.ndarray) -> Iterator[tuple[int, np.ndarray]]:
    """Blocks of the chosen columns that share a mode, at most ``BLOCK`` columns each."""
    for mode in np.unique(modes):
        part = chosen[modes == mode]
        for begin in range(0, part.size, BLOCK):
            yield int(mode), part[begin : begin + BLOCK]


def cubic(c, begin, end, slope, slope_end) -> np.ndarray:
    """Values at fractions ``c`` of steps."""
    values = (1 + 2 * c) * (1 - c) ** 2 * begin + c**2 * (3 - 2 * c) * end
    return values + c * (1 - c) ** 2 * slope - c**2 * (1 - c) * slope_end


def minimum_of_cubic(begin, end, slope, slope_end) -> np.ndarray:
    """Fraction of every step at the minimum of the cubic inside; the middle without one."""
    a = 6 * (begin - end) + 3 * (slope + slope_end)
    b = -6 * (begin - end) - 4 * slope - 2 * slope_end
    with np.errstate(all="ignore"):
        root = np.sqrt(b**2 - 4 * a * slope)
        fraction = np.where(b > 0, -2 * slope / (b + root), (root - b) / (2 * a))
    return np.where((fraction > 0) & (fraction < 1), fraction, 0.5)
