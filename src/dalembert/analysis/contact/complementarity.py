"""Complementarity problem of rigid gaps with friction, for impacts and lasting contact.

``ξ = c + G P``, and for every gap one of the phases

    apart     P = 0,                      ξ_N ≥ 0
    smooth    ξ_N = 0,  P_T = 0,          P_N ≥ 0
    sticking  ξ_N = 0,  ξ_T = 0,          P_N ≥ 0,  |P_T| ≤ μ P_N
    sliding   ξ_N = 0,  P_T = −μ P_N d,   P_N ≥ 0,  ξ_T = |ξ_T| d

(Glocker 2001, Set-Valued Force Laws). A gap with a prescribed impulse, as in restitution by
Poisson's law, has ``P_N ≥ P̄`` in place of ``P_N ≥ 0``, and is released with ``P_N = P̄``,
``ξ_N ≥ 0``. All patterns are tried, because few gaps touch at one time. Without friction the motion
is unique; with friction there may be none or several (Painlevé 1895).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from math import prod

import numpy as np

from dalembert.analysis.contact.pattern import GapRows, Pattern, pattern_rows, sector_of
from dalembert.elements.planar.body import cross
from dalembert.model.graph.contacts import Phase, Phases

SAMPLES = 48
"""Number of sampled directions of one gap in the search for sign changes."""
STARTS = (0.0, np.pi / 3, -np.pi / 3, np.pi)
"""Offsets of the initial angles of several gaps from the directions without friction [rad]."""
SAME = 1e-6
"""Tolerance for equal directions, and for a root relative to the largest sample."""

CrossSlips = Callable[[Sequence[float]], np.ndarray]
"""Angles of the gaps → slips across these directions, zero at a solution."""
MOST = 20000
"""Upper limit of the number of patterns."""
ROUNDING = 1e-9
"""Threshold for zero, relative to the largest entry."""
SINGULAR = 1e12
"""Threshold of the condition number above which the forces of a pattern are not unique."""


def directions(cross_slips: CrossSlips, near: np.ndarray) -> list[np.ndarray]:
    """Angles at which every gap slides along its direction or against it."""
    return _one_gap(cross_slips) if near.size == 1 else _several_gaps(cross_slips, near)


def _one_gap(cross_slips: CrossSlips) -> list[np.ndarray]:
    from scipy.optimize import brentq

    def value(angle: float) -> float:
        return float(cross_slips([angle])[0])

    samples = np.linspace(0.0, 2 * np.pi, SAMPLES + 1) + 0.01
    values, angles = [value(angle) for angle in samples], []
    largest = np.nanmax(np.abs(values))
    for (a, f_a), (b, f_b) in pairwise(zip(samples, values, strict=True)):
        if f_a == 0.0:
            angles.append(a)
        elif f_a * f_b < 0:
            root = float(brentq(value, a, b, xtol=1e-14, rtol=1e-14))
            if abs(value(root)) <= SAME * largest:  # no pole
                angles.append(root)
    return [np.array([angle]) for angle in angles]


def _several_gaps(cross_slips: CrossSlips, near: np.ndarray) -> list[np.ndarray]:
    from scipy.optimize import root

    solutions: list[np.ndarray] = []
    for start in STARTS:
        result = root(lambda angles: cross_slips(list(angles)), near + start, tol=1e-13)
        if not (result.success and np.isfinite(result.x).all()):
            continue
        distances = [
            np.abs(np.exp(1j * result.x) - np.exp(1j * solution)).max() for solution in solutions
        ]
        if not any(distance < SAME for distance in distances):
            solutions.append(result.x)
    return solutions


@dataclass(frozen=True, eq=False)
class GapConditions:
    """Friction and permitted phases of a gap of the problem.

    Attributes
    ----------
    rows : rows of ``ξ``
    friction : ``μ``
    allowed : permitted phases
    along : direction of the preceding slip, for any ``ξ_T``; None if undetermined
    prescribed : ``P̄``
    """

    rows: GapRows
    friction: float
    allowed: Phases
    along: np.ndarray | None = None
    prescribed: float = 0.0

    @property
    def choices(self) -> list[tuple[Phase, bool]]:
        """Permitted pairs (phase, released)."""
        if self.prescribed <= 0:
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
    delassus: np.ndarray, c: np.ndarray, touches: Sequence[GapConditions], least: float = 0.0
) -> list[Solution]:
    """Solutions that differ in ``ξ``; none for more patterns than ``MOST``.

    Parameters
    ----------
    least : minimum scale of ``ξ``, for the case that ``c`` vanishes
    """
    unique: list[Solution] = []
    if too_many(touches):
        return unique
    rows = sorted({row for t in touches for row in (t.rows.normal, *t.rows.slips)})
    size = np.max(np.abs(c[rows]), initial=least)
    for chosen in product(*(touch.choices for touch in touches)):
        for solution in _Candidate(delassus, c, touches, chosen).solutions():
            if not _is_admissible(solution, touches, size):
                continue
            result = solution.result[rows]
            if not any(np.allclose(result, s.result[rows], 0, 1e-6 * size) for s in unique):
                unique.append(solution)
    return unique


def too_many(touches: Sequence[GapConditions]) -> bool:
    """Whether there are more patterns than ``MOST``."""
    return prod(len(touch.choices) for touch in touches) > MOST


Angles = Sequence[float] | np.ndarray


class _Candidate:
    """One pattern, possibly with unknown slip directions over surfaces."""

    def __init__(self, delassus, c, touches: Sequence[GapConditions], chosen):
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
            candidates = [self._solve(self.along, [])]
        else:
            starts = self._starts()
            angles = [] if starts is None else directions(self._cross_slips, starts)
            candidates = [
                self._solve(self._directions_at(angles_of_gaps), angles_of_gaps)
                for angles_of_gaps in angles
            ]
        yield from (solution for solution in candidates if solution is not None)

    def _directions_at(self, angles: Angles) -> list[np.ndarray | None]:
        along = list(self.along)
        for k, angle in zip(self.unknown, angles, strict=True):
            along[k] = np.array([np.cos(angle), np.sin(angle)])
        return along

    def _cross_slips(self, angles: Angles) -> np.ndarray:
        """Slips across the assumed directions."""
        along = self._directions_at(angles)
        solution = self._solve(along, angles)
        if solution is None:
            return np.full(len(angles), np.nan)
        slips = [solution.result[list(self.touches[k].rows.slips)] for k in self.unknown]
        return np.array([cross(along[k], u) for k, u in zip(self.unknown, slips, strict=True)])

    def _starts(self) -> np.ndarray | None:
        """Angles of the slips without friction."""
        along = list(self.along)
        for k in self.unknown:
            along[k] = np.zeros(2)
        solution = self._solve(along, [0.0] * len(self.unknown))
        if solution is None:
            return None
        slips = [solution.result[list(self.touches[k].rows.slips)] for k in self.unknown]
        return np.array([np.arctan2(u[1], u[0]) for u in slips])

    def _solve(self, along, angles: Angles) -> Solution | None:
        sectors: list[int | None] = [None] * len(self.touches)
        for k, angle in zip(self.unknown, angles, strict=True):
            sectors[k] = sector_of(angle)
        pattern = Pattern(self.phases, self.released, tuple(sectors))
        gap_rows = [touch.rows for touch in self.touches]
        friction, prescribed = (
            [t.friction for t in self.touches],
            [t.prescribed for t in self.touches],
        )
        zero, entries, fixed = pattern_rows(gap_rows, pattern, friction, along, prescribed)
        impulse = np.zeros(self.c.size)
        for row, value in fixed:
            impulse[row] += value
        if zero:
            distribution = np.zeros((self.c.size, len(zero)))
            for row, column, factor in entries:
                distribution[row, column] = factor
            matrix = (self.delassus @ distribution)[zero]
            if not np.linalg.cond(matrix) < SINGULAR:
                return None
            constant = (self.c + self.delassus @ impulse)[zero]
            impulse = impulse + distribution @ np.linalg.solve(matrix, -constant)
        return Solution(pattern, along, impulse, self.c + self.delassus @ impulse)


def _is_admissible(solution: Solution, touches: Sequence[GapConditions], size: float) -> bool:
    """Whether all inequalities are satisfied."""
    slip_tolerance, force_tolerance = (
        ROUNDING * size,
        ROUNDING * np.max(np.abs(solution.impulse), initial=0.0),
    )
    pattern = solution.pattern
    parts = zip(touches, pattern.phases, pattern.released, solution.along, strict=True)
    for touch, phase, released, along in parts:
        normal, xi = solution.impulse[touch.rows.normal], solution.result
        if (phase is Phase.APART or released) and xi[touch.rows.normal] < -slip_tolerance:
            return False
        if phase is Phase.APART:
            continue
        if normal < touch.prescribed - force_tolerance:
            return False
        slips = list(touch.rows.slips)
        if not slips:
            continue
        slip, tangential = xi[slips], solution.impulse[slips]
        if phase is Phase.STICKING:
            if np.linalg.norm(tangential) > touch.friction * normal + force_tolerance:
                return False
        elif phase is Phase.SMOOTH:
            if touch.friction and np.linalg.norm(slip) > slip_tolerance:
                return False
        elif touch.along is None and along is not None and np.dot(along, slip) < -slip_tolerance:
            return False
    return True
