"""The jump of the speeds at an impact, by the phases of the gaps that take part.

    M (v⁺ − v⁻) = Wᵀ P_N + Uᵀ P_T − Cᵀ Λ,      C v⁺ = −Φ_t

with ``ξ = u⁺ + e u⁻`` zero where a gap presses, and where it sticks (Newton's law of restitution in
all touching gaps at once; Moreau 1988). The energy lost is ``−Pᵀ (u⁺ + u⁻)/2`` (Thomson and Tait).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import casadi as ca

from dalembert.analysis.contact.complementarity import Touch, pattern_matrix
from dalembert.analysis.contact.quantities import ContactDynamics, slip_rows
from dalembert.formulations.base import WORK, state_symbols
from dalembert.model.contacts import Phase


class Jump:
    """Speeds after an impact, as a function of the state before.

    Parameters
    ----------
    dynamics : ContactDynamics
    gaps : numbers of those that take part
    phases : of each
    dead : those among them that do not bounce this time
    """

    def __init__(
        self,
        dynamics: ContactDynamics,
        gaps: Sequence[int],
        phases: Sequence[Phase],
        dead: frozenset[int],
    ):
        self.dynamics, self.gaps, self.phases, self.dead = dynamics, gaps, phases, dead

    @cached_property
    def impulse(self) -> ca.SX:
        """``P`` of all gaps."""
        d, e = self.dynamics, self.dynamics.equations
        slips, size = slip_rows(e), d.speed.numel()
        touches = [Touch(k, slips[k][0] if slips[k] else None, 0.0, ()) for k in self.gaps]
        friction = [e.contacts[k].impact.friction for k in self.gaps]
        zero, entries = pattern_matrix(touches, self.phases, friction)
        if not zero:
            return ca.SX.zeros(size)
        c, spread = ca.SX(d.speed), ca.SX.zeros(size, len(zero))
        for k in self.gaps:
            law = e.contacts[k].impact
            if k not in self.dead:
                c[k] *= 1 + law.restitution
            for row in slips[k]:
                c[row] *= 1 + law.tangential
        for row, column, factor in entries:
            spread[row, column] = factor
        matrix = ca.mtimes(d.delassus, spread)[zero, :]
        return ca.mtimes(spread, ca.solve(ca.densify(matrix), -c[zero]))

    @cached_property
    def function(self) -> ca.Function:
        """``(t, x, p)`` → state after it, impulses."""
        d, e = self.dynamics, self.dynamics.equations
        x, impulse = state_symbols(e), self.impulse
        v = e.v + ca.mtimes(d.response, impulse)
        gained = ca.dot(v, e.inertia.times(v)) / 2 - e.kinetic_energy
        lost = -ca.dot(impulse, d.speed + ca.mtimes(d.delassus, impulse) / 2)
        work = WORK + ca.vertcat(lost, gained + lost)
        after = ca.vertcat(e.y, v, work, self._sides(v))
        found = [ca.densify(after), ca.densify(impulse)]
        return ca.Function("jump", [e.t, x, e.p], found, {"cse": True})

    def _sides(self, v: ca.SX) -> ca.SX:
        """Sides of switches, those over which the speeds jump turned."""
        e, sides = self.dynamics.equations, self.dynamics.equations.switches.sides
        before, after = e.switches.actual, ca.substitute(e.switches.actual, e.v, v)
        return ca.if_else(before == after, sides, after) if sides.numel() else sides
