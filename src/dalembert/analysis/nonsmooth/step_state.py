"""Start and result of one time step with contacts."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from dalembert.analysis.nonsmooth.impact_stage import ImpactStage
from dalembert.analysis.nonsmooth.smooth_motion import FreeMotion, SmoothStep
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.integrators.contact.approach import Approach
from dalembert.integrators.contact.contacts import Contacts
from dalembert.integrators.contact.impulses import Impulses

PATH_CHANGE = 1e-6
"""Estimated error of means over a step above which it is divided [-]."""
FULL = 0.75
"""Length of a step, relative to those of the run, below which it is part of a divided one [-]."""


@dataclass(frozen=True, eq=False)
class LastImpulses:
    """Part of a step on which the next one depends.

    Attributes
    ----------
    pressing : sorted keys, and impulses, of the contacts that press
    stuck : keys of the contacts with static friction at the end
    """

    pressing: tuple[np.ndarray, np.ndarray]
    stuck: np.ndarray


@dataclass(frozen=True, eq=False)
class StepResult:
    """Result of one step.

    Attributes
    ----------
    y, v : state at the end
    multiplier : of the joints, times the step
    contacts : contacts of the friction problem
    impulses : solution of the friction problem
    offsets : (n, k) velocity offsets of the conditions
    stuck : keys of the contacts with static friction at the end
    loss : energy dissipated by the contacts
    work : (n,) work of the normal forces of compliant contacts on the bodies [J]
    fractions : (n,) length of the step over the duration of compliant contacts, else zero [-]
    curved : keys of the contacts with means over the path; others have directions in the middle
    path : the solution whose displacement is the path of the means
    longest : longest step that may follow, for which gaps leave room [s]
    path_change : estimated error of means over the path that do not converge, else zero [-]
    impact : impacts at the start of the step; their impulses are part of ``impulses``
    closing : gaps that the linear motion closes; None if the scheme keeps all open
    returning : gaps without impulses that their rate at the start would close
    """

    y: np.ndarray
    v: np.ndarray
    multiplier: np.ndarray
    contacts: Contacts
    impulses: Impulses
    offsets: np.ndarray
    stuck: np.ndarray
    loss: float
    work: np.ndarray
    fractions: np.ndarray
    longest: float
    path_change: float = 0.0
    curved: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))
    path: StepResult | None = None
    impact: ImpactStage | None = None
    closing: Contacts | None = None
    returning: Contacts | None = None

    @property
    def pressing(self) -> tuple[np.ndarray, np.ndarray]:
        """Sorted keys, and impulses, of the contacts that press."""
        rows = np.flatnonzero(self.impulses.impulses[:, 0] > 0)
        rows = rows[np.argsort(self.contacts.key[rows])]
        return self.contacts.key[rows], self.impulses.impulses[rows]

    @property
    def last(self) -> LastImpulses:
        """Part on which the next step depends."""
        return LastImpulses(self.pressing, self.stuck)


@dataclass(frozen=True, eq=False)
class StepStart:
    """Start of a step, and its motion without contacts.

    Attributes
    ----------
    smooth : the step without contacts
    motion : the motion without impulses
    longest : longest step [s]
    begins : True in the first step
    impact : impacts that ``motion`` includes; None without any
    rest : as in ``Approach`` [s]
    """

    smooth: SmoothStep
    motion: FreeMotion
    longest: float
    begins: bool
    impact: ImpactStage | None = None
    rest: float = 0.0

    @property
    def t(self) -> float:
        """Start time [s]."""
        return self.smooth.t

    @property
    def h(self) -> float:
        """Length [s]."""
        return self.smooth.h

    @property
    def y(self) -> np.ndarray:
        return self.smooth.y

    @property
    def v(self) -> np.ndarray:
        return self.smooth.v

    @property
    def free(self) -> np.ndarray:
        """Speeds at the end without impulses."""
        return self.motion.speeds

    def after(self, impact: ImpactStage) -> StepStart:
        """The start with impacts."""
        return replace(self, motion=self.motion.after(impact.momentum), impact=impact)

    def with_impact(self, motion: FreeMotion) -> FreeMotion:
        """Another motion without impulses, with the impacts at the start."""
        return motion if self.impact is None else motion.after(self.impact.momentum)

    def approach(self, contacts: Contacts, rounding: float) -> Approach:
        """Contacts with their velocities; gaps up to ``rounding`` count as closed."""
        speeds = contacts.at_start(self.v), contacts.at_end(self.free)
        first = self.begins, rounding
        approach = Approach(contacts, *speeds, self.h, self.longest, *first, rest=self.rest)
        if self.impact is None:
            return approach
        change = contacts.directions @ self.impact.change
        struck = approach.before + change.reshape(approach.before.shape)
        return replace(approach, struck=struck, hit=self.impact.rows(contacts))

    def late(self, result: StepResult, rounding: float) -> np.ndarray:
        """Keys of the pressing contacts by other laws than Newton's that close fast, but take no
        part in the impacts of the start."""
        contacts = result.contacts
        other = ~contacts.laws.follows(ImpactLaw.NEWTON) & (result.impulses.impulses[:, 0] > 0)
        if not other.any():
            return contacts.key[:0]
        approach = self.approach(contacts, rounding)
        late: np.ndarray = contacts.key[other & approach.impacting & np.logical_not(approach.hit)]
        return late


def warm_start(
    contacts: Contacts, before: LastImpulses | None, shape: tuple[int, ...]
) -> np.ndarray:
    """Impulses of the same gaps in the step before; zero for new contacts."""
    start = np.zeros(shape)
    if before is None or not before.pressing[0].size:
        return start
    keys, impulses = before.pressing
    position = np.minimum(np.searchsorted(keys, contacts.key), keys.size - 1)
    same = keys[position] == contacts.key
    start[same] = impulses[position[same]]
    return start


def convergence_rate(error: float, last: float) -> float:
    """Factor by which the next repetition reduces an error after one of ``last``."""
    return min(error / last, 1.0) if last < np.inf else 1.0


def step_lengths(grid: np.ndarray, k: int, usual: float) -> tuple[float, float, float]:
    """Lengths of a step, of the next one, zero after the last, and of the longest one that may
    follow [s]: parts of a divided step leave room for impacts in the next part, others in a step of
    the ``usual`` length."""
    h = float(grid[k + 1] - grid[k])
    following = float(grid[k + 2] - grid[k + 1]) if k + 2 < grid.size else 0.0
    longest = max(h, following)
    return h, following, longest if longest < FULL * usual else usual
