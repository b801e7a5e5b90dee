"""Jump of the speeds at an impact, for given phases of the gaps in contact.

    M (v⁺ − v⁻) = Wᵀ P_N + Uᵀ P_T − Cᵀ Λ,      C v⁺ = −Φ_t

with ``ξ = u⁺ + e u⁻`` zero where a gap presses, and where it sticks (Newton's law of restitution in
all touching gaps at once; Moreau 1988). By Poisson's law there are two such impulses: that of
compression with ``ξ = u``, and that of restitution with the prescribed ``P̄ = e P_N`` (Pfeiffer
and Glocker 1996, ch. 8). The energy lost is ``−Pᵀ (u⁺ + u⁻)/2`` (Thomson and Tait).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import casadi as ca

from dalembert.analysis.contact.contact_dynamics import ContactDynamics, gap_rows, slip_rows
from dalembert.analysis.contact.pattern import Pattern, PatternImpulse
from dalembert.formulations.base import WORK, memory_symbols, state_symbols
from dalembert.model.graph.contacts import Phase, heading, slow
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.rigid_gaps import Branch, headings
from dalembert.symbolic.formulas.expression import stack


class Jump:
    """Speeds after an impact as a function of the state before.

    Parameters
    ----------
    dynamics : ContactDynamics
    gaps : numbers of the gaps in contact
    patterns : their pattern, or two for compression and restitution
    dead : gaps among them that do not bounce
    branches : of the distances of all gaps
    """

    def __init__(
        self,
        dynamics: ContactDynamics,
        gaps: Sequence[int],
        patterns: Sequence[Pattern],
        dead: frozenset[int],
        branches: Sequence[Branch],
    ):
        self.dynamics, self.gaps, self.patterns, self.dead = dynamics, gaps, patterns, dead
        self.branches = branches

    @cached_property
    def impulse(self) -> ca.SX:
        """``P`` of all gaps."""
        if len(self.patterns) == 1:
            return self._part(self.patterns[0], self._restituted, [ca.SX(0)] * len(self.gaps))
        d, contacts = self.dynamics, self.dynamics.equations.contacts
        compression = self._part(self.patterns[0], d.speed, [ca.SX(0)] * len(self.gaps))
        prescribed = [
            ca.SX(0) if k in self.dead else contacts[k].impact.restitution * compression[k]
            for k in self.gaps
        ]
        after = d.speed + ca.mtimes(d.delassus, compression)
        return compression + self._part(self.patterns[1], after, prescribed)

    @property
    def _restituted(self) -> ca.SX:
        """``u⁻ + e u⁻``, also in tangential directions."""
        c, e = ca.SX(self.dynamics.speed), self.dynamics.equations
        for k in self.gaps:
            if k not in self.dead:
                c[k] *= 1 + e.contacts[k].impact.restitution
            for row in slip_rows(e)[k]:
                c[row] *= 1 + e.contacts[k].impact.tangential
        return c

    def _part(self, pattern: Pattern, c: ca.SX, prescribed: Sequence[ca.SX]) -> ca.SX:
        e = self.dynamics.equations
        friction = [e.contacts[k].impact.friction for k in self.gaps]
        along = [ca.SX(phase.sense) for phase in pattern.phases]
        rows = gap_rows(e, self.gaps)
        impulse = PatternImpulse(
            self.dynamics.delassus, c, rows, pattern, friction, prescribed, along
        )
        return impulse.solved[0]

    @cached_property
    def function(self) -> ca.Function:
        """``(t, x, p)`` → state after the impact, impulses."""
        d, e = self.dynamics, self.dynamics.equations
        x, impulse = state_symbols(e), self.impulse
        v = e.v + ca.mtimes(d.response, impulse)
        gained = ca.dot(v, e.inertia.times(v)) / 2 - e.kinetic_energy
        lost = -ca.dot(impulse, d.speed + ca.mtimes(d.delassus, impulse) / 2)
        work = WORK + ca.vertcat(lost, gained + lost)
        after = ca.vertcat(e.y, v, work, headings(e.contacts), self._switch_signs(v))
        outputs = d.on(self.branches, [ca.densify(after), ca.densify(impulse)])
        return ca.Function("jump", [e.t, x, e.p], outputs, {"cse": True})

    def _switch_signs(self, v: ca.SX) -> ca.SX:
        """Signs of switching functions, changed where the speeds jump across."""
        e, sides = self.dynamics.equations, self.dynamics.equations.switches.sides
        before, after = e.switches.actual, ca.substitute(e.switches.actual, e.v, v)
        return ca.if_else(before == after, sides, after) if sides.numel() else sides


class Headings:
    """The state with renewed slip directions.

    The direction of a sliding gap is its slip. A gap that begins to slide from rest has the
    direction in which its slip grows, which follows from the accelerations.

    Parameters
    ----------
    dynamics : ContactDynamics
    gaps : numbers of the touching gaps
    pattern : their phases from now on
    branches : of the distances of all gaps
    """

    def __init__(
        self,
        dynamics: ContactDynamics,
        gaps: Sequence[int],
        pattern: Pattern,
        branches: Sequence[Branch],
    ):
        self.dynamics, self.gaps, self.pattern = dynamics, gaps, pattern
        self.branches = branches

    @cached_property
    def function(self) -> ca.Function:
        """``(t, x, p) → x``."""
        d, e = self.dynamics, self.dynamics.equations
        x, stored = state_symbols(e), headings(e.contacts)
        renewed = [gap.heading for gap in e.contacts]
        for k, direction in zip(self.gaps, self._directions, strict=True):
            renewed[k] = direction if direction.numel() else renewed[k]
        memory = ca.substitute(memory_symbols(e), stored, ca.vertcat(*renewed))
        outputs = d.on(self.branches, [ca.densify(ca.vertcat(e.y, e.v, memory))])
        return ca.Function("headings", [e.t, x, e.p], outputs, {"cse": True})

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
