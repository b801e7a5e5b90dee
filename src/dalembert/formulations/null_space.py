"""Projective elimination (5.13–5.14): the dynamic equations along and across the constraints.

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
from dalembert.formulations.orthogonal import GramSchmidtBasis, HouseholderBasis
from dalembert.formulations.partition import best_partition, largest_ratio
from dalembert.formulations.singular_values import SingularValueBasis
from dalembert.model.equations import Equations
from dalembert.model.inertia import Inertia
from dalembert.options import options
from dalembert.symbolic.equations.factor import LdlFactor
from dalembert.symbolic.equations.null_space import NullSpaceBasis, PartitionBasis

LARGEST_SVD = 12
NOT_CONVERGED = 1e-11


class NullSpaceSolver(SaddleSolver):
    """``x = D x' + x₂`` with ``C x₂ = r₂`` and ``DᵀM D x' = Dᵀ(r₁ − M x₂)`` (5.13–5.14)."""

    def __init__(self, inertia: Inertia, basis: NullSpaceBasis):
        self.speed_count = inertia.size
        self.inertia, self.basis, self.d = inertia, basis, basis.matrix
        self.factor = LdlFactor(ca.mtimes(self.d.T, inertia.times(self.d)))

    def solve(self, r1: ca.SX, r2: ca.SX) -> tuple[ca.SX, ca.SX]:
        across = self.basis.particular(r2)
        along = self.factor.solve(ca.mtimes(self.d.T, r1 - self.inertia.times(across)))
        x = ca.mtimes(self.d, along) + across
        return x, self.basis.multipliers(r1 - self.inertia.times(x))


PARTITIONED: dict[str, Callable[[ca.SX, tuple[int, ...]], NullSpaceBasis]] = {
    "partitioning": PartitionBasis,
    "gram-schmidt": GramSchmidtBasis,
}
"""Bases that lean on a choice of independent speeds."""
ORTHOGONAL: dict[str, Callable[[ca.SX], NullSpaceBasis]] = {
    "qr": HouseholderBasis,
    "svd": SingularValueBasis,
}


@options
class NullSpace(Formulation):
    """Project onto the motions that the constraints permit and onto the rest (5.13–5.14).

    Parameters
    ----------
    basis : ``"partitioning"`` of the speeds, ``"qr"`` (Householder), ``"gram-schmidt"`` or
        ``"svd"`` (Jacobi; up to 12 speeds)
    limit : largest dependent speed per independent one, in units of energy, before the run
        chooses other independent speeds

    Raises
    ------
    UnsupportedError
        Unknown basis, or a limit that no choice can keep.

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
        known = [*PARTITIONED, *ORTHOGONAL]
        if self.basis not in known:
            raise UnsupportedError(
                f"NullSpace(basis={self.basis!r}): known bases are {', '.join(known)}"
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
        return (_not_orthogonal(e), NOT_CONVERGED) if self.basis == "svd" else None

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
    """A basis with definite independent speeds (6.4), as ``NullSpace.choose`` makes it.

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


def _not_orthogonal(e: Equations) -> ca.SX:
    """Largest entry of C D relative to C, and of C C⁺ − I."""
    _check_size(e.speed_count)
    c, m = e.jacobian, e.constraint_count
    basis = SingularValueBasis(c)
    along = ca.mtimes(c, basis.matrix) / ca.norm_fro(c) if m else ca.SX(0, 1)
    across = ca.mtimes(c, basis.particular(ca.SX.eye(m))) - ca.SX.eye(m)
    both = ca.vertcat(ca.vec(along), ca.vec(across))
    return ca.norm_inf(both) if both.numel() else ca.SX(0)


def _check_convergence(e: Equations, t: float, y: np.ndarray, p: np.ndarray) -> None:
    value = float(ca.Function("orthogonal", [e.t, e.y, e.p], [_not_orthogonal(e)])(t, y, p))
    if not value <= NOT_CONVERGED:
        raise SingularityError(
            f"NullSpace(basis='svd'): the rotations left C D = {value:.1e} at t = {t:.9g} s; "
            "use NullSpace(basis='qr')"
        )
