"""Projective elimination (5.13–5.14): dynamics tangential and normal to the constraints.

⎡Dᵀ M⎤     ⎡Dᵀ r₁⎤
⎣ C  ⎦ x = ⎣ r₂  ⎦,    C D = 0,    then  Cᵀ z = r₁ − M x
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.errors import SingularityError, UnsupportedError
from dalembert.formulations.base import Formulation, SaddleSolver
from dalembert.formulations.orthogonal_bases import (
    GramSchmidtBasis,
    HouseholderBasis,
    SingularValueBasis,
)
from dalembert.formulations.partition import best_partition, largest_ratio
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.inertia import Inertia
from dalembert.options import options
from dalembert.symbolic.equations.factor import LdlFactor, NullSpaceBasis, PartitionBasis

LARGEST_SVD = 12
"""Upper limit of the number of speeds for ``basis="svd"``."""
NOT_CONVERGED = 1e-11
"""Threshold of the orthogonality error above which the Jacobi rotations have not converged [-]."""


class NullSpaceSolver(SaddleSolver):
    """``x = D x' + x₂`` with ``C x₂ = r₂`` and ``DᵀM D x' = Dᵀ(r₁ − M x₂)`` (5.13–5.14)."""

    def __init__(self, inertia: Inertia, basis: NullSpaceBasis):
        self.speed_count = inertia.size
        self.inertia, self.basis, self.d = inertia, basis, basis.matrix
        self.factor = LdlFactor(ca.mtimes(self.d.T, inertia.times(self.d)))

    def solve(self, r1: ca.SX, r2: ca.SX) -> tuple[ca.SX, ca.SX]:
        normal = self.basis.particular(r2)
        tangential = self.factor.solve(ca.mtimes(self.d.T, r1 - self.inertia.times(normal)))
        x = ca.mtimes(self.d, tangential) + normal
        return x, self.basis.multipliers(r1 - self.inertia.times(x))


PARTITIONED: dict[str, Callable[[ca.SX, tuple[int, ...]], NullSpaceBasis]] = {
    "partitioning": PartitionBasis,
    "gram-schmidt": GramSchmidtBasis,
}
"""Bases that depend on a choice of independent speeds."""
ORTHOGONAL: dict[str, Callable[[ca.SX], NullSpaceBasis]] = {
    "qr": HouseholderBasis,
    "svd": SingularValueBasis,
}


@options
class NullSpace(Formulation):
    """Project onto the motions that the constraints permit and onto their complement (5.13–5.14).

    Parameters
    ----------
    basis : ``"partitioning"`` of the speeds, ``"qr"`` (Householder), ``"gram-schmidt"`` or
        ``"svd"`` (Jacobi; up to 12 speeds)
    limit : largest dependent speed per independent one, in units of energy, before the run
        chooses other independent speeds

    Raises
    ------
    UnsupportedError
        Unknown basis, or a limit that no choice can satisfy.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -10))
    >>> bar = system.add(planar.Bar("bar", length=1.5, mass=2.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, bar.start))
    >>> model = system.build()
    >>> motion = da.solve_dynamics(model, 0.1, step=0.1, formulation=da.NullSpace(basis="qr"))
    >>> round(motion["bar.angular_acceleration"][0].item(), 6)  # -3 g/(2 l)
    -10.0
    """

    basis: str = "partitioning"
    limit: float = 100.0

    def __post_init__(self) -> None:
        names = [*PARTITIONED, *ORTHOGONAL]
        if self.basis not in names:
            raise UnsupportedError(
                f"NullSpace(basis={self.basis!r}): known bases are {', '.join(names)}"
            )
        if not self.limit >= 2:
            raise UnsupportedError(f"NullSpace(limit={self.limit}): must be at least 2")

    def choose(self, e: Equations, t: float, y: np.ndarray, p: np.ndarray) -> Formulation:
        if self.basis in PARTITIONED:
            return PartitionedNullSpace(self.basis, self.limit, best_partition(e, t, y, p))
        if self.basis == "svd":
            _check_convergence(e, t, y, p)
        return self

    def conditioning(self, e: Equations) -> tuple[ca.SX, float] | None:
        return (_orthogonality_error(e), NOT_CONVERGED) if self.basis == "svd" else None

    def solver(
        self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]
    ) -> NullSpaceSolver:
        if self.basis in PARTITIONED:
            raise UnsupportedError(
                f"NullSpace(basis={self.basis!r}): which speeds are independent depends on the "
                "position; call choose(equations, t, y, p) first"
            )
        if self.basis == "svd":
            _check_size(inertia.size)
        return NullSpaceSolver(inertia, ORTHOGONAL[self.basis](jacobian))


@dataclass(frozen=True)
class PartitionedNullSpace(NullSpace):
    """A basis for chosen independent speeds (6.4), the result of ``NullSpace.choose``.

    Parameters
    ----------
    independent : their indices in v
    """

    independent: tuple[int, ...] = ()

    def conditioning(self, e: Equations) -> tuple[ca.SX, float]:
        return largest_ratio(e, self.independent), self.limit

    def solver(
        self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]
    ) -> NullSpaceSolver:
        return NullSpaceSolver(inertia, PARTITIONED[self.basis](jacobian, self.independent))


def _check_size(n: int) -> None:
    if n > LARGEST_SVD:
        raise UnsupportedError(
            f"NullSpace(basis='svd') writes out about {40 * n**3} operations for {n} speeds; "
            f"use it up to {LARGEST_SVD}, and NullSpace(basis='qr') beyond"
        )


def _orthogonality_error(e: Equations) -> ca.SX:
    """Orthogonality error: largest entry of C D relative to C, and of C C⁺ − I."""
    _check_size(e.speed_count)
    c, m = e.jacobian, e.constraint_count
    basis = SingularValueBasis(c)
    tangential = ca.mtimes(c, basis.matrix) / ca.norm_fro(c) if m else ca.SX(0, 1)
    normal = ca.mtimes(c, basis.particular(ca.SX.eye(m))) - ca.SX.eye(m)
    errors = ca.vertcat(ca.vec(tangential), ca.vec(normal))
    return ca.norm_inf(errors) if errors.numel() else ca.SX(0)


def _check_convergence(e: Equations, t: float, y: np.ndarray, p: np.ndarray) -> None:
    value = float(ca.Function("orthogonal", [e.t, e.y, e.p], [_orthogonality_error(e)])(t, y, p))
    if not value <= NOT_CONVERGED:
        raise SingularityError(
            f"NullSpace(basis='svd'): the rotations left C D = {value:.1e} at t = {t:.9g} s; "
            "use NullSpace(basis='qr')"
        )
