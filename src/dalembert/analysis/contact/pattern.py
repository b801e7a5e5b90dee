"""Patterns of gaps that press, stick and slide, and the impulses that follow from them.

In a pattern some rows of ``ξ = c + G P`` vanish and ``P`` has as many unknowns. Where a gap slides
over a surface in a direction not known yet, that is the one of its ``ξ_T``:

    P_T = −μ P_N d,      ξ_T ∥ d,      d = (cos θ, sin θ)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Any

import casadi as ca

from dalembert.model.contacts import Phase, Phases

SECTORS = 16
"""Of the directions over a surface, from the middles of which Newton's method starts."""
ITERATIONS = 7
"""Of Newton's method, from the middle of a sector to rounding."""


@dataclass(frozen=True)
class Place:
    """A gap of the problem.

    Attributes
    ----------
    normal : its row of ``ξ``
    slips : rows of its slip, none where nothing rubs
    """

    normal: int
    slips: tuple[int, ...] = ()


@dataclass(frozen=True)
class Pattern:
    """What every gap of a problem does.

    Attributes
    ----------
    phases : of each
    released : its normal impulse is the one given, and it may part
    sectors : of directions that have to be found, None of others
    """

    phases: Phases
    released: tuple[bool, ...]
    sectors: tuple[int | None, ...]


Entry = tuple[int, int, Any]


def pattern_rows(
    places: Sequence[Place],
    pattern: Pattern,
    friction: Sequence[Any],
    along: Sequence[Any],
    given: Sequence[Any],
) -> tuple[list[int], list[Entry], list[tuple[int, Any]]]:
    """Rows of ``ξ`` that vanish; ``P`` by entries (row, unknown, factor) and (row, value).

    Parameters
    ----------
    friction : ``μ`` of each gap
    along : unit vector along which it slides, where it does
    given : normal impulse of each that is released
    """
    zero: list[int] = []
    entries: list[Entry] = []
    fixed: list[tuple[int, Any]] = []
    whole = zip(places, pattern.phases, pattern.released, friction, along, given, strict=True)
    for place, phase, released, mu, way, impulse in whole:
        if phase is Phase.APART:
            continue
        slides = phase.sense or phase is Phase.SLIDING
        rubs = [(row, -mu * way[k]) for k, row in enumerate(place.slips)] if slides else []
        if released:
            fixed += [(row, share * impulse) for row, share in [(place.normal, 1.0), *rubs]]
        else:
            entries += [(row, len(zero), share) for row, share in [(place.normal, 1.0), *rubs]]
            zero.append(place.normal)
        if phase is Phase.STICKING:
            for row in place.slips:
                entries.append((row, len(zero), 1.0))
                zero.append(row)
    return zero, entries, fixed


@dataclass(frozen=True, eq=False)
class PatternImpulse:
    """Impulses of a pattern as expressions.

    Attributes
    ----------
    delassus, c : ``G``, ``c``
    places, pattern : what gaps do
    friction, given : as of ``pattern_rows``
    along : known directions; whatever it holds for others does not count
    """

    delassus: ca.SX
    c: ca.SX
    places: Sequence[Place]
    pattern: Pattern
    friction: Sequence[ca.SX]
    given: Sequence[ca.SX]
    along: Sequence[ca.SX]

    @property
    def solved(self) -> tuple[ca.SX, list[ca.SX]]:
        """``P``, and the directions of all gaps."""
        unknown = [k for k, sector in enumerate(self.pattern.sectors) if sector is not None]
        along = list(self.along)
        if not unknown:
            return self._impulse(along), along
        angles = ca.SX.sym("angle", len(unknown))
        for n, k in enumerate(unknown):
            along[k] = ca.vertcat(ca.cos(angles[n]), ca.sin(angles[n]))
        impulse = self._impulse(along)
        result = self.c + ca.mtimes(self.delassus, impulse)
        slips = [result[list(self.places[k].slips)] for k in unknown]
        turned = ca.vertcat(*(cross(along[k], u) for k, u in zip(unknown, slips, strict=True)))
        step = ca.solve(ca.densify(ca.jacobian(turned, angles)), turned)
        sectors = [self.pattern.sectors[k] or 0 for k in unknown]
        found = ca.SX([middle_of(sector) for sector in sectors])
        for _ in range(ITERATIONS):
            found = found - ca.substitute(step, angles, found)
        impulse, *along = [ca.substitute(part, angles, found) for part in (impulse, *along)]
        return impulse, along

    def _impulse(self, along: Sequence[ca.SX]) -> ca.SX:
        zero, entries, fixed = pattern_rows(
            self.places, self.pattern, self.friction, along, self.given
        )
        impulse = ca.SX.zeros(self.c.numel())
        for row, value in fixed:
            impulse[row] += value
        if not zero:
            return impulse
        spread = ca.SX.zeros(self.c.numel(), len(zero))
        for row, column, factor in entries:
            spread[row, column] = factor
        matrix = ca.mtimes(self.delassus, spread)[zero, :]
        left = (self.c + ca.mtimes(self.delassus, impulse))[zero]
        return impulse + ca.mtimes(spread, ca.solve(ca.densify(matrix), -left))


def cross(a: Any, b: Any) -> Any:
    """Of two vectors in a plane."""
    return a[0] * b[1] - a[1] * b[0]


def sector_of(angle: float) -> int:
    """The sector in which a direction lies."""
    return int(SECTORS * (angle / (2 * pi) % 1)) % SECTORS


def middle_of(sector: int) -> float:
    """Angle of the middle of a sector."""
    return 2 * pi * (sector + 0.5) / SECTORS
