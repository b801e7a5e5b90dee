"""The contact-free part of a time step: forces, inertia and joints."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import scipy

from dalembert.errors import SingularityError, UnsupportedError
from dalembert.model.graph.assembly.assembly import ROUNDING
from dalembert.model.graph.model import Model
from dalembert.sparse.factorise import general_factors
from dalembert.symbolic.evaluation.kernel import Kernel, Matrix, Patterned

Solve = Callable[[np.ndarray, np.ndarray | None], tuple[np.ndarray, np.ndarray]]
"""``(right side of the speeds, of the joints or None) → (speeds, multipliers)``."""


class SmoothMotion:
    """Functions of a model for steps by the θ-method,

        (M − h θ D − h² θ² K)(v⁺ − v) = h F − Cᵀ Λ,      C (σ v⁺ + (1−σ) v) = −Φ_t

    with ``F = f − d``, ``D = ∂F/∂v``, ``K = (∂F/∂y) A`` at ``y ⊕ θ h v``, ``v``; for linear forces
    this is the θ-method itself. ``C`` and ``Φ_t`` are taken at ``y ⊕ σ h v``, ``σ = max(θ, 1/2)``:
    with constraints on the speeds at the end alone the centripetal forces within the step are lost.

    Parameters
    ----------
    model : Model
    """

    def __init__(self, model: Model):
        e = model.equations
        driving = ca.densify(e.force - e.bias)
        unknown = ca.vertcat(e.a, e.multiplier, e.dropped)
        if ca.depends_on(driving, unknown):
            raise UnsupportedError(
                "a force depends on reactions or accelerations (e.g. friction in a joint), which "
                "solve_nonsmooth cannot evaluate before the step; use solve_dynamics"
            )
        inputs_at_position = [e.t, e.y, e.p]
        still = ca.substitute(e.velocity_constraints, e.v, ca.SX.zeros(e.speed_count))
        damping, stiffness = ca.jacobian(driving, e.v), e.by_displacement(driving)
        inputs = [e.t, e.y, e.v, e.p]
        self._forces = Patterned("forces", inputs, [driving, damping, stiffness])
        self._mass = Patterned("mass", [e.y, e.p], [e.mass])
        magnitudes = ca.mtimes(ca.fabs(e.lift).T, ca.fabs(e.y))
        rounding = ROUNDING * ca.mtimes(ca.fabs(e.position_jacobian), magnitudes)
        joints = [e.jacobian, still, e.constraints, ca.densify(rounding)]
        self._joints = Patterned("joints", inputs_at_position, joints)
        self.powers = Kernel(
            ca.Function("powers", [e.t, e.y, e.v, e.a, e.multiplier, e.p], [ca.densify(e.powers)])
        )
        self._reacts = ca.sparsify(ca.horzcat(damping, stiffness)).nnz() > 0
        self.has_joints, self._go = e.constraint_count > 0, e.manifold.go

    def step(
        self, t: float, y: np.ndarray, v: np.ndarray, p: np.ndarray, h: float, theta: float
    ) -> tuple[np.ndarray, np.ndarray, Solve]:
        """Speeds at the end without impulses, multipliers times ``h``, and the solver of the
        step."""
        fraction = constrained_fraction(theta)
        middle, between = self._go(y, theta * h * v), self._go(y, fraction * h * v)
        force, damping, stiffness = self._forces(t + theta * h, middle, v, p)
        mass = self._mass(middle, p)[0]
        matrix = mass
        if self._reacts:
            matrix = mass - h * theta * damping - (h * theta) ** 2 * stiffness
        joints, still = self._joints(t + fraction * h, between, p)[:2]
        solve = solver(matrix, joints)
        change, multiplier = solve(h * force, -(still + joints @ v) / fraction)
        return v + change, multiplier, solve

    def open_by(self, t: float, y: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """``Φ``, and its rounding error."""
        open_by, rounding = self._joints(t, y, p)[2:]
        return open_by, rounding

    def at(
        self, t: float, y: np.ndarray, p: np.ndarray
    ) -> tuple[Solve, np.ndarray, np.ndarray, Matrix]:
        """Solver with ``M`` and ``C`` at a position, ``Φ``, ``Φ_t`` and ``C``."""
        joints, still, open_by = self._joints(t, y, p)[:3]
        return solver(self._mass(y, p)[0], joints), open_by, still, joints


def constrained_fraction(theta: float) -> float:
    """``σ``, the fraction of a step at which interpolated speeds satisfy the joints."""
    return max(theta, 0.5)


def solver(matrix: Matrix, joints: Matrix) -> Solve:
    """Solver of ``A x + Cᵀ λ = r``, ``C x = s``, for one or many right-hand sides.

    Raises
    ------
    SingularityError
        The matrix has no inverse.
    """
    m, n = joints.shape
    if not m and (diagonal := _diagonal(matrix)) is not None:
        return lambda right, _: ((right.T / diagonal).T, np.zeros((0, *right.shape[1:])))
    try:
        factors = general_factors(_saddle(matrix, joints))
    except np.linalg.LinAlgError:
        text = "inertia and joints of a step have no solution; look for a singular position"
        raise SingularityError(text) from None

    def solve(right: np.ndarray, below: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
        right_below = np.zeros((m, *right.shape[1:])) if below is None else below
        solution = factors.solve(np.concatenate([right, right_below]))
        return solution[:n], solution[n:]

    return solve


def _diagonal(matrix: Matrix) -> np.ndarray | None:
    """The diagonal of a diagonal matrix; None for any other matrix."""
    diagonal = matrix.diagonal()
    entries = matrix.count_nonzero() if scipy.sparse.issparse(matrix) else np.count_nonzero(matrix)
    return diagonal if np.all(diagonal) and entries == diagonal.size else None


def _saddle(matrix: Matrix, joints: Matrix) -> Matrix:
    """``[[A, Cᵀ], [C, 0]]``."""
    m, n = joints.shape
    if scipy.sparse.issparse(matrix) or scipy.sparse.issparse(joints):
        blocks = [[matrix, joints.T], [joints, None]] if m else [[matrix]]
        return scipy.sparse.block_array(blocks, format="csc")
    whole = np.zeros((n + m, n + m))
    whole[:n, :n], whole[n:, :n], whole[:n, n:] = matrix, joints, joints.T
    return whole
