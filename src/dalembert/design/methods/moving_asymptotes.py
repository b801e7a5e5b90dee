"""Method of moving asymptotes, globally convergent (Svanberg 1987, 2002)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.design.methods.base import Ended, Optimizer, Stop
from dalembert.design.optimize.program import Point, Program
from dalembert.errors import UnsupportedError
from dalembert.options import options

SUFFICIENT = 0.1
"""Share of the predicted fall of the merit function from which a trial is accepted."""
ELASTIC = 1e4
"""Cost of a limit's violation in subproblems that cannot keep it."""


@dataclass
class Approximation:
    """``Σ_j p_ij/(U_j − z_j) + q_ij/(z_j − L_j) + r_i``, convex and separable (Svanberg 2002, 3.1).

    Its dual is concave in one multiplier per limit: minimising it costs nothing beside a run,
    whatever the number of variables.
    """

    p: np.ndarray
    q: np.ndarray
    r: np.ndarray
    low: np.ndarray
    high: np.ndarray
    move_low: np.ndarray
    move_high: np.ndarray

    def values(self, z: np.ndarray) -> np.ndarray:
        """(1 + m,) of all functions."""
        return self.p @ (1 / (self.high - z)) + self.q @ (1 / (z - self.low)) + self.r

    def minimiser(self, weights: np.ndarray) -> np.ndarray:
        """(n,) least weighted sum within the moves."""
        p, q = np.sqrt(weights @ self.p), np.sqrt(weights @ self.q)
        z = (self.low * p + self.high * q) / np.maximum(p + q, 1e-300)
        return np.clip(z, self.move_low, self.move_high)

    def solve(self) -> tuple[np.ndarray, np.ndarray]:
        """(n,) minimum of the objective within the limits, by their dual, and (m,) multipliers."""
        from scipy.optimize import minimize

        limits = self.r.size - 1

        def dual(multipliers: np.ndarray) -> tuple[float, np.ndarray]:
            weights = np.concatenate([[1.0], multipliers])
            values = self.values(self.minimiser(weights))
            return -float(weights @ values), -values[1:]

        found = np.zeros(limits)
        if limits:
            options = {"maxiter": 500, "ftol": 1e-15, "gtol": 1e-10}
            bounds = [(0.0, ELASTIC)] * limits
            start = np.ones(limits)
            found = minimize(dual, start, jac=True, bounds=bounds, options=options).x
        return self.minimiser(np.concatenate([[1.0], found])), found


@options
class Mma(Optimizer):
    """For very many variables and a few limits, none of them equations.

    Parameters
    ----------
    move : largest step, in ranges

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
    >>> best = da.optimize(row.build(), **task, method=da.Mma())
    >>> round(best.x["a"], 3), round(best.x["b"], 3)  # a = 2 b where b is four times as dear
    (3.0, 1.5)
    """

    move: float = 0.2

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> Ended:
        if np.any(program.c_lower == program.c_upper):
            raise UnsupportedError("Mma knows no equations; use method='slsqp' or 'ipopt'")
        rows = _Sides(program)
        here, asymptotes = program.point(z), _Asymptotes(program)
        old, still = z, 0
        for _ in range(stop.max_iterations):
            if here is None:
                break
            asymptotes.place(z)
            found = self._step(program, rows, z, here, asymptotes)
            if found is None:
                return Ended(z, False, "no step improves the design")
            old, z = z, found
            before, here = here, program.point(z)
            if here is None:
                return Ended(old, False, "ended at a design that fails")
            quiet = abs(here.f - before.f) <= stop.tolerance * max(abs(here.f), 1e-2)
            still = still + 1 if quiet and np.max(abs(z - old)) < 1e-3 else 0
            if still >= 2:
                return Ended(z, True, "the objective no longer changes")
        count = stop.used + stop.max_iterations
        return Ended(z, False, f"{count} iterations did not suffice")

    def _step(
        self, program: Program, rows: _Sides, z: np.ndarray, here: Point, places: _Asymptotes
    ) -> np.ndarray | None:
        """The next design: approximations are made more convex until a trial is acceptable.

        A trial is acceptable where all approximations are conservative (Svanberg 2002, 4.1), or
        where the merit function, objective and weighted violations, falls by a share of what the
        approximations predict.
        """
        values, slopes = rows.values(here.f, here.c), rows.slopes(here)
        bend = np.maximum(1e-5, 0.1 / z.size * np.sum(abs(slopes) * places.range, axis=1))
        move = self.move
        for _ in range(30):
            model = places.approximation(z, values, slopes, bend, move)
            trial, multipliers = model.solve()
            found = program.value(trial)
            if found is None:
                move = 0.3 * min(move, float(np.max(abs(trial - z) / places.range)))
                continue
            told, real = model.values(trial), rows.values(*found)
            if np.all(told + 1e-9 * (1 + abs(real)) >= real):
                return trial
            weights = rows.weights(multipliers)
            fall, predicted = (_merit(values, weights) - _merit(v, weights) for v in (real, told))
            if predicted > 0 and fall >= SUFFICIENT * predicted:
                return trial
            lack = (real - told) / max(places.distance(z, trial), 1e-12)
            bend = np.where(lack > 0, np.minimum(10 * bend, 1.1 * (bend + lack)), bend)
        return None


def _merit(values: np.ndarray, weights: np.ndarray) -> float:
    """Objective and weighted violations of the limits."""
    return float(values[0] + weights @ np.maximum(values[1:], 0.0))


class _Sides:
    """Objective and limits as functions that are to be ≤ 0 but for the first."""

    def __init__(self, program: Program):
        self.low = np.flatnonzero(np.isfinite(program.c_lower))
        self.high = np.flatnonzero(np.isfinite(program.c_upper))
        self.c_lower, self.c_upper = program.c_lower[self.low], program.c_upper[self.high]
        self.largest = np.zeros(self.low.size + self.high.size)

    def values(self, f: float, c: np.ndarray) -> np.ndarray:
        return np.concatenate([[f], self.c_lower - c[self.low], c[self.high] - self.c_upper])

    def weights(self, multipliers: np.ndarray) -> np.ndarray:
        """(m,) weights of violations in the merit function; they never fall."""
        self.largest = np.maximum(self.largest, 2 * multipliers + 1e-3)
        return self.largest

    def slopes(self, point: Point) -> np.ndarray:
        return np.vstack([point.g, -point.J[self.low], point.J[self.high]])


class _Asymptotes:
    """Asymptotes: nearer where a variable swings, further where it goes on (Svanberg 2002, 3.7)."""

    def __init__(self, program: Program):
        self.lower = np.maximum(program.z_lower, -10.0)
        self.upper = np.minimum(program.z_upper, 10.0)
        self.range = np.maximum(self.upper - self.lower, 1e-12)
        self.past: list[np.ndarray] = []
        self.span = 0.5 * self.range

    def place(self, z: np.ndarray) -> None:
        """Move with the last three designs."""
        self.past = [*self.past[-2:], z]
        if len(self.past) == 3:
            turn = (self.past[2] - self.past[1]) * (self.past[1] - self.past[0])
            self.span = self.span * np.where(turn < 0, 0.7, np.where(turn > 0, 1.2, 1.0))
            self.span = np.clip(self.span, 1e-4 * self.range, 10 * self.range)
        self.low, self.high = z - self.span, z + self.span

    def distance(self, z: np.ndarray, trial: np.ndarray) -> float:
        """What the bend weighs at a trial (Svanberg 2002, 3.17)."""
        ratio = (self.high - self.low) * (trial - z) ** 2
        return float(np.sum(ratio / ((self.high - trial) * (trial - self.low) * self.range)))

    def approximation(
        self,
        z: np.ndarray,
        values: np.ndarray,
        slopes: np.ndarray,
        bend: np.ndarray,
        move: float,
    ) -> Approximation:
        """The convex separable functions about ``z`` with the same values and slopes."""
        up, down = np.maximum(slopes, 0), np.maximum(-slopes, 0)
        extra = bend[:, None] / self.range
        p = (self.high - z) ** 2 * (1.001 * up + 0.001 * down + extra)
        q = (z - self.low) ** 2 * (0.001 * up + 1.001 * down + extra)
        r = values - p @ (1 / (self.high - z)) - q @ (1 / (z - self.low))
        reach = np.minimum(0.9 * self.span, move * self.range)
        low, high = np.maximum(self.lower, z - reach), np.minimum(self.upper, z + reach)
        return Approximation(p, q, r, self.low, self.high, low, high)
