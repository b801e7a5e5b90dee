"""Positions opened after a step: joints closed and gaps open, along the shortest way by inertia."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import CLOSED, ContactStep
from dalembert.analysis.nonsmooth.smooth_motion import Solve
from dalembert.integrators.contact.contacts import Contacts
from dalembert.integrators.contact.friction_problem import FrictionProblem
from dalembert.symbolic.equations import newton
from dalembert.symbolic.evaluation.kernel import Matrix, dense_array

OPENED = newton.NewtonSettings(tolerance=CLOSED, max_iterations=20, halvings=0)
"""What is left is squared by every step."""
ROUNDS = 20
"""Times that a shift may close further gaps, which are then counted in."""


@dataclass(frozen=True)
class Left(newton.Residual):
    """What is left of joints, and, in one more row, of the deepest gap.

    Attributes
    ----------
    gaps : those that are closed
    """

    gaps: Contacts | None = field(kw_only=True)


class Opening(newton.Equations[np.ndarray]):
    """``Φ = 0`` and ``g ≥ 0`` at an instant: ``δ = M⁻¹(Wᵀ P − Cᵀ λ)``, ``P ≥ 0``.

    Parameters
    ----------
    step : ContactStep
    t : the instant [s]
    open_gaps : gaps count beside joints
    """

    def __init__(self, step: ContactStep, t: float, open_gaps: bool):
        self.step_of, self.t, self.open_gaps = step, t, open_gaps
        scales = step.model.equations.scales
        self.scale = np.append(scales.rows, scales.length)

    def residual(self, x: np.ndarray) -> Left:
        value, rounding = self.step_of.smooth.open_by(self.t, x, self.step_of.p)
        gaps = None
        if self.open_gaps and np.isfinite(x).all():
            gaps = self.step_of.closed(self.t, x)
        deepest = 0.0 if gaps is None else gaps.distance.min(initial=0.0)
        return Left(np.append(value, deepest), self.scale, np.append(rounding, 0.0), gaps=gaps)

    def step(self, x: np.ndarray, residual: newton.Residual) -> np.ndarray:
        assert isinstance(residual, Left)
        return self.shift(x, residual)[0]

    def shift(self, x: np.ndarray, residual: Left) -> tuple[np.ndarray, Contacts | None]:
        """The displacement, and the gaps that are counted in: those closed, and those it would
        close, such as the next ones in a stack."""
        solve = self.step_of.smooth.at(self.t, x, self.step_of.p)[0]
        still = np.zeros(self.step_of.model.equations.speed_count)
        joined, gaps = solve(still, -residual.value[:-1])[0], residual.gaps
        if gaps is None or not gaps.count:
            return joined, None
        allowed = CLOSED * self.step_of.model.scales.length
        for _ in range(ROUNDS):
            shift = joined + self._opened(gaps, joined, solve)
            near = self.step_of.near(self.t, x, shift[:, None])
            closes = near.distance + normals_of(near) @ shift < -allowed
            if np.isin(near.key[closes], gaps.key).all():
                break
            gaps = near.some(np.isin(near.key, gaps.key) | closes)
        return shift, gaps

    def _opened(self, gaps: Contacts, joined: np.ndarray, solve: Solve) -> np.ndarray:
        """Displacement by which some gaps open, beside that which closes joints."""
        normals = normals_of(gaps)
        way = solve(dense_array(normals).T, None)[0]
        open_by = (gaps.distance + normals @ joined)[:, None]
        scale = float(np.abs(open_by).max())
        problem = FrictionProblem(normals @ way, open_by, np.zeros(gaps.count), scale)
        return way @ self.step_of.solver.solve(problem).impulses.ravel()

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        return self.step_of.model.equations.manifold.go(x, step)


def normals_of(gaps: Contacts) -> Matrix:
    """Rows of ``W`` along the normals."""
    return gaps.directions[np.arange(gaps.count) * gaps.drift.shape[1]]


def corrected(
    step: ContactStep, t: float, y: np.ndarray, open_gaps: bool
) -> newton.Solution[np.ndarray]:
    """The nearest position with joints closed and, if asked for, gaps open.

    Speeds are left alone, so that no impulse does work here; weights that are lifted keep what
    that takes.
    """
    return newton.solve(Opening(step, t, open_gaps), y, OPENED)


def consistent(step: ContactStep, t: float, y: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The nearest speeds, by kinetic energy, with ``C v = −Φ_t``."""
    solve, _, still, joints = step.smooth.at(t, y, step.p)
    return v + solve(np.zeros(v.size), -still - joints @ v)[0]
