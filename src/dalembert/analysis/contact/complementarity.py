"""Which gaps press, stick and slide: one problem for impacts and for lasting contact.

``ξ = c + G P``, and for every gap one of

    apart     P = 0,                    ξ_N ≥ 0
    smooth    ξ_N = 0,  P_T = 0,        P_N ≥ 0
    sticking  ξ_N = 0,  ξ_T = 0,        P_N ≥ 0,  |P_T| ≤ μ P_N
    sliding   ξ_N = 0,  P_T = ∓ μ P_N,  P_N ≥ 0,  ±ξ_T ≥ 0

(Glocker 2001, Set-Valued Force Laws). All patterns are tried, for gaps that touch at one time are
few. Without friction the motion is unique; with it there may be none or several (Painlevé 1895).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import prod
from typing import Any

import numpy as np

from dalembert.model.contacts import Phase

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
    normal : its row of ``ξ``
    slip : row of its slip, None where nothing rubs
    friction : ``μ``
    allowed : phases that are possible
    moving : it slides in a sense already, whatever ``ξ_T`` is
    """

    normal: int
    slip: int | None
    friction: float
    allowed: tuple[Phase, ...]
    moving: bool = False


@dataclass(frozen=True, eq=False)
class Solution:
    """Phases of the gaps with the impulses ``P`` and ``ξ``."""

    phases: tuple[Phase, ...]
    impulse: np.ndarray
    result: np.ndarray


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
    rows = sorted({t.normal for t in touches} | {t.slip for t in touches if t.slip is not None})
    size = np.max(np.abs(c[rows]), initial=least)
    for phases in product(*(touch.allowed for touch in touches)):
        solution = _solved(delassus, c, touches, phases)
        if solution is None or not _holds(solution, touches, size):
            continue
        known = [np.allclose(solution.result[rows], s.result[rows], 0, 1e-6 * size) for s in found]
        if not any(known):
            found.append(solution)
    return found


def too_many(touches: Sequence[Touch]) -> bool:
    """Whether there are more patterns than are tried."""
    return prod(len(touch.allowed) for touch in touches) > MOST


def pattern_matrix(
    touches: Sequence[Touch], phases: Sequence[Phase], friction: Sequence[Any]
) -> tuple[list[int], list[tuple[int, int, Any]]]:
    """Rows of ``ξ`` that vanish, and entries (row of P, unknown, factor) of P by its unknowns."""
    zero: list[int] = []
    entries: list[tuple[int, int, Any]] = []
    for touch, phase, mu in zip(touches, phases, friction, strict=True):
        if phase is Phase.APART:
            continue
        entries.append((touch.normal, len(zero), 1.0))
        if phase.sense:
            entries.append((touch.slip or 0, len(zero), -phase.sense * mu))
        zero.append(touch.normal)
        if phase is Phase.STICKING and touch.slip is not None:
            entries.append((touch.slip, len(zero), 1.0))
            zero.append(touch.slip)
    return zero, entries


def _solved(delassus, c, touches, phases) -> Solution | None:
    zero, entries = pattern_matrix(touches, phases, [t.friction for t in touches])
    if not zero:
        return Solution(phases, np.zeros(c.size), c.copy())
    spread = np.zeros((c.size, len(zero)))
    for row, column, factor in entries:
        spread[row, column] = factor
    matrix = (delassus @ spread)[zero]
    if not np.linalg.cond(matrix) < SINGULAR:
        return None
    impulse = spread @ np.linalg.solve(matrix, -c[zero])
    return Solution(phases, impulse, c + delassus @ impulse)


def _holds(solution: Solution, touches: Sequence[Touch], size: float) -> bool:
    """Whether all inequalities are met."""
    near, force = ROUNDING * size, ROUNDING * np.max(np.abs(solution.impulse), initial=0.0)
    for touch, phase in zip(touches, solution.phases, strict=True):
        normal, xi = solution.impulse[touch.normal], solution.result
        if phase is Phase.APART:
            if xi[touch.normal] < -near:
                return False
            continue
        if normal < -force:
            return False
        if touch.slip is None:
            continue
        if phase is Phase.STICKING:
            if abs(solution.impulse[touch.slip]) > touch.friction * normal + force:
                return False
        elif phase.sense and not touch.moving:
            if phase.sense * xi[touch.slip] < -near:
                return False
        elif phase is Phase.SMOOTH and touch.friction and abs(xi[touch.slip]) > near:
            return False
    return True
