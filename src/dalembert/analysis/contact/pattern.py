"""Patterns of contact phases, their impulses, and the active set of a state.

In a pattern some rows of ``ξ = c + G P`` vanish and ``P`` has as many unknowns. An unknown slip
direction over a surface is that of ``ξ_T``:

    P_T = −μ P_N d,      ξ_T ∥ d,      d = (cos θ, sin θ)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import pi
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.planar.body import cross
from dalembert.model.graph.contacts import Phase, Phases
from dalembert.model.graph.rigid_gaps import Branch

SECTORS = 16
"""Number of sectors of slip directions; Newton's method starts in the middle of one."""
ITERATIONS = 7
"""Newton iterations from the middle of a sector to rounding."""


@dataclass(frozen=True)
class GapRows:
    """Rows of ``ξ`` of a gap.

    Attributes
    ----------
    normal : row of the normal direction
    slips : rows of the slip, none without friction
    """

    normal: int
    slips: tuple[int, ...] = ()


@dataclass(frozen=True)
class Pattern:
    """Phases of all gaps of a problem.

    Attributes
    ----------
    phases : phase of each gap
    released : the normal impulse is prescribed, and the gap may open
    sectors : sectors of unknown slip directions, else None
    """

    phases: Phases
    released: tuple[bool, ...]
    sectors: tuple[int | None, ...]


@dataclass(frozen=True, eq=False)
class ActiveSet:
    """Phases of all gaps from a state on, and the impact that leads to them.

    Attributes
    ----------
    phases : phases of all gaps
    gaps : numbers of the gaps in an impact
    patterns : pattern of the impact, or two for compression and restitution; empty without impact
    dead : gaps that do not bounce, after an accumulation of impacts
    impulse : ``P`` of the impact, None without impact
    together : gaps that closed at the same time
    trouble : message if no unique active set exists, else empty
    acceleration : ``u̇`` of all gaps in these phases
    resting : numbers of the gaps that touch without separating
    rest : pattern of the resting gaps
    branches : of the distances of all touching gaps, empty for the others
    """

    phases: Phases
    gaps: tuple[int, ...] = ()
    patterns: tuple[Pattern, ...] = ()
    dead: frozenset[int] = field(default_factory=frozenset)
    impulse: np.ndarray | None = None
    together: tuple[int, ...] = ()
    trouble: str = ""
    acceleration: np.ndarray | None = None
    resting: tuple[int, ...] = ()
    rest: Pattern | None = None
    branches: tuple[Branch, ...] = ()


Entry = tuple[int, int, Any]


def pattern_rows(
    gap_rows: Sequence[GapRows],
    pattern: Pattern,
    friction: Sequence[Any],
    along: Sequence[Any],
    prescribed: Sequence[Any],
) -> tuple[list[int], list[Entry], list[tuple[int, Any]]]:
    """Rows of ``ξ`` that vanish; ``P`` by entries (row, unknown, factor) and (row, value).

    Parameters
    ----------
    friction : ``μ`` of each gap
    along : unit vector of the slip of each sliding gap
    prescribed : normal impulse of each released gap
    """
    zero: list[int] = []
    entries: list[Entry] = []
    fixed: list[tuple[int, Any]] = []
    conditions = zip(
        gap_rows, pattern.phases, pattern.released, friction, along, prescribed, strict=True
    )
    for rows, phase, released, mu, direction, impulse in conditions:
        if phase is Phase.APART:
            continue
        slides = phase.sense or phase is Phase.SLIDING
        rubs = [(row, -mu * direction[k]) for k, row in enumerate(rows.slips)] if slides else []
        if released:
            fixed += [(row, share * impulse) for row, share in [(rows.normal, 1.0), *rubs]]
        else:
            entries += [(row, len(zero), share) for row, share in [(rows.normal, 1.0), *rubs]]
            zero.append(rows.normal)
        if phase is Phase.STICKING:
            for row in rows.slips:
                entries.append((row, len(zero), 1.0))
                zero.append(row)
    return zero, entries, fixed


@dataclass(frozen=True, eq=False)
class PatternImpulse:
    """Impulses of a pattern as expressions.

    Attributes
    ----------
    delassus, c : ``G``, ``c``
    rows, pattern : rows and phases of the gaps
    friction, prescribed : as in ``pattern_rows``
    along : known directions; entries of unknown directions are ignored
    """

    delassus: ca.SX
    c: ca.SX
    rows: Sequence[GapRows]
    pattern: Pattern
    friction: Sequence[ca.SX]
    prescribed: Sequence[ca.SX]
    along: Sequence[ca.SX]

    @property
    def solved(self) -> tuple[ca.SX, list[ca.SX]]:
        """``P``, and slip directions of all gaps."""
        unknown = [k for k, sector in enumerate(self.pattern.sectors) if sector is not None]
        along = list(self.along)
        if not unknown:
            return self._impulse(along), along
        angles = ca.SX.sym("angle", len(unknown))
        for n, k in enumerate(unknown):
            along[k] = ca.vertcat(ca.cos(angles[n]), ca.sin(angles[n]))
        impulse = self._impulse(along)
        result = self.c + ca.mtimes(self.delassus, impulse)
        slips = [result[list(self.rows[k].slips)] for k in unknown]
        cross_slips = ca.vertcat(*(cross(along[k], u) for k, u in zip(unknown, slips, strict=True)))
        step = ca.solve(ca.densify(ca.jacobian(cross_slips, angles)), cross_slips)
        sectors = [self.pattern.sectors[k] or 0 for k in unknown]
        roots = ca.SX([middle_of(sector) for sector in sectors])
        for _ in range(ITERATIONS):
            roots = roots - ca.substitute(step, angles, roots)
        impulse, *along = [ca.substitute(part, angles, roots) for part in (impulse, *along)]
        return impulse, along

    def _impulse(self, along: Sequence[ca.SX]) -> ca.SX:
        zero, entries, fixed = pattern_rows(
            self.rows, self.pattern, self.friction, along, self.prescribed
        )
        impulse = ca.SX.zeros(self.c.numel())
        for row, value in fixed:
            impulse[row] += value
        if not zero:
            return impulse
        distribution = ca.SX.zeros(self.c.numel(), len(zero))
        for row, column, factor in entries:
            distribution[row, column] = factor
        matrix = ca.mtimes(self.delassus, distribution)[zero, :]
        constant = (self.c + ca.mtimes(self.delassus, impulse))[zero]
        return impulse + ca.mtimes(distribution, ca.solve(ca.densify(matrix), -constant))


def sector_of(angle: float) -> int:
    """The sector in which a direction lies."""
    return int(SECTORS * (angle / (2 * pi) % 1)) % SECTORS


def middle_of(sector: int) -> float:
    """Angle of the middle of a sector."""
    return 2 * pi * (sector + 0.5) / SECTORS
