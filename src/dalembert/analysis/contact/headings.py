"""Stored slip directions over surfaces, renewed where gaps begin to slide, turn or slow down."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import casadi as ca

from dalembert.analysis.contact.pattern import Pattern, PatternImpulse
from dalembert.analysis.contact.quantities import ContactDynamics, gap_rows
from dalembert.formulations.base import memory_symbols, state_symbols
from dalembert.model.contacts import Phase, heading, slow
from dalembert.model.equations import Equations
from dalembert.model.rigid_gaps import headings
from dalembert.symbolic.formulas.expression import stack


class Headings:
    """The state with renewed slip directions.

    The direction of a sliding gap is its slip. A gap that begins to slide from rest has the
    direction in which its slip grows, which follows from the accelerations.

    Parameters
    ----------
    dynamics : ContactDynamics
    gaps : numbers of the touching gaps
    pattern : their phases from now on
    """

    def __init__(self, dynamics: ContactDynamics, gaps: Sequence[int], pattern: Pattern):
        self.dynamics, self.gaps, self.pattern = dynamics, gaps, pattern

    @cached_property
    def function(self) -> ca.Function:
        """``(t, x, p) → x``."""
        e = self.dynamics.equations
        x, stored = state_symbols(e), headings(e.contacts)
        renewed = [gap.heading for gap in e.contacts]
        for k, direction in zip(self.gaps, self._directions, strict=True):
            renewed[k] = direction if direction.numel() else renewed[k]
        memory = ca.substitute(memory_symbols(e), stored, ca.vertcat(*renewed))
        state = ca.vertcat(e.y, e.v, memory)
        return ca.Function("headings", [e.t, x, e.p], [ca.densify(state)], {"cse": True})

    @property
    def _directions(self) -> list[ca.SX]:
        """Directions of all touching gaps; empty for gaps without a stored direction."""
        d, e = self.dynamics, self.dynamics.equations
        contacts = [e.contacts[k] for k in self.gaps]
        pairs = list(zip(contacts, self.pattern.phases, self.pattern.sectors, strict=True))
        along = [heading(gap, phase, e.scales) for gap, phase, _ in pairs]
        friction = [gap.impact.friction for gap in contacts]
        none = [ca.SX(0)] * len(along)
        rows = gap_rows(e, self.gaps)
        beginning = PatternImpulse(
            d.delassus, d.acceleration, rows, self.pattern, friction, none, along
        ).solved[1]
        directions = []
        for (gap, phase, sector), direction in zip(pairs, beginning, strict=True):
            if phase is not Phase.SLIDING:
                directions.append(ca.SX(0, 1))
            else:
                directions.append(gap.slip if sector is None else slow(e.scales) * direction)
        return directions


def first_headings(e: Equations) -> ca.SX:
    """Initial directions of all gaps: their slips."""
    return stack(gap.slip for gap in e.contacts if gap.heading.numel())
