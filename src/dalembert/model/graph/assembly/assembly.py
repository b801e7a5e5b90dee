"""Assembly by Levenberg–Marquardt steps from the guesses to ``Φ = 0``.

Missing positions are first placed through joints. Steps are weighted to change guessed coordinates
less than missing ones. All numbers are in natural units of the mechanism, factors are sparse.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import casadi as ca
import numpy as np
import scipy

from dalembert.model.graph.assembly.guesses import Guesses
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.scales import Scales
from dalembert.sparse.factorise import general_factors
from dalembert.symbolic.equations import newton
from dalembert.symbolic.formulas.expression import stack

CLOSED = newton.NewtonSettings(tolerance=1e-14, max_iterations=200, slack=1e3, halvings=30)
"""Target of violations, relative to their scales, and accepted multiple of it."""
MISSING_WEIGHT = 1e-2
MIN_DAMPING = 1e-15
PATIENCE, PROGRESS = 12, 0.95
"""Stopping criterion: steps that leave more than this share of the violation."""
SEARCH_SAMPLES = 361
LARGEST_TURN = 1.0
"""Upper limit of a step of an angle [rad]; steps of positions are not limited."""
ROUNDING = 4 * float(np.finfo(float).eps)
"""Round-off of a difference of positions, relative to their distance from the origin."""


@dataclass(frozen=True)
class ConstraintResidual(newton.Residual):
    """Violations of the position-level equations with their Jacobian.

    Attributes
    ----------
    jacobian : sparse (m, n)
    """

    scale: np.ndarray
    rounding: np.ndarray
    jacobian: scipy.sparse.csr_array = field(kw_only=True)

    def some(self, rows: list[int]) -> ConstraintResidual:
        """The violations of some equations."""
        return ConstraintResidual(
            self.value[rows], self.scale[rows], self.rounding[rows], jacobian=self.jacobian[rows]
        )


class Assembler:
    """Position-level equations of a mechanism, and projection of positions onto them.

    Parameters
    ----------
    equations : Equations with all constraint rows
    guesses : Guesses
    start : (n,) SX, guesses with missing positions placed
    scales : Scales
    initial : prescribed measures of position, (expression − value)
    searches : (coordinate, rows, range) of curve parameters without a guess
    facing : orientation of joints whose bodies have no guessed one; positive if correct
    """

    def __init__(
        self,
        equations: Equations,
        guesses: Guesses,
        start: ca.SX,
        scales: Scales,
        initial: ca.SX,
        searches: list[tuple[int, list[int], tuple[float, float]]],
        facing: ca.SX,
    ):
        self.guesses, self.scales, self.searches = guesses, scales, searches
        self.equations = e = equations
        self.equation_count = e.constraint_count
        self.start = ca.Function("start", [e.t, e.p], [start])
        self.facing = ca.Function("facing", [e.t, e.y, e.p], [facing])
        residual = ca.vertcat(e.constraints, initial)
        conditions = e.by_displacement(initial)
        jacobian = ca.vertcat(e.position_jacobian, conditions)
        whole = ca.vertcat(e.jacobian, conditions)
        self._whole = ca.Function("jacobian", [e.t, e.y, e.p], [whole])
        self.row_count = residual.numel()
        self.longest = np.where(guesses.metres, np.inf, LARGEST_TURN * scales.displacements)
        self.manifold = e.manifold
        by_row = jacobian.T  # whose columns casadi keeps together
        self.entry_columns, self._ends = (
            np.array(x, dtype=np.int32) for x in (by_row.row(), by_row.colind())
        )
        self.entry_rows = np.repeat(np.arange(self.row_count), np.diff(self._ends))
        entries = stack([ca.vec(by_row.nz[:])])
        far = ca.mtimes(ca.fabs(e.lift).T, ca.fabs(e.y))  # from the origin, by displacements
        outputs = [residual, entries, ca.densify(far)]
        self.position = ca.Function("position", [e.t, e.y, e.p], outputs)

    def violations(
        self, t: float, y: np.ndarray, p: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Violations with their scale and rounding, and the entries of their Jacobian by rows."""
        value, entries, far = (output.full().ravel() for output in self.position(t, y, p))
        row, column, size = self.entry_rows, self.entry_columns, np.abs(entries)
        scale, m = self.scales.rows, self.row_count
        if m > scale.size:
            condition_sizes = np.bincount(row, size * self.scales.displacements[column], m)[
                scale.size :
            ]
            scale = np.concatenate([scale, np.where(condition_sizes > 0, condition_sizes, 1.0)])
        rounding = ROUNDING * np.bincount(row, size * far[column], m)
        return value, scale, rounding, entries

    def displaced(self, y: np.ndarray, step: np.ndarray) -> np.ndarray:
        """The position after a displacement."""
        return self.manifold.go(y, step)

    def residual(self, t: float, y: np.ndarray, p: np.ndarray) -> ConstraintResidual:
        """Violations at a position, of the constraints and then of initial conditions."""
        value, scale, rounding, entries = self.violations(t, y, p)
        shape = self.row_count, self.longest.size
        jacobian = scipy.sparse.csr_array((entries, self.entry_columns, self._ends), shape)
        return ConstraintResidual(value, scale, rounding, jacobian=jacobian)

    def scaled_jacobian(self, t: float, y: np.ndarray, p: np.ndarray) -> scipy.sparse.csr_array:
        """``C`` and the Jacobian of initial conditions, by displacements in natural units."""
        jacobian = scipy.sparse.csr_array(self._whole(t, y, p).sparse())
        return scaled(jacobian, np.ones(jacobian.shape[0]), self.scales.displacements)

    def project(self, t: float, p: np.ndarray, attempts: int = 12) -> newton.Solution[np.ndarray]:
        """Nearest assembled position to the guesses, from several starts if necessary."""
        guess, missing = self.start(t, p).full().ravel(), self.guesses.missing
        rng = np.random.default_rng(0)
        solutions: list[newton.Solution[np.ndarray]] = []
        for attempt in range(attempts):
            start = guess.copy()
            if attempt:
                far = np.where(self.guesses.metres, 0.5, np.pi / 2)
                spread = np.where(missing, far, 0.02 * attempt) * rng.uniform(-1, 1, missing.size)
                start = self.displaced(start, self.scales.displacements * spread)
            solution = self.close(t, self._search(t, start, p), p)
            if solution.accepted and np.all(self.facing(t, solution.x, p).full() > 0):
                return solution
            solutions.append(solution)
        closed = [s for s in solutions if s.accepted]  # the nearest one of wrong orientation
        if closed:
            return closed[0]
        return min(solutions, key=lambda s: s.residual if np.isfinite(s.residual) else np.inf)

    def _search(self, t: float, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Initialise missing curve parameters at the nearest point of their curve."""
        for index, rows, (low, high) in self.searches:
            samples = np.linspace(low, high, SEARCH_SAMPLES)
            table = np.tile(y[:, None], samples.size)
            table[index] = samples
            times, parameters = np.full(samples.size, t), np.tile(p[:, None], samples.size)
            residual = self.position.map(samples.size)(times, table, parameters)[0].full()
            y = table[:, np.argmin(np.linalg.norm(residual[rows], axis=0))]
        return y

    def close(
        self,
        t: float,
        y: np.ndarray,
        p: np.ndarray,
        rows: list[int] | None = None,
    ) -> newton.Solution[np.ndarray]:
        """Root near a position, of all equations or of some rows."""
        return newton.solve(_Nearest(self, t, p, rows), y, CLOSED)


class _Nearest(newton.Equations[np.ndarray]):
    """Some of the equations at an instant, with Levenberg–Marquardt steps of minimum norm.

    Steps minimise a weighted norm. The damping (K. Levenberg 1944, D. W. Marquardt 1963) falls
    with the violation, so that the last steps are Newton steps.
    """

    def __init__(self, assembler: Assembler, t: float, p: np.ndarray, rows: list[int] | None):
        self.assembler, self.t, self.p, self.rows = assembler, t, p, rows
        weight = np.where(assembler.guesses.missing, MISSING_WEIGHT, 1.0)
        self.weight = weight / assembler.scales.displacements
        self.damping = 5e-3
        self.violations: list[float] = []

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        return self.assembler.displaced(x, step)

    def residual(self, x: np.ndarray) -> ConstraintResidual:
        residual = self.assembler.residual(self.t, x, self.p)
        return residual if self.rows is None else residual.some(self.rows)

    def step(self, x: np.ndarray, residual: newton.Residual) -> np.ndarray:
        return next(self.steps(x, residual))

    def steps(self, x: np.ndarray, residual: newton.Residual) -> Iterator[np.ndarray]:
        assert isinstance(residual, ConstraintResidual)
        value = residual.value / residual.scale
        jacobian = scaled(residual.jacobian, 1 / residual.scale, 1 / self.weight)
        normal = jacobian @ jacobian.T
        unit = scipy.sparse.eye_array(value.size, format="csr")
        level = normal.trace() / max(value.size, 1)
        violation = float(np.linalg.norm(value))
        self.violations.append(violation)
        if violation > PROGRESS * ([np.inf] * PATIENCE + self.violations)[-PATIENCE]:
            raise np.linalg.LinAlgError("no step reduces the violation sufficiently")
        self.damping /= 5
        while True:
            damping = level * max(self.damping * violation, MIN_DAMPING)
            factors = general_factors(normal + damping * unit)
            step = -(jacobian.T @ factors.solve(value)) / self.weight
            size = np.max(np.abs(step) / self.assembler.longest, initial=1.0)
            yield step / size
            self.damping *= 4


def scaled(
    matrix: scipy.sparse.csr_array, rows: np.ndarray, columns: np.ndarray
) -> scipy.sparse.csr_array:
    """A matrix with its rows and columns multiplied by numbers."""
    entries = matrix.data * np.repeat(rows, np.diff(matrix.indptr)) * columns[matrix.indices]
    return scipy.sparse.csr_array((entries, matrix.indices, matrix.indptr), matrix.shape)
