"""Choice of independent speeds and constraint equations (6.4), and corrections consistent with it.

With ``C = [U W]`` the dependent speeds are ``−W⁻¹U u``. Speeds are scaled by ``√m_kk``, so that
metres and radians are compared by kinetic energy. The independent ones are chosen so that no
dependent speed exceeds them: ``|W⁻¹U| ≤ 1`` in these units.

If ``C`` has more rows than its rank, some rows S are solved and the others follow,
``C_R = W C_S``: round-off of S appears in the others multiplied by ``W``. As the mechanism moves
``W`` changes, and rows that were independent at the start need not stay so. The best rows have
``|W| ≤ 1``, with angles and lengths in natural units.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import scipy

from dalembert.errors import SingularityError
from dalembert.formulations.base import Formulation, state_symbols
from dalembert.model.graph.equations import Equations
from dalembert.symbolic.equations.factor import LdlFactor, PartitionBasis
from dalembert.symbolic.equations.implicit import ImplicitFunction, Solver, Stage

MASSLESS = 1e-6
"""Substitute for a zero mass, in natural units: such a speed is independent only if it must."""
BEST = 1.01
"""Threshold of the largest coefficient at which the exchange of rows stops."""
ALIKE = 1 + 1e-6
"""Ratio of coefficients below which they count as equal."""
SINGULAR = 1e-6
"""Threshold of the smallest singular value below which rows are dependent [-]."""


def speed_weights(e: Equations) -> ca.SX:
    """``√m_kk`` (n,)."""
    mass, missing, natural = ca.densify(ca.diag(e.mass)), list(e.massless), e.scales
    mass[missing] = MASSLESS * natural.mass * (natural.length / natural.displacements[missing]) ** 2
    return ca.sqrt(mass)


def scaled_ratios(e: Equations, independent: tuple[int, ...]) -> ca.SX:
    """``W⁻¹U`` (m, n − m) in units of energy, an expression of t, y, p."""
    basis, weight = PartitionBasis(e.jacobian, independent), speed_weights(e)
    scaled = ca.mtimes(ca.diag(weight[basis.dependent]), basis.ratio)
    return ca.mtimes(scaled, ca.diag(1 / weight[basis.independent]))


def largest_ratio(e: Equations, independent: tuple[int, ...]) -> ca.SX:
    """Largest entry of ``|W⁻¹U|`` in units of energy; at most one for the best choice."""
    ratios = scaled_ratios(e, independent)
    return ca.norm_inf(ca.vec(ratios)) if ratios.numel() else ca.SX(0)


def best_partition(e: Equations, t: float, y: np.ndarray, p: np.ndarray) -> tuple[int, ...]:
    """Indices of the independent speeds at a position.

    Raises
    ------
    SingularityError
        The constraint equations have no finite value at this position.
    """
    n, m = e.speed_count, e.constraint_count
    if not 0 < m < n:
        return tuple(range(n)) if m == 0 else ()
    evaluate = ca.Function("C", [e.t, e.y, e.p], [ca.densify(e.jacobian), speed_weights(e)])
    jacobian, weight = (out.full() for out in evaluate(t, y, p))
    if not (np.all(np.isfinite(jacobian)) and np.all(weight > 0)):
        raise SingularityError(
            f"no independent speeds can be chosen at t = {t:.9g} s: the constraint equations or "
            "masses have no usable value there; use formulation=RangeSpace()"
        )
    rows = np.linalg.qr((jacobian / weight.T).T, mode="complete")[0][:, m:]
    return largest_volume(rows)


def largest_volume(basis: np.ndarray, first: tuple[int, ...] = ()) -> tuple[int, ...]:
    """Rows of a (n, k) matrix whose combinations with coefficients up to one give all others.

    Among equivalent choices the rows in ``first`` are preferred, then those with the lowest
    indices, so that the choice does not depend on round-off.
    """
    k = basis.shape[1]
    chosen = np.array(first)
    if chosen.size != k or np.linalg.svd(basis[chosen], compute_uv=False)[-1] < SINGULAR:
        chosen = scipy.linalg.qr(basis.T, mode="economic", pivoting=True)[2][:k]
    for _ in range(100 * k):
        coefficients = np.abs(np.linalg.solve(basis[chosen].T, basis.T).T)
        largest = coefficients.max()
        if largest <= BEST:
            break
        rows, columns = np.nonzero(coefficients > largest / ALIKE)
        pick = np.lexsort((rows, -chosen[columns]))[0]
        chosen[columns[pick]] = rows[pick]
    return tuple(int(index) for index in np.sort(chosen))


LARGEST_COEFFICIENT = 3.0
"""Upper limit of the entries of ``W`` before other rows are chosen, with a margin for a step."""


def largest_coefficient(e: Equations, rows: tuple[int, ...]) -> ca.SX:
    """Largest entry of ``|W|`` for a choice of rows, an expression of t, y and p."""
    c = ca.mtimes(ca.diag(1 / ca.SX(e.scales.rows)), e.jacobian)
    dependent = [k for k in range(e.constraint_count) if k not in rows]
    solved, following = c[list(rows), :], c[dependent, :]
    factor = LdlFactor(ca.mtimes(solved, solved.T))
    return ca.norm_inf(ca.vec(factor.solve(ca.mtimes(solved, following.T))))


def rows_determine(
    e: Equations, rows: tuple[int, ...], t: float, y: np.ndarray, p: np.ndarray
) -> bool:
    """Whether the other rows follow accurately from these at a position."""
    coefficient = ca.Function("W", [e.t, e.y, e.p], [largest_coefficient(e, rows)])
    return float(coefficient(t, y, p)) <= LARGEST_COEFFICIENT


def best_rows(
    e: Equations, rows: tuple[int, ...], t: float, y: np.ndarray, p: np.ndarray
) -> tuple[int, ...]:
    """The same number of rows with ``|W| ≤ 1`` at a position, changing as few as possible.

    Raises
    ------
    SingularityError
        The equations have no finite value at this position.
    """
    evaluate = ca.Function("C", [e.t, e.y, e.p], [ca.densify(e.jacobian)])
    jacobian = evaluate(t, y, p).full() / e.scales.rows[:, None]
    if not np.all(np.isfinite(jacobian)):
        raise SingularityError(f"the constraint equations have no value at t = {t:.9g} s")
    return largest_volume(np.linalg.svd(jacobian)[0][:, : len(rows)], rows)


def with_consistent_speeds(
    e: Equations, formulation: Formulation, correction: ImplicitFunction | None
) -> ImplicitFunction | None:
    """``(t, x, p) → x``: the formulation's consistent speeds, then the correction with them.

    If all speeds are states it is the correction itself. Positions are returned to their manifold,
    from which integration drifts.
    """
    if correction is None and not e.manifold.flat:
        settled = ca.vertcat(e.manifold.settled(e.y), state_symbols(e)[e.coordinate_count :])
        correction = ImplicitFunction("settled", [e.t, state_symbols(e), e.p], [], [settled])
    speeds = formulation.consistent_speeds(e)
    if speeds is None:
        return correction
    unknown = speeds.unknown

    def with_speeds(expression: ca.SX) -> ca.SX:
        return ca.substitute(expression, e.v, unknown)

    def with_speeds_in(solve: Solver) -> Solver:
        def solved(rhs: ca.SX) -> ca.SX:
            placeholder = ca.SX.sym("rhs", *rhs.shape)
            return ca.substitute(with_speeds(solve(placeholder)), placeholder, ca.densify(rhs))

        return solved

    stages, outputs = [speeds], [state_symbols(e)]
    if correction is not None:
        outputs = correction.outputs
        stages += [
            Stage(
                stage.unknown,
                with_speeds(stage.residual),
                with_speeds(stage.value),
                with_speeds_in(stage.solve),
                with_speeds_in(stage.solve_transposed),
            )
            for stage in correction.stages
        ]
    inputs = [e.t, state_symbols(e), e.p]
    return ImplicitFunction("consistent", inputs, stages, [with_speeds(out) for out in outputs])
