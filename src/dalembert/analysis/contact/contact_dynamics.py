"""Contact dynamics: rates and accelerations of gaps, and their changes by impulses.

For the rates ``u = (ġ; slip)`` of all gaps and the forces ``F = (N; T)``, with the constraints,

    u⁺ = u⁻ + G P,      u̇ = w + G F,      G = W (M⁻¹ − M⁻¹Cᵀ(C M⁻¹Cᵀ)⁻¹C M⁻¹) Wᵀ

where G is the Delassus matrix. The normal directions of all gaps come first, then the slips.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import casadi as ca
import numpy as np

from dalembert.analysis.contact.pattern import GapRows
from dalembert.errors import UnsupportedError
from dalembert.formulations.base import Formulation, state_symbols
from dalembert.model.graph.contacts import Phase, touching
from dalembert.model.graph.equations import Equations

ROUNDING = 100 * float(np.finfo(float).eps)
LEAST = 1e-3
"""Minimum scale of speeds, relative to the natural speed."""


class ContactDynamics:
    """Expressions of a system of equations with all gaps open.

    Attributes
    ----------
    distance, speed, acceleration : ``g``, ``u``, ``w``
    rounding : rounding error of ``g`` from its terms, with a margin
    response : ``M⁻¹Wᵀ`` through the constraints: change of the speeds by unit impulses
    delassus : ``G``
    size : sum of the magnitudes of the terms of ``u``, plus a positive minimum
    laws : (3, gaps) ``e``, ``e_T``, ``μ``
    """

    def __init__(self, e: Equations, formulation: Formulation):
        self.equations = e
        whole = touching(e, [Phase.STICKING] * len(e.contacts))
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
        """``(t, x, p)`` → values as in ``ContactState``."""
        e = self.equations
        outputs = [self.distance, self.rounding, self.speed, self.size, self.acceleration]
        outputs += [self.delassus, self.laws]
        x = state_symbols(e)
        return ca.Function("contacts", [e.t, x, e.p], [ca.densify(f) for f in outputs])


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
    def at(cls, function: ca.Function, e: Equations, t: float, x: np.ndarray, p: np.ndarray):
        *columns, delassus, laws = (f.full() for f in function(t, x, p))
        g, rounding, u, size, w = (f.ravel() for f in columns)
        return cls(g, rounding, u, size, w, delassus, laws[0], laws[1], laws[2], slip_rows(e))

    def rubs(self, gap: int) -> bool:
        """Whether friction acts at a gap."""
        return bool(self.slips[gap]) and self.friction[gap] > 0


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
