"""Least squares of a misfit, robust if wanted: SciPy's trust region with the exact Jacobian."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.design.identification.misfit import Misfit
from dalembert.design.methods.stop import check_stop
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.interrupts import raising_ctrl_c

LOSSES = ("linear", "soft_l1", "huber", "cauchy", "arctan")
NORMAL = 1.4826
"""Standard deviation of a normal variable over the median of its absolute value."""
ROUNDS = 12
APART = 1e-3
"""Of the range of an unknown, from which on minima are different."""
LEAST = 1e-10
"""Least noise, relative to the size of a column: rounding."""


@dataclass
class Fit:
    """Where least squares ended."""

    x: np.ndarray
    success: bool
    message: str
    cost: float


@dataclass
class LeastSquares:
    """``min Σ ρ(r²)`` over the unknowns, within their bounds.

    Parameters
    ----------
    loss : ``ρ``, one of ``LOSSES``; the noise is its scale
    penalty : more rows ``P x − q``, such as those of a regularisation
    """

    misfit: Misfit
    loss: str = "linear"
    tolerance: float = 1e-10
    max_iterations: int = 100
    penalty: tuple[np.ndarray, np.ndarray] | None = None
    progress: bool | Callable[[int, float], None] = False

    def __post_init__(self) -> None:
        check_stop(self.max_iterations, self.tolerance)
        if self.loss not in LOSSES:
            raise UnsupportedError(f"unknown loss {self.loss!r}; known: {', '.join(LOSSES)}")
        self._count = 0
        self.interrupted = False
        self._reached: tuple[float, np.ndarray] | None = None

    def solve(self, x: np.ndarray) -> Fit:
        """The nearest minimum from a start; the best unknowns so far where it is interrupted."""
        self._reached = None
        try:
            with raising_ctrl_c():
                return self._solved(x)
        except KeyboardInterrupt:
            if self._reached is None:
                raise
            self.interrupted = True
            cost, best = self._reached
            return Fit(best, False, f"interrupted after {self._count} iteration(s)", cost)

    def _solved(self, x: np.ndarray) -> Fit:
        from scipy.optimize import least_squares

        unknowns = self.misfit.unknowns
        size = unknowns.sizes(unknowns.start)
        tiny = 1e-10 * size  # SciPy begins inside of the bounds
        inside = np.clip(x, unknowns.lower + tiny, unknowns.upper - tiny)
        inside = np.where(unknowns.upper - unknowns.lower > 2 * tiny, inside, x)
        outcome = least_squares(
            lambda z: self.residual(z * size),
            inside / size,
            jac=lambda z: self.jacobian(z * size) * size,
            bounds=(unknowns.lower / size, unknowns.upper / size),
            x_scale="jac",
            loss=self.loss,
            ftol=self.tolerance,
            xtol=self.tolerance,
            gtol=self.tolerance,
            max_nfev=self.max_iterations,
        )
        found = outcome.x * size
        return Fit(found, bool(outcome.status > 0), str(outcome.message), float(outcome.cost))

    def minima(self, begins: Sequence[np.ndarray]) -> list[tuple[float, np.ndarray]]:
        """Cost and unknowns of the distinct minima from some starts, the best first.

        Noise that is not given counts as the scatter of its column, so that costs compare.
        """
        self.use_given_noise()
        found: list[tuple[float, np.ndarray]] = []
        width = self.misfit.unknowns.upper - self.misfit.unknowns.lower
        for begin in begins:
            if self.misfit.motions(begin) is None:  # it cannot be run there
                continue
            fit = self.solve(begin)
            near = [bool(np.all(abs(x - fit.x) <= APART * width)) for _, x in found]
            if True not in near:
                found.append((fit.cost, fit.x))
            elif fit.cost < found[near.index(True)][0]:
                found[near.index(True)] = fit.cost, fit.x
            if self.interrupted:
                break
        return sorted(found, key=lambda one: one[0])

    def residual(self, x: np.ndarray) -> np.ndarray:
        """(N,) residuals, those of the penalty last."""
        r = self.misfit.residual(x)
        return r if self.penalty is None else np.append(r, self.penalty[0] @ x - self.penalty[1])

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """(N, n); asked for once an iteration, at the unknowns reached."""
        self._count += 1
        cost = 0.5 * float(np.sum(self.residual(x) ** 2))
        if self._reached is None or cost < self._reached[0]:
            self._reached = cost, np.array(x)
        if self.progress:
            if callable(self.progress):
                self.progress(self._count, cost)
            else:
                print(f"iteration {self._count}: {cost:.8g}")
        rows = self.misfit.jacobian(x)
        return rows if self.penalty is None else np.vstack([rows, self.penalty[0]])

    def with_noise(self, x: np.ndarray) -> tuple[Fit, dict[str, float], bool]:
        """The fit, the noise of each column, and whether that was estimated from the data.

        Unknown noise and unknowns are found in turn: each column is weighed by the scatter of its
        own residuals, which is the likeliest estimate for normal noise.
        """
        given = self.use_given_noise()
        if self.interrupted:
            cost = 0.5 * float(np.sum(self.residual(x) ** 2))
            fit = Fit(x, False, f"interrupted after {self._count} iteration(s)", cost)
        else:
            fit = self.solve(x)
        if given or self.interrupted:
            return fit, self._told(), not given
        for _ in range(ROUNDS):
            before = self._told()
            self.estimate_noise(fit.x)
            after = self._told()
            if self.loss == "linear" and len(after) == 1:
                break
            fit = self.solve(fit.x)
            if self.interrupted or all(abs(after[c] - before[c]) <= 1e-3 * after[c] for c in after):
                break
        return fit, self._told(), True

    def use_given_noise(self) -> bool:
        """Take the noise as given, else the scatter of each column; true if all is given."""
        spread = {c: max(s, 1e-300) for c, s in self._scatter().items()}
        every = True
        for o, noise in zip(self.misfit.observations, self.misfit.noise, strict=True):
            for j, column in enumerate(o.columns):
                known = np.all(np.isfinite(o.noise[:, j]))
                every &= bool(known)
                noise[:, j] = o.noise[:, j] if known else spread[column]
        return every

    def estimate_noise(self, x: np.ndarray) -> None:
        """Scatter of the residuals of each column whose noise is not given."""
        misfit = self.misfit
        if misfit.motions(x) is None:
            raise AnalysisError(misfit.failures[-1])
        predicted, floor = misfit.predicted(x), self._scatter()
        left = 1 - x.size / misfit.size if misfit.size > x.size else 1.0
        rest: dict[str, list[np.ndarray]] = {}
        for o, found, used in zip(misfit.observations, predicted, misfit.used, strict=True):
            for j, column in enumerate(o.columns):
                off = (found - o.values)[used[:, j], j]
                rest.setdefault(column, []).append(off)
        for o, noise in zip(misfit.observations, misfit.noise, strict=True):
            for j, column in enumerate(o.columns):
                if not np.all(np.isfinite(o.noise[:, j])):
                    off = np.concatenate(rest[column])
                    rough = NORMAL * float(np.median(abs(off)))
                    usual = float(np.sqrt(np.mean(off**2) / left))
                    chosen = usual if self.loss == "linear" else rough
                    noise[:, j] = max(chosen, LEAST * floor[column], 1e-300)

    def _scatter(self) -> dict[str, float]:
        """Column → standard deviation of its data, its size where it does not vary."""
        samples: dict[str, list[np.ndarray]] = {}
        for o, used in zip(self.misfit.observations, self.misfit.used, strict=True):
            for j, column in enumerate(o.columns):
                samples.setdefault(column, []).append(o.values[used[:, j], j])
        every = {c: np.concatenate(v) for c, v in samples.items()}
        return {
            c: float(np.std(v)) or float(np.max(abs(v), initial=0)) or 1.0 for c, v in every.items()
        }

    def _told(self) -> dict[str, float]:
        """Column → root mean square of its noise."""
        found: dict[str, Any] = {}
        for o, noise in zip(self.misfit.observations, self.misfit.noise, strict=True):
            for j, column in enumerate(o.columns):
                found.setdefault(column, []).append(noise[:, j])
        return {c: float(np.sqrt(np.mean(np.concatenate(v) ** 2))) for c, v in found.items()}
