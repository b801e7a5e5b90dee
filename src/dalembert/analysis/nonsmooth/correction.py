"""Correction of positions after a step: the nearest ones with joints closed and gaps open."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import CLOSED, ContactStep
from dalembert.analysis.nonsmooth.smooth_motion import Solve
from dalembert.integrators.contact.contacts import Contacts, FrictionProblem
from dalembert.symbolic.equations import newton
from dalembert.symbolic.evaluation.kernel import Matrix, dense_array

SETTINGS = newton.NewtonSettings(tolerance=CLOSED, max_iterations=20, halvings=0)
"""Newton's method converges quadratically."""
ROUNDS = 20
"""Upper limit of the number of times that further gaps join the correction."""


@dataclass(frozen=True)
class PositionResidual(newton.Residual):
    """Residuals of the joints and, in one more row, the deepest penetration.

    Attributes
    ----------
    gaps : penetrating gaps
    """

    gaps: Contacts | None = field(kw_only=True)


class PositionCorrection(newton.Equations[np.ndarray]):
    """``Φ = 0`` and ``g ≥ 0`` at an instant: ``δ = M⁻¹(Wᵀ P − Cᵀ λ)``, ``P ≥ 0``.

    Parameters
    ----------
    step : ContactStep
    t : the instant [s]
    open_gaps : whether gaps count, too
    """

    def __init__(self, step: ContactStep, t: float, open_gaps: bool):
        self.step_of, self.t, self.open_gaps = step, t, open_gaps
        scales = step.model.equations.scales
        self.scale = np.append(scales.rows, scales.length)

    def residual(self, x: np.ndarray) -> PositionResidual:
        value, rounding = self.step_of.smooth.open_by(self.t, x, self.step_of.p)
        gaps = None
        if self.open_gaps and np.isfinite(x).all():
            gaps = self.step_of.closed(self.t, x)
        deepest = 0.0 if gaps is None else gaps.distance.min(initial=0.0)
        return PositionResidual(
            np.append(value, deepest), self.scale, np.append(rounding, 0.0), gaps=gaps
        )

    def step(self, x: np.ndarray, residual: newton.Residual) -> np.ndarray:
        assert isinstance(residual, PositionResidual)
        return self.shift(x, residual)[0]

    def shift(
        self, x: np.ndarray, residual: PositionResidual
    ) -> tuple[np.ndarray, Contacts | None]:
        """The displacement, and the gaps involved: penetrating ones, and those that the
        displacement would close, such as the next ones in a stack."""
        solve = self.step_of.smooth.at(self.t, x, self.step_of.p)[0]
        still = np.zeros(self.step_of.model.equations.speed_count)
        joint_shift, gaps = solve(still, -residual.value[:-1])[0], residual.gaps
        if gaps is None or not gaps.count:
            return joint_shift, None
        allowed = CLOSED * self.step_of.model.scales.length
        for _ in range(ROUNDS):
            shift = joint_shift + self._gap_shift(gaps, joint_shift, solve)
            near = self.step_of.near(self.t, x, shift[:, None])
            closes = near.distance + normals_of(near) @ shift < -allowed
            if np.isin(near.key[closes], gaps.key).all():
                break
            gaps = near.some(np.isin(near.key, gaps.key) | closes)
        return shift, gaps

    def _gap_shift(self, gaps: Contacts, joint_shift: np.ndarray, solve: Solve) -> np.ndarray:
        """Displacement that opens gaps, in addition to ``joint_shift``, which closes joints."""
        normals = normals_of(gaps)
        response = solve(dense_array(normals).T, None)[0]
        open_by = (gaps.distance + normals @ joint_shift)[:, None]
        scale = float(np.abs(open_by).max())
        problem = FrictionProblem(normals @ response, open_by, np.zeros(gaps.count), scale)
        return response @ self.step_of.solver.solve(problem).impulses.ravel()

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        return self.step_of.model.equations.manifold.go(x, step)


def normals_of(gaps: Contacts) -> Matrix:
    """Rows of ``W`` along the normals."""
    return gaps.directions[np.arange(gaps.count) * gaps.drift.shape[1]]


def correct_position(
    step: ContactStep, t: float, y: np.ndarray, open_gaps: bool
) -> newton.Solution[np.ndarray]:
    """The nearest position with joints closed and, with ``open_gaps``, gaps open.

    Speeds do not change, so that impulses do no work here; lifted weights gain potential energy.
    """
    return newton.solve(PositionCorrection(step, t, open_gaps), y, SETTINGS)


def consistent_speeds(step: ContactStep, t: float, y: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The nearest speeds, by kinetic energy, with ``C v = −Φ_t``."""
    solve, _, still, joints = step.smooth.at(t, y, step.p)
    return v + solve(np.zeros(v.size), -still - joints @ v)[0]
