"""Rigid gaps of a mechanism, with the symbols of their forces, and branches of their distances.

The distance from a surface with several faces is a formula with ``min``, ``max`` and comparisons.
While a gap is closed its distance is that of one branch, which is smooth, also beyond the end of a
face. The signs of the switching functions on which this branch depends end it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import casadi as ca
import numpy as np

from dalembert.elements.base import Element
from dalembert.elements.contact.unilateral import Gap, Impact, Unilateral
from dalembert.elements.coordinates import Coordinates, rate_of
from dalembert.elements.states import foreign_states
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import stack, t
from dalembert.symbolic.formulas.switches import Switches, freeze_branches

ANY = -1
"""Entry of a branch for a switch without influence on it."""
Branch = tuple[int, ...]
"""Sides of the switches, 1 or 0; empty for a distance without switches."""


@dataclass(frozen=True, eq=False)
class GapSwitches:
    """Distance and slip of a gap with frozen branches.

    Attributes
    ----------
    distance, slip : as of the gap, dependent on the sides of the switches
    switches : of distance and slip; none if the distance has none
    """

    distance: ca.SX
    slip: ca.SX
    switches: Switches
    _branches: list[Branch] = field(default_factory=list)

    @classmethod
    def of(cls, distance: ca.SX, slip: ca.SX, moving: ca.SX) -> GapSwitches:
        """Switches of a distance and a slip; ``moving`` are the symbols of positions and ``t``."""
        if not freeze_branches([distance], moving, False)[1].count:
            return cls(distance, slip, Switches())
        (distance, slip), switches = freeze_branches([distance, slip], moving, False)
        return cls(distance, slip, switches)

    @property
    def count(self) -> int:
        return self.switches.count

    def on(self, branch: Branch) -> tuple[ca.SX, ca.SX]:
        """Distance and slip of a branch."""
        values = [ca.SX([max(side, 0) for side in branch])]
        distance, slip = ca.substitute([self.distance, self.slip], [self.switches.sides], values)
        return distance, slip

    def branch(self, sides: Sequence[int]) -> Branch:
        """The branch of given sides, without those that have no influence on it."""
        for known in self._branches:
            if all(a in (b, ANY) for a, b in zip(known, sides, strict=True)):
                return known
        branch = [int(side) for side in sides]
        for k in reversed(range(self.count)):
            left_out = [*branch[:k], ANY, *branch[k + 1 :]]
            if not self._depends(left_out):
                branch = left_out
        self._branches.append(tuple(branch))
        return self._branches[-1]

    def _depends(self, branch: Sequence[int]) -> bool:
        """Whether the distance depends on the sides that are ``ANY``."""
        chosen = [k for k, side in enumerate(branch) if side != ANY]
        sides = self.switches.sides
        values = ca.SX([branch[k] for k in chosen])
        parts = [self.distance, self.slip]
        parts = ca.substitute(parts, [sides[chosen]], [values]) if chosen else parts
        return bool(ca.depends_on(ca.veccat(*parts), sides))

    def watched(self, branch: Branch) -> tuple[list[int], list[int]]:
        """Switches that end a branch, and those on which their functions depend."""
        ending = [k for k, side in enumerate(branch) if side != ANY]
        functions, sides = self.switches.functions, self.switches.sides
        pattern = np.array(ca.DM(ca.jacobian_sparsity(functions, sides), 1).full())
        chosen, new = set(ending), set(ending)
        while new:
            new = {int(j) for k in new for j in np.flatnonzero(pattern[k])} - chosen
            chosen |= new
        return ending, sorted(chosen - {*ending})

    def functions(self, numbers: Sequence[int]) -> list[ca.SX]:
        """Some switching functions, with the actual sides of the others."""
        s = self.switches
        return ca.vertsplit(ca.substitute(s.functions[list(numbers)], s.sides, s.actual))


@dataclass(frozen=True, eq=False)
class RigidGap:
    """A gap with its law and the symbols of its forces.

    Attributes
    ----------
    name : of the element
    distance, slip : as in ``Gap``
    impact : Impact
    normal, tangential : symbols of ``N`` and ``T``
    heading : (2,) symbols of the last stored slip along a surface, part of the state; empty for
        one direction of slip, or without friction
    moving : symbols of positions and ``t``
    """

    name: str
    distance: ca.SX
    slip: ca.SX
    impact: Impact
    normal: ca.SX
    tangential: ca.SX
    heading: ca.SX
    moving: ca.SX

    @cached_property
    def switches(self) -> GapSwitches:
        """Branches of the distance."""
        return GapSwitches.of(self.distance, self.slip, self.moving)

    def on(self, branch: Branch) -> RigidGap:
        """The gap on a branch of its distance; itself for an empty branch."""
        if not branch:
            return self
        distance, slip = self.switches.on(branch)
        return replace(self, distance=distance, slip=slip)

    def forces(self) -> ca.SX:
        return ca.vertcat(self.normal, self.tangential)


def rigid_gaps(elements: Sequence[Element], everything: list[Coordinates]) -> tuple[RigidGap, ...]:
    """Rigid gaps of all elements.

    Raises
    ------
    ModelError
        Laws of restitution that cannot act in one impact.
    """
    rigid: list[RigidGap] = []
    moving = ca.vertcat(t.sx, *(coordinates.pose for coordinates in everything))
    for element in elements:
        law = element.impact() if isinstance(element, Unilateral) else None
        if not isinstance(element, Unilateral) or law is None:
            continue
        gaps = element.gaps(partial(_rate, element.parts() or everything, everything))
        rigid += [
            RigidGap(element.name, gap.distance, gap.slip, law, *forces, _heading(gap, law), moving)
            for gap, forces in zip(gaps, element.force_symbols, strict=True)
        ]
    first = {gap.impact.poisson: gap.name for gap in rigid}
    if len(first) > 1:
        raise ModelError(
            f"has restitution by Poisson's law and {first[False]} by Newton's, and both may act in "
            "one impact; give poisson=True to all rigid contacts or to none",
            first[True],
        )
    return tuple(rigid)


def _rate(owners: list[Coordinates], everything: list[Coordinates], expression: ca.SX) -> ca.SX:
    others = foreign_states(expression, owners, everything)
    return rate_of(expression, [*owners, *others], t.sx)


def _heading(gap: Gap, law: Impact) -> ca.SX:
    along_surface = gap.slip.numel() > 1 and not law.friction.is_zero()
    return ca.SX.sym("heading", gap.slip.numel() if along_surface else 0)


def headings(gaps: Sequence[RigidGap]) -> ca.SX:
    """Symbols of all stored slips, gap by gap."""
    return stack(gap.heading for gap in gaps)


def contact_forces(gaps: Sequence[RigidGap]) -> ca.SX:
    """Symbols of all contact forces, gap by gap."""
    return stack(gap.forces() for gap in gaps)


def all_sides(branches: Sequence[Branch]) -> list[int]:
    """Sides of all gaps in one list; 0 for those without influence."""
    return [max(side, 0) for branch in branches for side in branch]
