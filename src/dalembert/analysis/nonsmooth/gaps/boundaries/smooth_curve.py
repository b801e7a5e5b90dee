"""Smooth boundaries of shapes: evaluation in columns, samples, and arcs of unique contact."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import casadi as ca
import numpy as np

from dalembert.elements.curves import Curve
from dalembert.symbolic.evaluation.mapped_kernel import MappedKernel

DENSE, TURN, PARTS, FEWEST, MOST = 4096, 2 * np.pi / 48, 24, 16, 2048
"""Points at which a curve is analysed; turn between samples [rad], samples of a straight curve,
smallest and largest number of samples."""
STRAIGHT, PROMINENT = 1e-6, 0.05
"""Curvature that counts as straight, by the size; peaks of the curvature of a concave arc that
divide it, by the largest curvature."""


class SmoothCurve:
    """A planar curve with the material on its left.

    Its arcs are convex, or concave between two maxima of the curvature. A ball, or a straight
    line, has at most one contact with an arc.

    Parameters
    ----------
    curve : in the axes of a body
    p : symbols of the parameters
    nominal : their values, for which samples are spaced

    Attributes
    ----------
    closed, low, period : whether it is periodic; start and length of the range of the parameter
    samples : (n,) parameters of samples, equally spaced in turn and length
    """

    def __init__(self, curve: Curve, p: ca.SX, nominal: np.ndarray):
        u = ca.SX.sym("u")
        position = curve.position(u)
        tangent = ca.jacobian(position, u)
        outputs = ca.vertcat(position, tangent, ca.jacobian(tangent, u))
        self.function = ca.Function("curve", [u, p], [ca.densify(outputs)], {"cse": True})
        self.closed, (self.low, high) = curve.closed, curve.interval()
        self.period = high - self.low
        self._mapped = MappedKernel(self.function, common=[1])
        self._analyse(nominal)

    @cached_property
    def parameters(self) -> np.ndarray:
        """Numbers of the parameters on which the curve depends."""
        numbers: np.ndarray = np.unique(self.function.jac_sparsity(0, 1).get_col()).astype(int)
        return numbers

    @property
    def text(self) -> tuple:
        """Equal for equal curves."""
        return self.function.serialize(), self.closed, self.low, self.period

    def wrapped(self, u: np.ndarray) -> np.ndarray:
        """Parameters within the range, if the curve is closed."""
        return self.low + (u - self.low) % self.period if self.closed else u

    def __call__(self, u: np.ndarray, p: np.ndarray) -> np.ndarray:
        """(3, n, 2) positions, first and second derivatives."""
        if not u.size:
            return np.zeros((3, 0, 2))
        values = self._mapped(self.wrapped(u)[None], p)[0]
        return values.reshape(-1, 3, 2).swapaxes(0, 1)

    def arc(self, u: np.ndarray) -> np.ndarray:
        """Numbers of the arcs that contain points."""
        count = len(self._breaks)
        number = np.searchsorted(self._breaks, self.wrapped(u), side="right")
        return number % max(count, 1) if self.closed else number

    @property
    def arcs(self) -> int:
        """Number of arcs."""
        return max(len(self._breaks), 1) if self.closed else len(self._breaks) + 1

    def samples_of(self, arc: int) -> np.ndarray:
        """Parameters of the samples of an arc, or of its start if it has none."""
        inside = self.samples[self.arc(self.samples) == arc]
        return inside if inside.size else self._breaks[[arc - 1]]

    def _analyse(self, nominal: np.ndarray) -> None:
        u = self.low + self.period * np.linspace(0.0, 1.0, DENSE, endpoint=not self.closed)
        place, tangent, second = self(u, nominal)
        speed = np.linalg.norm(tangent, axis=1)
        curvature = _cross(tangent, second) / np.where(speed > 0, speed, 1.0) ** 3
        ends = np.append(u, self.low + self.period) if self.closed else u
        after = [np.roll(x, -1, axis=0) if self.closed else x[1:] for x in (place, tangent)]
        before = [x if self.closed else x[:-1] for x in (place, tangent)]
        length = np.linalg.norm(after[0] - before[0], axis=1)
        turn = np.arctan2(_cross(before[1], after[1]), (before[1] * after[1]).sum(axis=1))
        measure = np.abs(turn) / TURN + length * PARTS / max(float(length.sum()), 1e-300)
        total = np.concatenate([[0.0], np.cumsum(measure)])
        count = int(np.clip(np.ceil(total[-1]), FEWEST, MOST))
        at = total[-1] * np.arange(count + (not self.closed)) / count
        self.samples = np.interp(at, total, ends)
        size = float(np.ptp(place, axis=0).max())
        bends = np.append(turn, np.zeros(u.size - turn.size))
        self._breaks = np.sort(u[_breaks(curvature, bends, STRAIGHT / size, self.closed)])


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    product: np.ndarray = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product


def _breaks(curvature: np.ndarray, turn: np.ndarray, straight: float, closed: bool) -> np.ndarray:
    """Numbers of points between arcs: changes of convexity, peaks of concave curvature, and halves
    of convex arcs that turn by more than a revolution."""
    from scipy.signal import find_peaks

    hollow = np.where(curvature < -straight, -curvature, 0.0)
    start = (int(hollow.argmax()) + 1) % hollow.size if closed else 0  # behind a concave part
    hollow, turn = np.roll(hollow, -start), np.roll(turn, -start)
    change = 1 + np.flatnonzero(np.diff(hollow > 0))
    peaks, _ = find_peaks(hollow, prominence=PROMINENT * max(float(hollow.max()), straight))
    ends = np.concatenate([[0], change, [hollow.size]])
    halves = []
    for begin, end in pairwise(ends):
        turned = np.cumsum(np.maximum(turn[begin:end], 0.0))
        if change.size and turned[-1] >= 2 * np.pi:
            halves.append(begin + int(np.searchsorted(turned, turned[-1] / 2)))
    wrap = [0] if closed and hollow.max() > 0 else []  # the largest concave curvature
    numbers = np.concatenate([change, peaks, halves, wrap]).astype(int)
    breaks: np.ndarray = np.unique((numbers + start) % curvature.size)
    return breaks


@dataclass(frozen=True, eq=False)
class SampledCurve:
    """A smooth curve with parameter values.

    Attributes
    ----------
    curve : SmoothCurve
    p : (np,) parameters
    """

    curve: SmoothCurve
    p: np.ndarray

    def __call__(self, u: np.ndarray) -> np.ndarray:
        """(3, n, 2) positions, first and second derivatives."""
        return self.curve(u, self.p)

    @cached_property
    def _at_samples(self) -> np.ndarray:
        return self(self.curve.samples)

    @property
    def places(self) -> np.ndarray:
        """(n, 2) positions of the samples."""
        places: np.ndarray = self._at_samples[0]
        return places

    @cached_property
    def normals(self) -> np.ndarray:
        """(n, 2) outward normals at the samples."""
        return outward(self._at_samples[1])

    @cached_property
    def spacing(self) -> np.ndarray:
        """(n,) larger distance of each sample from its neighbours."""
        ahead = np.linalg.norm(np.roll(self.places, -1, axis=0) - self.places, axis=1)
        if not self.curve.closed:
            ahead[-1] = 0.0
        return np.maximum(ahead, np.roll(ahead, 1))

    @cached_property
    def center(self) -> np.ndarray:
        """(2,) middle of its extent."""
        middle: np.ndarray = (self.places.min(axis=0) + self.places.max(axis=0)) / 2
        return middle

    @cached_property
    def radius(self) -> float:
        """Largest distance of its points from the centre."""
        distances = np.linalg.norm(self.places - self.center, axis=1)
        return float((distances + self.spacing / 2).max())

    def brackets(self, j: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Parameters of the samples before, at and after some samples."""
        u, count = self.curve.samples, self.curve.samples.size
        if not self.curve.closed:
            return u[np.maximum(j - 1, 0)], u[j], u[np.minimum(j + 1, count - 1)]
        period = self.curve.period
        before = np.where(j > 0, u[j - 1], u[j - 1] - period)
        return before, u[j], np.where(j < count - 1, u[(j + 1) % count], u[0] + period)

    def clipped(self, u: np.ndarray) -> np.ndarray:
        """Parameters within the range of an open curve."""
        c = self.curve
        return u if c.closed else np.clip(u, c.low, c.low + c.period)

    def minima(self, values: np.ndarray, slack: np.ndarray | float = 0.0) -> np.ndarray:
        """Mask of the local minima of values (m, n) at the samples, and of both ends of a series of
        values that are equal within ``slack``."""
        before, after = np.roll(values, 1, axis=1), np.roll(values, -1, axis=1)
        if not self.curve.closed:
            before[:, 0] = after[:, -1] = np.inf
        mask: np.ndarray = (values < before - slack) & (values <= after + slack)
        mask |= (values <= before + slack) & (values < after - slack)
        return mask


def outward(tangents: np.ndarray) -> np.ndarray:
    """Unit vectors to the right of tangents."""
    length = np.linalg.norm(tangents, axis=-1, keepdims=True)
    normals: np.ndarray = np.stack([tangents[..., 1], -tangents[..., 0]], axis=-1)
    return normals / np.where(length > 0, length, 1.0)
