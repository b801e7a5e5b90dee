"""Correction of positions after a step: the nearest ones with joints closed and gaps open."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.model_gaps import CLOSED
from dalembert.analysis.nonsmooth.mobility import Mobility, delassus
from dalembert.integrators.contact.contacts import Contacts, FrictionProblem, among
from dalembert.symbolic.equations import newton

SETTINGS = newton.NewtonSettings(tolerance=CLOSED, max_iterations=20, halvings=0)
"""Newton's method converges quadratically."""
SHARE = 0.1
"""Accuracy of a displacement, relative to the penetration that counts as rounding [-]."""
FARTHEST, CORRECTED = 2.0, 0.1
"""Upper limits of the correction of a position, relative to the motion in the step and to the
natural displacements; the larger one applies [-]."""
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
    travel : (n_v, 1) displacement within whose reach gaps take part at once; by default only
        penetrating gaps do, and others when they would close
    """

    def __init__(
        self, step: ContactStep, t: float, open_gaps: bool, travel: np.ndarray | None = None
    ):
        self.step_of, self.t, self.open_gaps, self.travel = step, t, open_gaps, travel
        scales = step.model.equations.scales
        self.scale = np.append(scales.rows, scales.length)

    def residual(self, x: np.ndarray) -> PositionResidual:
        value, rounding = self.step_of.smooth.open_by(self.t, x, self.step_of.p)
        gaps, deepest = None, 0.0
        counted = self.open_gaps and bool(np.isfinite(x).all())
        configuration = self.step_of.at(self.t, x)
        if counted and self.step_of.deepest(configuration) < -self.step_of.rounding:
            gaps = self.step_of.closed(configuration)
            deepest = gaps.distance.min(initial=0.0)
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
        mobility = self.step_of.smooth.at(self.t, x, self.step_of.p)[0]
        still = np.zeros(self.step_of.model.equations.speed_count)
        joint_shift, closed = mobility(still, -residual.value[:-1])[0], residual.gaps
        if closed is None or not closed.count:
            return joint_shift, None
        allowed, at = self.step_of.rounding, self.step_of.at(self.t, x)
        gaps = closed if self.travel is None else self._near(at, self.travel)
        for _ in range(ROUNDS):
            push, opened = self._push(gaps, joint_shift, mobility)
            shift = joint_shift + opened
            near = self._near(at, shift[:, None])
            closes = near.distance + near.normals @ shift < -allowed
            missing = closes & ~among(near.key, gaps.key)
            if not missing.any():
                break
            gaps = Contacts.joined([gaps, near.some(missing)])
        return shift, gaps.some((push > 0) | (gaps.distance < -allowed))

    def _near(self, at: Configuration, travels: np.ndarray) -> Contacts:
        """Gaps of rigid contacts within reach of displacements."""
        return self.step_of.rigid(self.step_of.near(at, travels))

    def _push(
        self, gaps: Contacts, joint_shift: np.ndarray, mobility: Mobility
    ) -> tuple[np.ndarray, np.ndarray]:
        """Multipliers of gaps, and the displacement that opens them in addition to
        ``joint_shift``, which closes joints."""
        normals, solver = gaps.normals, self.step_of.solver
        open_by = (gaps.distance + normals @ joint_shift)[:, None]
        fine = SHARE * self.step_of.rounding / solver.tolerance
        scale = max(float(-open_by.min(initial=0.0)), fine)
        frictionless = np.zeros((gaps.count, 0)), ()
        problem = FrictionProblem(delassus(normals, mobility), open_by, *frictionless, scale)
        push = solver.solve(problem).impulses.ravel()
        return push, mobility(normals.T @ push)[0]

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        return self.step_of.model.equations.manifold.go(x, step)


def correct_position(
    step: ContactStep,
    t: float,
    y: np.ndarray,
    open_gaps: bool,
    travel: np.ndarray | None = None,
) -> newton.Solution[np.ndarray]:
    """The nearest position with joints closed and, with ``open_gaps``, gaps open.

    Speeds do not change, so that impulses do no work here; lifted weights gain potential energy.
    """
    return newton.solve(PositionCorrection(step, t, open_gaps, travel), y, SETTINGS)


def is_far(step: ContactStep, end: np.ndarray, corrected: np.ndarray, start: np.ndarray) -> bool:
    """Whether a correction of the ``end`` of a step is larger than its motion from ``start``
    accounts for."""
    return exceeds(moved_by(step, end, corrected), moved_by(step, start, end))


def exceeds(shift: float, travel: float) -> bool:
    """Whether a correction of a position is larger than the motion in a step accounts for; both by
    the natural displacements."""
    return not shift <= max(FARTHEST * travel, CORRECTED)


def moved_by(step: ContactStep, y: np.ndarray, other: np.ndarray) -> float:
    """The largest displacement between two positions, by the natural ones."""
    displacements = step.model.equations.manifold.lead(y, other)
    return float(np.abs(displacements / step.model.scales.displacements).max(initial=0.0))


@dataclass(frozen=True)
class ConsistentSpeeds:
    """Speeds that satisfy the joints.

    Attributes
    ----------
    v : (n,)
    lost, input : kinetic energy lost, and work of moving joints in the change of speeds [J]
    """

    v: np.ndarray
    lost: float = 0.0
    input: float = 0.0


def consistent_speeds(
    step: ContactStep, t: float, y: np.ndarray, v: np.ndarray
) -> ConsistentSpeeds:
    """The nearest speeds ``v + c``, by kinetic energy, with ``C (v + c) = −Φ_t``.

    Kinetic energy changes by ``cᵀM(v + c) − cᵀM c/2``: the work of moving joints, and a loss.
    """
    mobility, _, still, joints = step.smooth.at(t, y, step.p)
    change = mobility(np.zeros(v.size), -still - joints @ v)[0]
    momentum, after = mobility.matrix @ change, v + change
    return ConsistentSpeeds(after, float(momentum @ change) / 2, float(momentum @ after))
