"""Contact dynamics: rates and accelerations of gaps, and their changes by impulses.

For the rates ``u = (ġ; slip)`` of all gaps and the forces ``F = (N; T)``, with the constraints,

    u⁺ = u⁻ + G P,      u̇ = w + G F,      G = W (M⁻¹ − M⁻¹Cᵀ(C M⁻¹Cᵀ)⁻¹C M⁻¹) Wᵀ

where G is the Delassus matrix. The normal directions of all gaps come first, then the slips.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.contact.pattern import GapRows
from dalembert.errors import UnsupportedError
from dalembert.formulations.base import Formulation, state_symbols
from dalembert.model.graph.contacts import Phase, touching
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.rigid_gaps import ANY, Branch, all_sides
from dalembert.symbolic.formulas.expression import stack

ROUNDING = 100 * float(np.finfo(float).eps)
LEAST = 1e-3
"""Minimum scale of speeds, relative to the natural speed."""
ZERO = 1e-12
"""Tolerance of a zero of a switching function, in natural lengths."""
SLOW = 1e-9
"""Threshold for a rate of a switching function, in natural speeds."""


class ContactDynamics:
    """Expressions of a system of equations with all gaps open.

    Attributes
    ----------
    sides : symbols of the sides of all switches of distances
    distance, speed, acceleration : ``g``, ``u``, ``w``
    rounding : rounding error of ``g`` from its terms, with a margin
    response : ``M⁻¹Wᵀ`` through the constraints: change of the speeds by unit impulses
    delassus : ``G``
    size : sum of the magnitudes of the terms of ``u``, plus a positive minimum
    laws : (3, gaps) ``e``, ``e_T``, ``μ``
    """

    def __init__(self, e: Equations, formulation: Formulation):
        self._switches = [gap.switches for gap in e.contacts]
        self.sides = stack(s.switches.sides for s in self._switches)
        frozen = [
            replace(gap, distance=s.distance, slip=s.slip)
            for gap, s in zip(e.contacts, self._switches, strict=True)
        ]
        self.equations = e = replace(e, contacts=tuple(frozen))
        whole = touching(e, (Phase.STICKING,) * len(e.contacts))
        m = e.constraint_count
        rows = ca.densify(-whole.jacobian[m:, :])
        solver = formulation.saddle(e)
        a, _ = solver.solve(e.force - e.bias, e.constraint_acceleration)
        none = ca.SX.zeros(m, rows.shape[0])
        self.response = ca.densify(solver.solve(rows.T, none)[0])
        self.delassus = ca.mtimes(rows, self.response)
        self.distance = ca.vertcat(*(gap.distance for gap in e.contacts))
        slopes = ca.jacobian(self.distance, ca.vertcat(e.t, e.y))
        terms = ca.mtimes(slopes, ca.vertcat(e.t, e.y))
        self.rounding = ca.mtimes(ca.fabs(slopes), ca.fabs(ca.vertcat(e.t, e.y)))
        self.rounding = ROUNDING * (self.rounding + ca.fabs(self.distance - terms))
        self.speed = -whole.velocity_constraints[m:]
        self.acceleration = ca.mtimes(rows, a) + whole.constraint_acceleration[m:]
        own = ca.substitute(self.speed, e.v, ca.SX.zeros(e.speed_count))
        self.size = ca.mtimes(ca.fabs(rows), ca.fabs(e.v)) + ca.fabs(own)
        self.size += LEAST * e.scales.length / e.scales.time
        laws = [g.impact for g in e.contacts]
        self.laws = ca.horzcat(
            *(ca.vertcat(law.restitution, law.tangential, law.friction) for law in laws)
        )

    @property
    def function(self) -> ca.Function:
        """``(t, x, p, sides)`` → values as in ``ContactState``."""
        e = self.equations
        outputs = [self.distance, self.rounding, self.speed, self.size, self.acceleration]
        outputs += [self.delassus, self.laws]
        x = state_symbols(e)
        arguments = [e.t, x, e.p, self.sides]
        return ca.Function("contacts", arguments, [ca.densify(f) for f in outputs])

    def on(self, branches: Sequence[Branch], outputs: Sequence[ca.SX]) -> list[ca.SX]:
        """Expressions on the branches of all gaps."""
        if not self.sides.numel():
            return list(outputs)
        pairs = zip(self._switches, branches, strict=True)
        values = all_sides([branch or (ANY,) * s.count for s, branch in pairs])
        return list(ca.substitute(list(outputs), [self.sides], [ca.SX(values)]))


@dataclass(frozen=True, eq=False)
class ContactState:
    """Values of ``ContactDynamics`` at a state.

    Attributes
    ----------
    slips : rows of the slip of every gap, empty without friction
    """

    distance: np.ndarray
    rounding: np.ndarray
    speed: np.ndarray
    size: np.ndarray
    acceleration: np.ndarray
    delassus: np.ndarray
    restitution: np.ndarray
    tangential: np.ndarray
    friction: np.ndarray
    slips: list[list[int]]

    @classmethod
    def at(cls, function: ca.Function, e: Equations, *arguments: Any) -> ContactState:
        """Values at ``(t, x, p, sides)``."""
        *columns, delassus, laws = (f.full() for f in function(*arguments))
        g, rounding, u, size, w = (f.ravel() for f in columns)
        return cls(g, rounding, u, size, w, delassus, laws[0], laws[1], laws[2], slip_rows(e))

    def rubs(self, gap: int) -> bool:
        """Whether friction acts at a gap."""
        return bool(self.slips[gap]) and self.friction[gap] > 0


class GapBranches:
    """Branches of the distances of all gaps at a state.

    Where a switching function is zero, as at the corner of a polygon, its rate along the motion
    determines the side: it is the side immediately after that instant.

    Parameters
    ----------
    e : Equations with free branches
    """

    def __init__(self, e: Equations):
        self.equations, self.switches = e, [gap.switches for gap in e.contacts]
        self.ends = np.cumsum([0, *(s.count for s in self.switches)])
        self.count = int(self.ends[-1])

    @cached_property
    def _function(self) -> ca.Function:
        """``(t, x, ẋ, p, sides)`` → switching functions of all gaps, and their rates."""
        e, x = self.equations, state_symbols(self.equations)
        g = stack(s.switches.functions for s in self.switches)
        sides = stack(s.switches.sides for s in self.switches)
        rate = ca.SX.sym("rate", x.numel())
        rates = ca.jtimes(g, ca.vertcat(e.t, x), ca.vertcat(1, rate))
        outputs = [ca.densify(g), ca.densify(rates)]
        return ca.Function("gap_branches", [e.t, x, rate, e.p, sides], outputs, {"cse": True})

    def sides(
        self,
        t: float,
        x: np.ndarray,
        rate: np.ndarray,
        p: np.ndarray,
        passed: tuple[int, int, int] | None = None,
    ) -> list[Branch]:
        """Sides of all switches of every gap immediately after an instant.

        Parameters
        ----------
        passed : gap, number of its switch that changes its side there, and the side after it
        """
        if not self.count:
            return [()] * len(self.switches)
        s = self.equations.scales
        near, slow = ZERO * s.length, SLOW * s.length / s.time
        sides = np.zeros(self.count)
        for _ in range(self.count + 1):  # functions depend on the sides of those before them
            values, rates = (out.full().ravel() for out in self._function(t, x, rate, p, sides))
            tied = (np.abs(values) <= near) & (np.abs(rates) > slow)
            following = np.where(tied, rates > 0, values > 0).astype(float)
            if passed is not None:
                following[self.ends[passed[0]] + passed[1]] = passed[2]
            if np.array_equal(following, sides):
                break
            sides = following
        return [tuple(int(k) for k in sides[a:b]) for a, b in pairwise(self.ends)]


def slip_rows(e: Equations) -> list[list[int]]:
    """Rows of ``u`` with the slip of every gap."""
    ends = len(e.contacts) + np.cumsum([0, *(gap.slip.numel() for gap in e.contacts)])
    return [list(range(a, b)) for a, b in pairwise(ends)]


def gap_rows(e: Equations, gaps: Sequence[int]) -> list[GapRows]:
    """Rows of ``u`` of some gaps."""
    slips = slip_rows(e)
    return [GapRows(k, tuple(slips[k])) for k in gaps]


def check_contacts(e: Equations, formulation: Formulation) -> None:
    """Refuse formulations that do not support impacts.

    Raises
    ------
    UnsupportedError
        Names a formulation that does.
    """
    if formulation.every_equation:
        raise UnsupportedError(
            f"{type(formulation).__name__} does not hold the rigid contact {e.contacts[0].name} "
            "exactly; use formulation=RangeSpace()"
        )
