"""Slips over surfaces that a state remembers, where gaps begin to slide, turn or slow down."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import casadi as ca

from dalembert.analysis.contact.pattern import Pattern, PatternImpulse
from dalembert.analysis.contact.quantities import ContactDynamics, places_of
from dalembert.formulations.base import memory_symbols, state_symbols
from dalembert.model.contacts import Phase, heading, slow
from dalembert.model.equations import Equations
from dalembert.model.rigid_gaps import headings
from dalembert.symbolic.formulas.expression import stack


class Headings:
    """The state with slips remembered anew.

    That of a gap that slides is its slip. One that begins to slide from rest has the direction in
    which its slip grows, which follows from the accelerations.

    Parameters
    ----------
    dynamics : ContactDynamics
    gaps : numbers of those that touch
    pattern : what they do from now on
    """

    def __init__(self, dynamics: ContactDynamics, gaps: Sequence[int], pattern: Pattern):
        self.dynamics, self.gaps, self.pattern = dynamics, gaps, pattern

    @cached_property
    def function(self) -> ca.Function:
        """``(t, x, p) → x``."""
        e = self.dynamics.equations
        x, held = state_symbols(e), headings(e.contacts)
        renewed = [gap.heading for gap in e.contacts]
        for k, way in zip(self.gaps, self._ways, strict=True):
            renewed[k] = way if way.numel() else renewed[k]
        memory = ca.substitute(memory_symbols(e), held, ca.vertcat(*renewed))
        after = ca.vertcat(e.y, e.v, memory)
        return ca.Function("headings", [e.t, x, e.p], [ca.densify(after)], {"cse": True})

    @property
    def _ways(self) -> list[ca.SX]:
        """Of every gap that touches; empty where there is none to remember."""
        d, e = self.dynamics, self.dynamics.equations
        contacts = [e.contacts[k] for k in self.gaps]
        pairs = list(zip(contacts, self.pattern.phases, self.pattern.sectors, strict=True))
        along = [heading(gap, phase, e.scales) for gap, phase, _ in pairs]
        friction = [gap.impact.friction for gap in contacts]
        none = [ca.SX(0)] * len(along)
        places = places_of(e, self.gaps)
        begun = PatternImpulse(
            d.delassus, d.acceleration, places, self.pattern, friction, none, along
        ).solved[1]
        ways = []
        for (gap, phase, sector), way in zip(pairs, begun, strict=True):
            if phase is not Phase.SLIDING:
                ways.append(ca.SX(0, 1))
            else:
                ways.append(gap.slip if sector is None else slow(e.scales) * way)
        return ways


def first_headings(e: Equations) -> ca.SX:
    """Of all gaps at the start: their slips."""
    return stack(gap.slip for gap in e.contacts if gap.heading.numel())
