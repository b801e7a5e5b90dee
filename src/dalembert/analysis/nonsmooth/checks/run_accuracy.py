"""Error estimate of a nonsmooth run by repetition with longer steps.

With steps of ``q`` times the length, the error of a run is the difference of both runs over ``q −
1``, as the schemes are of first order, or over ``q² − 1`` with force laws alone, and for
``AnticipatedImpacts`` without impacts. The estimate includes errors of the instants of
impacts and their amplification by the motion. An impact is applied at an end of a step: half of
those of ``q = 2`` are among the ends of steps of the run, so that both runs often have the same
error, and those of periodic motions again and again. Therefore eight steps are repeated as five.

Errors of first order are partly random, as each impact is applied at an end of a step: the
difference of two runs may be a third of their errors. Where the first estimate is above
``CERTAIN``, the steps are repeated as four and as three, too, and the largest estimate counts.
Where these estimates differ, the error may be ``UNCERTAIN`` times as large. Each of fewer than
eight steps is repeated in ``PARTS``.

A motion may end between the instants that both runs have in common, such as that of a coin that
falls flat within five steps. An impact whose instant is wrong by half a step shifts positions by
``h |v⁺ − v⁻|/2``, which is a minimum of the estimate: the jump of the accelerations by second
differences of positions, beside their median over ``WINDOW`` steps.

Only coordinates are compared, as speeds jump. The size of the motion of a body includes that of its
points by its rotation: the mass centre of a coin that spins in place moves by the error alone, as
does the angle of a plate that falls flat.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np

from dalembert.analysis.error_estimate import SMALL, ErrorEstimate, largest_error, motion_sizes
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.elements.coordinates import Coordinates
from dalembert.errors import SingularityError
from dalembert.results.nonsmooth_motion import ContactRecord
from dalembert.results.status import Outcome, Status

ALLOWED, TARGET = 0.05, 0.02
"""Estimated error, relative to the motion: threshold for a warning, and target of the proposed
step."""
CERTAIN = ALLOWED / 4
"""Estimated error of impacts below which no further repetition follows [-]."""
SCATTER, UNCERTAIN = 1.5, 2.0
"""Ratio of the estimates by several repetitions above which the errors are partly random, and ratio
of such errors to their estimate [-]."""
SHORT, LONG, FURTHER, PARTS = 8, 5, (4, 3), 16
"""Numbers of steps of the run, of the repetition, and of further ones between instants at which
they are compared, and number of parts of each step of a run with fewer steps."""
WINDOW = 5
"""Number of instants whose median acceleration is that of the motion without an impact."""
RESTING = 1e-4
"""Minimum size of a motion, by the size of the bodies: those of bodies at rest are smaller, by
clearances of gaps and inexact joints [-]."""
UNPREDICTABLE = 0.5
"""Estimated error above which the motion is one of several that the steps may lead to [-]."""
FAINT = 1e-4
"""Minimum motion of points of a body by its rotation, relative to that of its mass centre [-]."""
FASTEST = 100.0
"""Largest speed of a repetition, relative to that of the run, or to the size of the bodies over
its duration, above which it has failed [-]."""
ENTRIES = 2e5
"""Upper limit of the number of entries of the states of a run whose warnings have the estimate."""


class Diverged(Exception):
    """A repetition is far faster than the run.

    Parameters
    ----------
    time : the instant [s]
    """

    def __init__(self, time: float):
        super().__init__(time)
        self.time = time


class RunAccuracy:
    """Error of a run with contacts.

    Parameters
    ----------
    step : ContactStep of the run
    record : ContactRecord of the run
    repeat : run on another grid of times, ``grid, fastest → positions, status``; raises
        ``Diverged`` above the speed ``fastest``
    """

    def __init__(
        self,
        step: ContactStep,
        record: ContactRecord,
        repeat: Callable[[np.ndarray, float], tuple[np.ndarray, Status]],
    ):
        self.step, self.record, self._repeat = step, record, repeat

    @cached_property
    def estimate(self) -> ErrorEstimate | None:
        """The estimate, infinite where other steps fail; None without steps, or where nothing
        moves."""
        if not self._estimates or not self._estimates[0].name:
            return next(iter(self._estimates), None)
        shift = self._of_impacts
        return max([*self._estimates, *([shift] if shift else [])], key=lambda of: of.share)

    @cached_property
    def _estimates(self) -> list[ErrorEstimate]:
        """Estimates by all repetitions."""
        few = self.record.t.size <= SHORT
        first = self._estimate(*((PARTS, 1) if few else (LONG,)))
        if first is None:
            return []
        if few or not first.name or self._order == 2 or first.share <= CERTAIN:
            return [first]
        return [first, *(of for count in FURTHER if (of := self._estimate(count)) and of.name)]

    @property
    def _uncertainty(self) -> float:
        """Ratio of the largest probable error to the estimate."""
        shares = [of.share for of in self._estimates]
        return UNCERTAIN if max(shares) > SCATTER * min(shares) else 1.0

    @property
    def _order(self) -> int:
        """Order of the errors of the steps."""
        lasting = self.step.scheme.anticipates and not self.record.kept.any()
        return 2 if lasting or self.step.force_laws.are_all else 1

    def _estimate(self, count: int, own: int = SHORT) -> ErrorEstimate | None:
        """The estimate by a repetition with ``count`` steps in place of ``own``."""
        if self.record.t.size == 1:
            return None
        record, longer = self.record, f"{own / count:.3g} times"
        grid, compared = other_steps(record.t, count, own)
        slow = self.step.model.scales.size / (record.t[-1] - record.t[0])
        fastest = FASTEST * float(np.abs(record.ends.v).max(initial=slow))
        try:
            positions, status = self._repeat(grid, fastest)
        except SingularityError:
            return ErrorEstimate(np.inf, "", float(record.t[0]), longer)
        except Diverged as failure:
            return ErrorEstimate(np.inf, "", failure.time, longer)
        if status.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if not status.success:
            return ErrorEstimate(np.inf, "", float(status.time), longer)
        y, times = record.ends.y, record.t[compared]
        error = y[:, compared] - positions[:, np.searchsorted(grid, times)]
        error = error / ((own / count) ** self._order - 1)
        return largest_error(error, self._sizes, self._names, times, longer)

    @property
    def _of_impacts(self) -> ErrorEstimate | None:
        """The estimate by the shifts of impacts within steps; None for one step."""
        if self.record.t.size == 2:
            return None
        t, jumps = self.record.t, impact_shifts(self.record.t, self.record.ends.y)
        return largest_error(jumps, self._sizes, self._names, t[1:-1])

    @property
    def _names(self) -> Sequence[str]:
        return self.step.model.guesses.names

    @cached_property
    def _sizes(self) -> np.ndarray:
        """(n_y,) sizes of the motion."""
        record, model = self.record, self.step.model
        ranges = np.ptp(record.ends.y, axis=1)
        natural = model.scales.coordinates.copy()
        natural[np.array(model.guesses.units) == "m"] *= model.scales.size / model.scales.length
        sizes = motion_sizes(ranges, model.guesses.units, natural)
        sizes = np.maximum(sizes, sizes_by_points(self.step, record))
        return np.maximum(sizes, np.where(sizes > 0, RESTING * natural, 0.0))

    @property
    def warnings(self) -> list[str]:
        """Warning if the steps are too long for the motion; of short runs and few bodies."""
        if self.record.ends.y.size > ENTRIES:
            return []
        estimate = self.estimate
        if estimate is None:
            return []
        h = float(np.median(np.diff(self.record.t)))
        if not estimate.name:
            text = f"the error of steps of {h:.3g} s is {estimate.text}"
            return [f"{text}; compare with a run with shorter steps"]
        factor = self._uncertainty
        if factor * estimate.share <= ALLOWED:
            return []
        if estimate.share > UNPREDICTABLE and estimate.repeated:
            return [
                f"the motion depends on the step of {h:.3g} s: with steps {estimate.repeated} as "
                f"long it differs by {estimate.text}; its impacts amplify small differences, or "
                "the step is far too long"
            ]
        shorter = h * TARGET / (factor * estimate.share)
        more = f", and may be {factor:g} times as large" if factor > 1 else ""
        return [
            f"steps of {h:.3g} s are long for this motion: their estimated error is "
            f"{estimate.text}{more}; use steps below {shorter:.2g} s"
        ]


def impact_shifts(t: np.ndarray, y: np.ndarray) -> np.ndarray:
    """(n_y, K−1) changes of positions (n_y, K+1) by half a step between the speeds before and after
    an impact, at the inner ones of the ends of steps (K+1,); those by forces nearly vanish."""
    h = np.diff(t)
    mean = (h[1:] + h[:-1]) / 2
    accelerations = np.diff(np.diff(y) / h) / mean
    side = WINDOW // 2
    padded = np.pad(accelerations, ((0, 0), (side, side)), mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, WINDOW, axis=1)
    return np.asarray((accelerations - np.median(windows, axis=2)) * mean * h[1:])


def sizes_by_points(step: ContactStep, record: ContactRecord) -> np.ndarray:
    """(n_y,) minimum sizes of coordinates by the motion of points of their bodies, at the radii of
    gyration: of lengths by that due to rotation, of rotations by that of the mass centre."""
    y = record.ends.y
    inertia = step.smooth.at(float(record.t[0]), y[:, 0], step.p)[0].matrix.diagonal()
    sizes, first, speed = np.zeros(y.shape[0]), 0, 0
    for group in step.model.coordinates:
        units, speed_units = (np.array(u) for u in (group.coordinate_units, group.speed_units))
        angular, linear = (speed + np.flatnonzero(speed_units == unit) for unit in ("rad", "m"))
        if angular.size and linear.size and inertia[linear].min() > 0:
            radius = np.sqrt(inertia[angular].max() / inertia[linear].min())
            motion = y[first : first + units.size]
            lengths, angles = units == "m", units == "rad"
            half = _largest_turn(group, motion, units) / 2
            sizes[first + np.flatnonzero(lengths)] = SMALL * 2 * radius * np.sin(half)
            travel = np.ptp(motion[lengths], axis=1).max(initial=0.0)
            if radius > 0:
                sizes[first + np.flatnonzero(angles)] = FAINT * travel / radius
                if group.attitude is not None:  # Euler parameters, half the rotation
                    attitude = first + group.attitude[0] + np.arange(4)
                    sizes[attitude] = FAINT * travel / radius / 2
        first, speed = first + units.size, speed + speed_units.size
    return sizes


def _largest_turn(group: Coordinates, y: np.ndarray, units: np.ndarray) -> float:
    """Largest rotation of a group from its start, at most half a turn [rad]."""
    if group.attitude is None:
        return min(float(np.ptp(y[units == "rad"], axis=1).max(initial=0.0)), np.pi)
    turned = y[group.attitude[0] : group.attitude[0] + 4]
    return float(2 * np.arccos(np.clip(np.abs(turned.T @ turned[:, 0]), 0, 1)).max())


def other_steps(
    t: np.ndarray, count: int = LONG, own: int = SHORT
) -> tuple[np.ndarray, np.ndarray]:
    """A grid of other steps, and the numbers of the ends of steps that it contains.

    Parameters
    ----------
    t : (K+1,) ends of the steps of a run; the last ones may be fewer than ``own``
    count : number of steps in place of ``own``
    """
    compared = np.unique(np.append(np.arange(0, t.size, own), t.size - 1))
    counts = np.maximum(np.round(np.diff(compared) * count / own), 1).astype(int)
    parts = [
        np.linspace(t[i], t[j], count + 1)[:-1]
        for i, j, count in zip(compared[:-1], compared[1:], counts, strict=True)
    ]
    return np.append(np.concatenate(parts), t[-1]), compared


def check_speeds(t: float, v: np.ndarray, fastest: float) -> None:
    """Refuse speeds above a limit.

    Raises
    ------
    Diverged
        A speed is above ``fastest``, or is not a number.
    """
    if not np.abs(v).max(initial=0.0) <= fastest:
        raise Diverged(t)
