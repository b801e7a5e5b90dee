"""Globally convergent method of moving asymptotes (Svanberg 1987, 2002)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.design.methods.base import Optimizer, OptimizerResult, Stop
from dalembert.design.optimize.program import Point, Program
from dalembert.errors import UnsupportedError
from dalembert.options import options

SUFFICIENT = 0.1
"""Threshold of the decrease over the predicted decrease of the merit function [-]."""
ELASTIC = 1e4
"""Upper limit of the multipliers: penalty of violations in infeasible subproblems."""


@dataclass
class Approximation:
    """``Σ_j p_ij/(U_j − z_j) + q_ij/(z_j − L_j) + r_i``, convex and separable (Svanberg 2002, 3.1).

    Its dual is concave with one multiplier per limit, and cheap to solve for any number of
    variables.
    """

    p: np.ndarray
    q: np.ndarray
    r: np.ndarray
    low: np.ndarray
    high: np.ndarray
    move_low: np.ndarray
    move_high: np.ndarray

    def values(self, z: np.ndarray) -> np.ndarray:
        """(1 + m,) values of all functions."""
        return self.p @ (1 / (self.high - z)) + self.q @ (1 / (z - self.low)) + self.r

    def minimiser(self, weights: np.ndarray) -> np.ndarray:
        """(n,) minimiser of the weighted sum within the move limits."""
        p, q = np.sqrt(weights @ self.p), np.sqrt(weights @ self.q)
        z = (self.low * p + self.high * q) / np.maximum(p + q, 1e-300)
        return np.clip(z, self.move_low, self.move_high)

    def solve(self) -> tuple[np.ndarray, np.ndarray]:
        """(n,) constrained minimiser by the dual, and (m,) multipliers."""
        from scipy.optimize import minimize

        limits = self.r.size - 1

        def dual(multipliers: np.ndarray) -> tuple[float, np.ndarray]:
            weights = np.concatenate([[1.0], multipliers])
            values = self.values(self.minimiser(weights))
            return -float(weights @ values), -values[1:]

        optimal = np.zeros(limits)
        if limits:
            options = {"maxiter": 500, "ftol": 1e-15, "gtol": 1e-10}
            bounds = [(0.0, ELASTIC)] * limits
            start = np.ones(limits)
            optimal = minimize(dual, start, jac=True, bounds=bounds, options=options).x
        return self.minimiser(np.concatenate([[1.0], optimal])), optimal


@options
class MMA(Optimizer):
    """Method of moving asymptotes for many variables and a few inequality limits.

    Parameters
    ----------
    move : upper limit of the step, relative to the ranges

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> row = da.Structure("springs in a row")
    >>> a, b = (row.parameter(name, 2.0, bounds=(0.1, 10)) for name in ("a", "b"))
    >>> wall, mid, end = row.node("wall", 0), row.node("mid", 1), row.node("end", 2)
    >>> i = row.add(structures.AxialSpring("i", wall, mid, stiffness=a))
    >>> j = row.add(structures.AxialSpring("j", mid, end, stiffness=b))
    >>> row.support(wall)
    >>> row.load(end, fx=1.0)
    >>> give = da.Limit(da.final("end.ux"), upper=1.0)
    >>> task = dict(minimize=da.final("a + 4*b"), subject_to=[give], analysis=da.Statics())
    >>> best = da.optimize(row.build(), **task, method=da.MMA())
    >>> round(best.x["a"], 3), round(best.x["b"], 3)  # a = 2 b where b is four times as dear
    (3.0, 1.5)
    """

    move: float = 0.2

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> OptimizerResult:
        if np.any(program.c_lower == program.c_upper):
            raise UnsupportedError("MMA takes no equations; use method='slsqp' or 'ipopt'")
        constraints = _InequalityConstraints(program)
        point, asymptotes = program.point(z), _Asymptotes(program)
        last_z, quiet_steps = z, 0
        for _ in range(stop.max_iterations):
            if point is None:
                break
            asymptotes.update(z)
            next_z = self._step(program, constraints, z, point, asymptotes)
            if next_z is None:
                return OptimizerResult(z, False, "no step improves the design")
            last_z, z = z, next_z
            last_point, point = point, program.point(z)
            if point is None:
                return OptimizerResult(last_z, False, "the run fails at the final design")
            is_quiet = abs(point.f - last_point.f) <= stop.tolerance * max(abs(point.f), 1e-2)
            quiet_steps = quiet_steps + 1 if is_quiet and np.max(abs(z - last_z)) < 1e-3 else 0
            if quiet_steps >= 2:
                return OptimizerResult(z, True, "the objective no longer changes")
        count = stop.used + stop.max_iterations
        return OptimizerResult(z, False, f"{count} iterations did not suffice")

    def _step(
        self,
        program: Program,
        constraints: _InequalityConstraints,
        z: np.ndarray,
        point: Point,
        asymptotes: _Asymptotes,
    ) -> np.ndarray | None:
        """Next design: the curvature of the approximations is raised until a trial is accepted.

        A trial is accepted if all approximations are conservative (Svanberg 2002, 4.1), or if the
        merit function, objective plus weighted violations, decreases by a share of the predicted
        decrease. None if no trial is accepted.
        """
        values, slopes = constraints.values(point.f, point.c), constraints.slopes(point)
        curvature = np.maximum(1e-5, 0.1 / z.size * np.sum(abs(slopes) * asymptotes.range, axis=1))
        move = self.move
        for _ in range(30):
            model = asymptotes.approximation(z, values, slopes, curvature, move)
            trial, multipliers = model.solve()
            trial_values = program.value(trial)
            if trial_values is None:
                move = 0.3 * min(move, float(np.max(abs(trial - z) / asymptotes.range)))
                continue
            model_values, true_values = model.values(trial), constraints.values(*trial_values)
            if np.all(model_values + 1e-9 * (1 + abs(true_values)) >= true_values):
                return trial
            weights = constraints.weights(multipliers)
            decrease, predicted = (
                _merit(values, weights) - _merit(v, weights) for v in (true_values, model_values)
            )
            if predicted > 0 and decrease >= SUFFICIENT * predicted:
                return trial
            deficit = (true_values - model_values) / max(asymptotes.distance(z, trial), 1e-12)
            curvature = np.where(
                deficit > 0, np.minimum(10 * curvature, 1.1 * (curvature + deficit)), curvature
            )
        return None


def _merit(values: np.ndarray, weights: np.ndarray) -> float:
    """Merit function: objective plus weighted violations of the limits."""
    return float(values[0] + weights @ np.maximum(values[1:], 0.0))


class _InequalityConstraints:
    """Objective, and limits in the form ``g ≤ 0``."""

    def __init__(self, program: Program):
        self.low = np.flatnonzero(np.isfinite(program.c_lower))
        self.high = np.flatnonzero(np.isfinite(program.c_upper))
        self.c_lower, self.c_upper = program.c_lower[self.low], program.c_upper[self.high]
        self.penalties = np.zeros(self.low.size + self.high.size)

    def values(self, f: float, c: np.ndarray) -> np.ndarray:
        return np.concatenate([[f], self.c_lower - c[self.low], c[self.high] - self.c_upper])

    def weights(self, multipliers: np.ndarray) -> np.ndarray:
        """(m,) weights of violations in the merit function; they never decrease."""
        self.penalties = np.maximum(self.penalties, 2 * multipliers + 1e-3)
        return self.penalties

    def slopes(self, point: Point) -> np.ndarray:
        return np.vstack([point.g, -point.J[self.low], point.J[self.high]])


class _Asymptotes:
    """Asymptotes: closer if a variable oscillates, else farther (Svanberg 2002, 3.7)."""

    def __init__(self, program: Program):
        self.lower = np.maximum(program.z_lower, -10.0)
        self.upper = np.minimum(program.z_upper, 10.0)
        self.range = np.maximum(self.upper - self.lower, 1e-12)
        self.past: list[np.ndarray] = []
        self.span = 0.5 * self.range

    def update(self, z: np.ndarray) -> None:
        """Update from the last three designs."""
        self.past = [*self.past[-2:], z]
        if len(self.past) == 3:
            products = (self.past[2] - self.past[1]) * (self.past[1] - self.past[0])
            self.span = self.span * np.where(products < 0, 0.7, np.where(products > 0, 1.2, 1.0))
            self.span = np.clip(self.span, 1e-4 * self.range, 10 * self.range)
        self.low, self.high = z - self.span, z + self.span

    def distance(self, z: np.ndarray, trial: np.ndarray) -> float:
        """Weight of the curvature term at a trial (Svanberg 2002, 3.17)."""
        ratio = (self.high - self.low) * (trial - z) ** 2
        return float(np.sum(ratio / ((self.high - trial) * (trial - self.low) * self.range)))

    def approximation(
        self,
        z: np.ndarray,
        values: np.ndarray,
        slopes: np.ndarray,
        curvature: np.ndarray,
        move: float,
    ) -> Approximation:
        """Convex separable functions with the same values and slopes at ``z``."""
        up, down = np.maximum(slopes, 0), np.maximum(-slopes, 0)
        extra = curvature[:, None] / self.range
        p = (self.high - z) ** 2 * (1.001 * up + 0.001 * down + extra)
        q = (z - self.low) ** 2 * (0.001 * up + 1.001 * down + extra)
        r = values - p @ (1 / (self.high - z)) - q @ (1 / (z - self.low))
        reach = np.minimum(0.9 * self.span, move * self.range)
        low, high = np.maximum(self.lower, z - reach), np.minimum(self.upper, z + reach)
        return Approximation(p, q, r, self.low, self.high, low, high)
