"""Minimal equations by partitioning the speeds (6.4–6.8).

    v = [u; w],    C = [U W],    w = −W⁻¹(U u + Φ_t),    DᵀM D u̇ = Dᵀ(f − d − M γ)

The state consists of y and u: all speeds are computed from u wherever they are used, so that the
velocity constraints hold to round-off and only the position constraints can be violated.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from dalembert.errors import SingularityError, UnsupportedError
from dalembert.formulations.base import Formulation, Level, SaddleSolver
from dalembert.formulations.null_space import NullSpaceSolver
from dalembert.formulations.partition import best_partition, largest_ratio, scaled_ratios
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.inertia import Inertia
from dalembert.options import options
from dalembert.symbolic.equations.factor import PartitionBasis
from dalembert.symbolic.equations.implicit import Stage
from dalembert.symbolic.equations.semi_explicit import SemiExplicit
from dalembert.text.wording import similar

SMALLEST_LIMIT = 1.1
LIMIT = 1.5
"""Default limit: errors of rotating mechanisms are no larger than with all speeds as states."""
LIMIT_OF_NAMED = 50.0
"""Default limit for independent speeds chosen by name."""


@options
class VelocityPartitioning(Formulation):
    """Integration of as many speeds as there are degrees of freedom (6.8).

    Parameters
    ----------
    independent : names of the coordinates with independent speeds; None for an automatic choice
        the best conditioned ones, monitor them and exchange them
    limit : largest dependent speed per independent one, in units of energy, ``√(m_ii/m_jj)
        |W⁻¹U|_ij``, before the run chooses others (None: 1.5), or upper limit for named ones
        (None: 50)

    Raises
    ------
    UnsupportedError
        A limit that no choice can satisfy; in a run: unknown names, wrong number, Baumgarte.
    SingularityError
        Named speeds that do not determine the others at a position of the run.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -10))
    >>> bar = system.add(planar.Bar("bar", length=1.5, mass=2.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, bar.start))
    >>> turn = da.VelocityPartitioning(independent=("bar.angle",))
    >>> motion = da.solve_dynamics(system.build(), 0.1, step=0.1, formulation=turn)
    >>> round(motion["bar.ay"][0].item(), 6)  # its centre: -3/4 g
    -7.5
    """

    independent: tuple[str, ...] | None = None
    limit: float | None = None

    def __post_init__(self) -> None:
        if self.independent is not None:
            independent = self.independent
            names = (independent,) if isinstance(independent, str) else tuple(independent)
            object.__setattr__(self, "independent", names)
        if self.limit is not None and not self.limit >= SMALLEST_LIMIT:
            raise UnsupportedError(
                f"VelocityPartitioning(limit={self.limit}): must be at least {SMALLEST_LIMIT}"
            )

    @property
    def refuses_feedback(self) -> str:
        return (
            "VelocityPartitioning keeps the velocity constraints exactly and leaves Baumgarte "
            "nothing to act on; use stabilization=Projection() or Stabilization()"
        )

    def choose(self, e: Equations, t: float, y: np.ndarray, p: np.ndarray) -> Formulation:
        if self.independent is None:
            return IndependentSpeeds(best_partition(e, t, y, p), self.limit or LIMIT)
        indices, limit = indices_of(e, self.independent), self.limit or LIMIT_OF_NAMED
        check_independent(e, indices, limit, t, y, p)
        return IndependentSpeeds(indices, limit)

    def solver(
        self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]
    ) -> NullSpaceSolver:
        raise UnsupportedError(
            "VelocityPartitioning: which speeds are independent depends on the position; "
            "call choose(equations, t, y, p) first"
        )


@dataclass(frozen=True)
class IndependentSpeeds(Formulation):
    """Velocity partitioning (6.8) for chosen independent speeds.

    Parameters
    ----------
    indices : of the independent speeds in v
    limit : upper limit of the dependent speeds per independent one, before others are chosen
    """

    indices: tuple[int, ...]
    limit: float

    def solver(
        self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]
    ) -> NullSpaceSolver:
        return NullSpaceSolver(inertia, PartitionBasis(jacobian, self.indices))

    @property
    def exact_levels(self) -> frozenset[Level]:
        return frozenset({Level.SPEED, Level.ACCELERATION})

    def conditioning(self, e: Equations) -> tuple[ca.SX, float]:
        return largest_ratio(e, self.indices), self.limit

    def consistent_speeds(self, e: Equations) -> Stage:
        """``Ψ(y, v_c) = 0`` with ``S(v_c − v) = 0``; S selects the independent speeds."""
        basis, chosen = PartitionBasis(e.jacobian, self.indices), list(self.indices)
        m = e.constraint_count
        speeds = ca.SX.sym("v_c", e.speed_count)
        psi = e.velocity_constraints
        imposed = ca.substitute(psi, e.v, ca.SX.zeros(e.speed_count))
        residual = ca.vertcat(ca.substitute(psi, e.v, speeds), speeds[chosen, :] - e.v[chosen, :])

        def transposed(rhs: ca.SX) -> ca.SX:
            multipliers = basis.multipliers(rhs)
            return ca.vertcat(multipliers, rhs[chosen, :] - ca.mtimes(basis.u.T, multipliers))

        return Stage(
            speeds,
            residual,
            basis.completed(e.v[chosen, :], -imposed),
            lambda rhs: basis.completed(rhs[m:, :], rhs[:m, :]),
            transposed,
        )

    def semi_explicit(
        self, e: Equations, xi: ca.SX, saddle: SaddleSolver | None = None
    ) -> SemiExplicit:
        """Index-1 form with the consistent speeds as further algebraic variables."""
        plain, speeds = super().semi_explicit(e, xi, saddle), self.consistent_speeds(e)
        xi_start, outputs = e.constraint_acceleration, [ca.vertcat(plain.z, e.v)]
        start = self.acceleration(e, xi_start, outputs, "algebraic_start", saddle)
        rate, algebraic = ca.substitute([plain.rate, plain.algebraic], [e.v], [speeds.unknown])
        zeros, natural = (0,) * e.speed_count, e.scales
        added = np.concatenate([natural.rows / natural.time, natural.speeds[list(self.indices)]])
        sizes = replace(
            plain.sizes,
            algebraic=np.concatenate([plain.sizes.algebraic, natural.speeds]),
            rows=np.concatenate([plain.sizes.rows, added]),
        )
        return replace(
            plain,
            z=ca.vertcat(plain.z, speeds.unknown),
            rate=rate,
            algebraic=ca.vertcat(algebraic, speeds.residual),
            depth=plain.depth + zeros,
            lag=plain.lag + zeros,
            start=start,
            sizes=sizes,
        )


def _names(e: Equations) -> list[str]:
    """Names of the coordinates on a flat manifold, otherwise of the speeds."""
    symbols = e.y if e.manifold.flat else e.v
    return [symbol.name() for symbol in ca.vertsplit(symbols)]


def indices_of(e: Equations, names: tuple[str, ...]) -> tuple[int, ...]:
    """Indices in v of the speeds of named coordinates.

    Raises
    ------
    UnsupportedError
        An unknown name, or a number of names that differs from the degrees of freedom.
    """
    available, needed = _names(e), e.speed_count - e.constraint_count
    for name in names:
        if name not in available:
            close = similar(name, available) or available
            raise UnsupportedError(
                f"VelocityPartitioning: no coordinate {name!r}; nearest: {', '.join(close)}"
            )
    indices = tuple(sorted({available.index(name) for name in names}))
    if len(indices) != needed:
        raise UnsupportedError(
            f"VelocityPartitioning(independent={names}): {needed} independent speeds are needed, "
            f"{len(indices)} are named"
        )
    return indices


def check_independent(
    e: Equations,
    indices: tuple[int, ...],
    limit: float,
    t: float,
    y: np.ndarray,
    p: np.ndarray,
) -> None:
    """Check that no dependent speed exceeds the chosen ones by more than the limit.

    Raises
    ------
    SingularityError
        Names the largest dependent speed and its ratio, in units of energy.
    """
    ratios = ca.Function("ratios", [e.t, e.y, e.p], [ca.densify(scaled_ratios(e, indices))])
    size = np.abs(ratios(t, y, p).full())
    if not size.size or np.all(size <= limit):
        return
    names = _names(e)
    if np.all(np.isfinite(size)):
        row, column = np.unravel_index(np.argmax(size), size.shape)
        independent = names[indices[column]]
        dependent = names[[k for k in range(e.speed_count) if k not in indices][row]]
        reason = (
            f"{dependent} is {size[row, column]:.3g} times as fast as {independent} in units of "
            f"energy (limit {limit:g})"
        )
    else:
        chosen = ", ".join(names[k] for k in indices)
        reason = f"{chosen} do not determine the other speeds, det W = 0"
    raise SingularityError(
        f"VelocityPartitioning: at t = {t:.9g} s {reason}; name other coordinates, or leave "
        "independent=None for an automatic choice"
    )
