"""Rigid gaps of a mechanism, with the symbols of their forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import casadi as ca

from dalembert.elements.base import Element
from dalembert.elements.contact.unilateral import Gap, Impact, Unilateral
from dalembert.elements.coordinates import Coordinates, rate_of
from dalembert.elements.states import foreign_states
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import stack, t


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
    """

    name: str
    distance: ca.SX
    slip: ca.SX
    impact: Impact
    normal: ca.SX
    tangential: ca.SX
    heading: ca.SX

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
    for element in elements:
        law = element.impact() if isinstance(element, Unilateral) else None
        if not isinstance(element, Unilateral) or law is None:
            continue
        gaps = element.gaps(partial(_rate, element.parts() or everything, everything))
        rigid += [
            RigidGap(element.name, gap.distance, gap.slip, law, *forces, _heading(gap, law))
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
