"""Dense outputs of runs with error control.

Under error control a method of high order takes long steps, and straight lines between their ends
do not follow the motion. Each step is divided into equal parts until straight lines between
neighbouring outputs follow every coordinate, speed, acceleration and multiplier.

An output inside a step is a partial step from its beginning. It is as accurate as the steps for
every integrator, satisfies the constraints, and has gradients like any other output. An
interpolating polynomial has an order of its own (cubic Hermite 4, the steps of
``DormandPrince853`` 8) and leaves the constraints.
"""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from dalembert.analysis.contact.change import ContactChange
from dalembert.analysis.dynamics.event_search import end_by_event
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.step_quadrature import INSIDE, StepQuadrature
from dalembert.analysis.dynamics.transition import Transition
from dalembert.analysis.output_places import OutputPlaces, outputs_of, place_outputs
from dalembert.integrators.marching.steps import Steps
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once

LEAST = 200
"""Minimum number of intervals between outputs over the span of a run."""
IN_STRETCH = 4
"""Minimum number of intervals between two changes of forces or contacts."""
FLAT = 2e-3
"""Tolerance for the distance from the straight line between outputs, relative to the range."""
SMALL = 1e-6
"""Range, relative to the largest magnitude of its kind, below which a quantity is constant."""
MORE, PER_STEP = 1000, 4
"""Upper limit of the number of added outputs: the larger of a number and so many per step."""
MOST = 100_000
"""Upper limit of the number of outputs added to any run."""
ROUNDS = 6
"""Upper limit of the halvings of a step."""
NEGLIGIBLE = 40.0
"""Threshold of the difference of exponents for neglecting the smaller exponential."""
RISE = 0.5
"""Upper limit of the change of an exponent within a part of a step."""
STEP_PARTS, PARTS = 512, 50_000
"""Upper limits of the number of parts of a step, and of all steps."""


class DenseOutputs:
    """Outputs at the ends of steps and inside them.

    Parameters
    ----------
    kernel, steps : of the run
    times, places : outputs at the ends of the steps, both sides of every jump among them
    p : (np,) parameters

    Attributes
    ----------
    trajectory : Trajectory at all outputs
    places : places of all outputs
    """

    def __init__(
        self,
        kernel: DynamicsKernel,
        steps: Steps,
        times: np.ndarray,
        places: OutputPlaces,
        p: np.ndarray,
    ):
        self.kernel, self.steps, self.p = kernel, steps, p
        self.places = places
        self.trajectory = kernel.trajectory(times, steps, places, p)
        self.span = (float(times[0]), float(times[-1]))
        self._add_ends()
        self.budget = min(MOST, max(MORE, PER_STEP * steps.count))
        self.parts = np.ones(steps.count, dtype=int)
        if steps.count and np.all(np.isfinite(self.trajectory.y)):
            self._divide()

    def _add_ends(self) -> None:
        """Add outputs just before switches, where forces jump and formulas are ambiguous."""
        steps = self.steps
        crossings = self.kernel.crossings(steps)
        before = [k - 1 for k, change in crossings if isinstance(change, Transition)]
        index = np.array([k for k in before if k >= 0 and steps.h[k] > 0], dtype=int)
        times = steps.t[index] + (1 - INSIDE) * steps.h[index]
        inside = (times > self.span[0]) & (times < self.span[1])
        if inside.any():
            index, times = index[inside], times[inside]
            self._add(times, OutputPlaces(index, times - steps.t[index]))

    def _divide(self) -> None:
        parts = self._initial_parts()
        for _ in range(ROUNDS):
            if not self._refine(parts):
                return
            parts = np.where(self._bent_steps(), 2, 1) * self.parts

    def _initial_parts(self) -> np.ndarray:
        """Number of parts of each step by its length and by the number of steps between changes."""
        h = self.steps.h
        spacing = (self.span[1] - self.span[0]) / LEAST
        parts = np.ceil(h / spacing * (1 - 1e-9)) if spacing > 0 else np.ones(h.size)
        stretch = np.cumsum(h == 0)
        steps_in_stretch = np.bincount(stretch, h > 0)[stretch]
        return np.maximum(parts, np.ceil(IN_STRETCH / np.maximum(steps_in_stretch, 1))).astype(int)

    def _refine(self, parts: np.ndarray) -> bool:
        """Divide steps into the given numbers of parts; False if no output is added."""
        steps, begin, end = self.steps, *self.span
        refined = np.flatnonzero((parts > self.parts) & (steps.h > 0))
        index = np.repeat(refined, parts[refined] - 1)
        ordinal = np.concatenate([np.arange(1, n) for n in parts[refined]] or [np.zeros(0, int)])
        share = ordinal / parts[index]
        existing = (ordinal * self.parts[index]) % parts[index] == 0
        times = steps.t[index] + share * steps.h[index]
        length = times - steps.t[index]  # rounded as in a later search for these times
        new = ~existing & (times > begin) & (times < end)
        if not new.any() or np.count_nonzero(new) > self.budget:
            return False
        self.budget -= int(np.count_nonzero(new))
        self.parts[refined] = parts[refined]
        self._add(times[new], OutputPlaces(index[new], length[new]))
        return True

    def _add(self, times: np.ndarray, places: OutputPlaces) -> None:
        added = self.kernel.trajectory(times, self.steps, places, self.p)
        index = np.append(self.places.index, places.index)
        length = np.append(self.places.length, places.length)
        order = np.lexsort((length, index))
        self.places = OutputPlaces(index[order], length[order])
        columns = [
            np.concatenate(
                [getattr(trajectory, f.name) for trajectory in (self.trajectory, added)], axis=-1
            )
            for f in fields(Trajectory)
        ]
        self.trajectory = Trajectory(*(column[..., order] for column in columns))

    def _bent_steps(self) -> np.ndarray:
        """(n,) steps with an interval in which a quantity departs from its straight line."""
        s, marked = self.trajectory, np.zeros(self.steps.count, dtype=bool)
        spacing = np.diff(s.t)
        jump = jumps_between(self.steps, s.t, self.places.index)
        spacing = np.where(jump, 1.0, spacing)
        bent = np.zeros(spacing.size, dtype=bool)
        for rows in (s.y, s.v, s.a, s.multiplier):
            if not rows.shape[0]:
                continue
            size = np.ptp(rows, axis=1)
            size = np.maximum(size, SMALL * np.abs(rows).max())
            size = np.where(size > 0, size, 1.0)[:, None]
            bent |= ~(sagittas(rows, spacing, jump, size) <= FLAT)
        marked[self.places.index[:-1][bent & ~jump]] = True
        return marked


def sagittas(
    rows: np.ndarray, spacing: np.ndarray, jump: np.ndarray, size: float | np.ndarray = 1.0
) -> np.ndarray:
    """(k,) distances of (n, k + 1) samples from straight lines, estimated by second differences.

    Parameters
    ----------
    spacing : (k,) lengths of the intervals, positive also at jumps
    jump : (k,) whether the interval is a jump; slopes there are ignored
    size : of the rows, to which distances are relative
    """
    slopes = np.diff(rows, axis=1) / (spacing * size)
    curvature = np.where(jump[1:] | jump[:-1], 0.0, np.abs(np.diff(slopes)).max(axis=0))
    curvature = 2 * curvature / (spacing[1:] + spacing[:-1])
    largest = np.maximum(np.append(curvature, 0.0), np.append(0.0, curvature))
    return np.asarray(largest * spacing**2 / 8)


def jumps_between(steps: Steps, times: np.ndarray, index: np.ndarray) -> np.ndarray:
    """Intervals whose ends are the two sides of a change, by the steps of the outputs."""
    spacing = np.diff(times)
    return spacing <= np.maximum(10 * steps.instant, 2 * INSIDE * steps.h[index[:-1]])


def contact_changes(kernel: DynamicsKernel, steps: Steps) -> np.ndarray:
    """Steps of zero length with an output before them: speeds or forces jump at rigid contacts."""
    changes = [k for k, change in kernel.crossings(steps) if isinstance(change, ContactChange)]
    return np.array(changes, dtype=int)


@once
def dense(motion: Motion) -> Motion:
    """The motion at dense outputs, from its first output to its last."""
    record, time = motion.record, motion.time
    if record.dense or not record.steps.count or time.size < 2:
        return motion
    kernel, steps, p = record.kernel, record.steps, motion.parameters
    jumps = contact_changes(kernel, steps)
    times, places = outputs_of(steps, None, end_by_event(motion) is not None, jumps)
    inside = (times > time[0] + steps.instant) & (times < time[-1] - steps.instant)
    ends = place_outputs(steps, time[[0, -1]])
    index, length = (
        np.concatenate([ends_of_motion[:1], values[inside], ends_of_motion[1:]])
        for ends_of_motion, values in ((ends.index, places.index), (ends.length, places.length))
    )
    times = np.concatenate([time[:1], times[inside], time[-1:]])
    outputs = DenseOutputs(kernel, steps, times, OutputPlaces(index, length), p)
    record_at_outputs = replace(record, places=outputs.places, dense=True)
    return replace(motion, trajectory=outputs.trajectory, record=record_at_outputs)


def peak_quadrature(
    motion: Motion, measure: str | Expression, sharpness: float, sign: float, order: int
) -> StepQuadrature | None:
    """Quadrature points that resolve ``exp(± sharpness m)`` as well as the motion.

    None where the run has fixed steps, or outputs over a part of it only.
    """
    record, time = motion.record, motion.time
    steps = record.steps
    if record.kernel.adaptive is None or not steps.count or time.size < 2:
        return None
    if time[0] > steps.t[0] + steps.instant or time[-1] < steps.end - steps.instant:
        return None
    dense_motion = dense(motion)
    m = sign * sharpness * dense_motion.values(measure)
    if not np.all(np.isfinite(m)):
        return None
    intervals, index = np.diff(dense_motion.time), dense_motion.record.places.index
    lasting, index = ~jumps_between(steps, dense_motion.time, index), index[:-1]
    slope = np.abs(np.diff(m)) / np.where(lasting, intervals, 1.0)
    bend = np.sqrt(np.abs(np.diff(slope, append=slope[-1:])) / np.where(lasting, intervals, 1.0))
    steep = np.where(lasting, np.maximum(slope, bend), 0.0)
    steep[np.maximum(m[1:], m[:-1]) < m.max() - NEGLIGIBLE] = 0.0
    steepest = np.zeros(steps.count)
    np.maximum.at(steepest, index, steep)
    parts = np.clip(np.ceil(steepest * steps.h / RISE), 1, STEP_PARTS).astype(int)
    return StepQuadrature(steps, order, parts) if parts.sum() <= PARTS else None
