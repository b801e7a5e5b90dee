"""Which gaps press, stick and slide: one problem for impacts and for lasting contact.

``ξ = c + G P``, and for every gap one of

    apart     P = 0,                      ξ_N ≥ 0
    smooth    ξ_N = 0,  P_T = 0,          P_N ≥ 0
    sticking  ξ_N = 0,  ξ_T = 0,          P_N ≥ 0,  |P_T| ≤ μ P_N
    sliding   ξ_N = 0,  P_T = −μ P_N d,   P_N ≥ 0,  ξ_T = |ξ_T| d

(Glocker 2001, Set-Valued Force Laws). A gap with an impulse given, as restitution by Poisson's law
gives it, has ``P_N ≥ P̄`` in place of ``P_N ≥ 0``, and is released with ``P_N = P̄``, ``ξ_N ≥ 0``.
All patterns are tried, for gaps that touch at one time are few. Without friction the motion is
unique; with it there may be none or several (Painlevé 1895).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from math import prod

import numpy as np

from dalembert.analysis.contact.directions import directions
from dalembert.analysis.contact.pattern import Pattern, Place, cross, pattern_rows, sector_of
from dalembert.model.contacts import Phase, Phases

MOST = 20000
"""Patterns that are tried."""
ROUNDING = 1e-9
"""Relative to the largest entry, what is zero."""
SINGULAR = 1e12
"""Condition of a pattern whose forces are not unique."""


@dataclass(frozen=True, eq=False)
class Touch:
    """A gap of the problem.

    Attributes
    ----------
    place : rows of ``ξ``
    friction : ``μ``
    allowed : phases that are possible
    along : direction in which it slides already, whatever ``ξ_T`` is; None where none is known
    given : ``P̄``
    """

    place: Place
    friction: float
    allowed: Phases
    along: np.ndarray | None = None
    given: float = 0.0

    @property
    def choices(self) -> list[tuple[Phase, bool]]:
        """Phases, released or not."""
        if self.given <= 0:
            return [(phase, False) for phase in self.allowed]
        closed = [phase for phase in self.allowed if phase is not Phase.APART]
        return [(phase, released) for phase in closed for released in (False, True)]


@dataclass(frozen=True, eq=False)
class Solution:
    """A pattern with the impulses ``P`` and ``ξ``, and the directions in which gaps slide."""

    pattern: Pattern
    along: Sequence[np.ndarray | None]
    impulse: np.ndarray
    result: np.ndarray

    @property
    def phases(self) -> Phases:
        return self.pattern.phases


def solutions(
    delassus: np.ndarray, c: np.ndarray, touches: Sequence[Touch], least: float = 0.0
) -> list[Solution]:
    """All that differ in ``ξ``; more patterns than ``MOST`` count as none.

    Parameters
    ----------
    least : size of ``ξ`` by which it is measured at least, for where all of it vanishes
    """
    found: list[Solution] = []
    if too_many(touches):
        return found
    rows = sorted({row for t in touches for row in (t.place.normal, *t.place.slips)})
    size = np.max(np.abs(c[rows]), initial=least)
    for chosen in product(*(touch.choices for touch in touches)):
        for solution in _Choice(delassus, c, touches, chosen).solutions():
            if not _holds(solution, touches, size):
                continue
            result = solution.result[rows]
            if not any(np.allclose(result, s.result[rows], 0, 1e-6 * size) for s in found):
                found.append(solution)
    return found


def too_many(touches: Sequence[Touch]) -> bool:
    """Whether there are more patterns than are tried."""
    return prod(len(touch.choices) for touch in touches) > MOST


Angles = Sequence[float] | np.ndarray


class _Choice:
    """One pattern; directions of slip over surfaces may be left to find."""

    def __init__(self, delassus, c, touches: Sequence[Touch], chosen):
        self.delassus, self.c, self.touches = delassus, c, touches
        self.phases = tuple(phase for phase, _ in chosen)
        self.released = tuple(released for _, released in chosen)
        self.along = [
            np.array([phase.sense]) if phase.sense else touch.along
            for touch, phase in zip(touches, self.phases, strict=True)
        ]
        self.unknown = [
            k
            for k, (phase, along) in enumerate(zip(self.phases, self.along, strict=True))
            if phase is Phase.SLIDING and along is None
        ]

    def solutions(self) -> Iterator[Solution]:
        if not self.unknown:
            found = [self._solved(self.along, [])]
        else:
            starts = self._starts()
            angles = [] if starts is None else directions(self._turned, starts)
            found = [self._solved(self._directed(each), each) for each in angles]
        yield from (solution for solution in found if solution is not None)

    def _directed(self, angles: Angles) -> list[np.ndarray | None]:
        along = list(self.along)
        for k, angle in zip(self.unknown, angles, strict=True):
            along[k] = np.array([np.cos(angle), np.sin(angle)])
        return along

    def _turned(self, angles: Angles) -> np.ndarray:
        """Slips across the directions assumed."""
        along = self._directed(angles)
        found = self._solved(along, angles)
        if found is None:
            return np.full(len(angles), np.nan)
        slips = [found.result[list(self.touches[k].place.slips)] for k in self.unknown]
        return np.array([cross(along[k], u) for k, u in zip(self.unknown, slips, strict=True)])

    def _starts(self) -> np.ndarray | None:
        """Angles of the slips if nothing rubbed there."""
        along = list(self.along)
        for k in self.unknown:
            along[k] = np.zeros(2)
        found = self._solved(along, [0.0] * len(self.unknown))
        if found is None:
            return None
        slips = [found.result[list(self.touches[k].place.slips)] for k in self.unknown]
        return np.array([np.arctan2(u[1], u[0]) for u in slips])

    def _solved(self, along, angles: Angles) -> Solution | None:
        sectors: list[int | None] = [None] * len(self.touches)
        for k, angle in zip(self.unknown, angles, strict=True):
            sectors[k] = sector_of(angle)
        pattern = Pattern(self.phases, self.released, tuple(sectors))
        places = [touch.place for touch in self.touches]
        friction, given = [t.friction for t in self.touches], [t.given for t in self.touches]
        zero, entries, fixed = pattern_rows(places, pattern, friction, along, given)
        impulse = np.zeros(self.c.size)
        for row, value in fixed:
            impulse[row] += value
        if zero:
            spread = np.zeros((self.c.size, len(zero)))
            for row, column, factor in entries:
                spread[row, column] = factor
            matrix = (self.delassus @ spread)[zero]
            if not np.linalg.cond(matrix) < SINGULAR:
                return None
            left = (self.c + self.delassus @ impulse)[zero]
            impulse = impulse + spread @ np.linalg.solve(matrix, -left)
        return Solution(pattern, along, impulse, self.c + self.delassus @ impulse)


def _holds(solution: Solution, touches: Sequence[Touch], size: float) -> bool:
    """Whether all inequalities are met."""
    near, force = ROUNDING * size, ROUNDING * np.max(np.abs(solution.impulse), initial=0.0)
    pattern = solution.pattern
    parts = zip(touches, pattern.phases, pattern.released, solution.along, strict=True)
    for touch, phase, released, along in parts:
        normal, xi = solution.impulse[touch.place.normal], solution.result
        if (phase is Phase.APART or released) and xi[touch.place.normal] < -near:
            return False
        if phase is Phase.APART:
            continue
        if normal < touch.given - force:
            return False
        slips = list(touch.place.slips)
        if not slips:
            continue
        slip, rubbed = xi[slips], solution.impulse[slips]
        if phase is Phase.STICKING:
            if np.linalg.norm(rubbed) > touch.friction * normal + force:
                return False
        elif phase is Phase.SMOOTH:
            if touch.friction and np.linalg.norm(slip) > near:
                return False
        elif touch.along is None and along is not None and np.dot(along, slip) < -near:
            return False
    return True
