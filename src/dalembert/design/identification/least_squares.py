"""Least squares of a misfit, optionally robust: SciPy's trust region with the exact Jacobian."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.design.identification.misfit import Misfit
from dalembert.design.methods.search_options import check_stop
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.interrupts import raising_ctrl_c
from dalembert.text.wording import counted

LOSSES = ("linear", "soft_l1", "huber", "cauchy", "arctan")
NORMAL = 1.4826
"""Standard deviation of a normal variable over the median of its absolute value."""
MAX_ROUNDS = 12
"""Upper limit of the alternations between unknowns and noise."""
APART = 1e-3
"""Threshold for the distance of distinct minima, relative to the ranges of the unknowns [-]."""
NOISE_FLOOR = 1e-10
"""Lower limit of the noise relative to the scatter of a column [-]: rounding."""


@dataclass
class Fit:
    """Outcome of a least-squares fit."""

    x: np.ndarray
    success: bool
    message: str
    cost: float


@dataclass
class LeastSquaresSolver:
    """``min Σ ρ(r²)`` over the unknowns, within their bounds.

    Parameters
    ----------
    loss : ``ρ``, one of ``LOSSES``, scaled by the noise
    penalty : additional residuals ``P x − q``, such as those of a regularisation
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
        """Local minimum from a start; Ctrl-C ends with the best unknowns so far."""
        self._reached = None
        try:
            with raising_ctrl_c():
                return self._search(x)
        except KeyboardInterrupt:
            if self._reached is None:
                raise
            self.interrupted = True
            cost, best = self._reached
            return Fit(best, False, f"interrupted after {counted(self._count, 'iteration')}", cost)

    def _search(self, x: np.ndarray) -> Fit:
        from scipy.optimize import least_squares

        unknowns = self.misfit.unknowns
        size = unknowns.sizes(unknowns.start)
        tiny = 1e-10 * size  # SciPy starts strictly inside the bounds
        interior = np.clip(x, unknowns.lower + tiny, unknowns.upper - tiny)
        interior = np.where(unknowns.upper - unknowns.lower > 2 * tiny, interior, x)
        outcome = least_squares(
            lambda z: self.residual(z * size),
            interior / size,
            jac=lambda z: self.jacobian(z * size) * size,
            bounds=(unknowns.lower / size, unknowns.upper / size),
            x_scale="jac",
            loss=self.loss,
            ftol=self.tolerance,
            xtol=self.tolerance,
            gtol=self.tolerance,
            max_nfev=self.max_iterations,
        )
        solution = outcome.x * size
        return Fit(solution, bool(outcome.status > 0), str(outcome.message), float(outcome.cost))

    def minima(self, starts: Sequence[np.ndarray]) -> list[tuple[float, np.ndarray]]:
        """Cost and unknowns of the distinct minima from several starts, the best first.

        Unspecified noise is set to the scatter of its column, so that costs are comparable.
        """
        self.use_specified_noise()
        minima: list[tuple[float, np.ndarray]] = []
        width = self.misfit.unknowns.upper - self.misfit.unknowns.lower
        for start in starts:
            if self.misfit.motions(start) is None:  # the run fails
                continue
            fit = self.solve(start)
            is_same = [bool(np.all(abs(x - fit.x) <= APART * width)) for _, x in minima]
            if True not in is_same:
                minima.append((fit.cost, fit.x))
            elif fit.cost < minima[is_same.index(True)][0]:
                minima[is_same.index(True)] = fit.cost, fit.x
            if self.interrupted:
                break
        return sorted(minima, key=lambda entry: entry[0])

    def residual(self, x: np.ndarray) -> np.ndarray:
        """(N,) residuals, followed by those of the penalty."""
        r = self.misfit.residual(x)
        return r if self.penalty is None else np.append(r, self.penalty[0] @ x - self.penalty[1])

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """(N, n) derivatives; called once per iteration."""
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

    def fit_with_noise(self, x: np.ndarray) -> tuple[Fit, dict[str, float], bool]:
        """Fit, noise of each column, and whether the noise was estimated from the data.

        Noise and unknowns are estimated alternately: each column is weighted by the scatter of its
        residuals, the maximum-likelihood estimate for normal noise.
        """
        is_specified = self.use_specified_noise()
        if self.interrupted:
            cost = 0.5 * float(np.sum(self.residual(x) ** 2))
            fit = Fit(x, False, f"interrupted after {counted(self._count, 'iteration')}", cost)
        else:
            fit = self.solve(x)
        if is_specified or self.interrupted:
            return fit, self._noise_levels(), not is_specified
        for _ in range(MAX_ROUNDS):
            old_levels = self._noise_levels()
            self.estimate_noise(fit.x)
            levels = self._noise_levels()
            if self.loss == "linear" and len(levels) == 1:
                break
            fit = self.solve(fit.x)
            if self.interrupted or all(
                abs(levels[c] - old_levels[c]) <= 1e-3 * levels[c] for c in levels
            ):
                break
        return fit, self._noise_levels(), True

    def use_specified_noise(self) -> bool:
        """Set specified noise, else the scatter of each column; True if all is specified."""
        spread = {c: max(s, 1e-300) for c, s in self._scatter().items()}
        all_specified = True
        for o, noise in zip(self.misfit.observations, self.misfit.noise, strict=True):
            for j, column in enumerate(o.columns):
                is_specified = np.all(np.isfinite(o.noise[:, j]))
                all_specified &= bool(is_specified)
                noise[:, j] = o.noise[:, j] if is_specified else spread[column]
        return all_specified

    def estimate_noise(self, x: np.ndarray) -> None:
        """Set unspecified noise to the scatter of the residuals of its column."""
        misfit = self.misfit
        if misfit.motions(x) is None:
            raise AnalysisError(misfit.failures[-1])
        predicted, floor = misfit.predicted(x), self._scatter()
        freedom_share = 1 - x.size / misfit.size if misfit.size > x.size else 1.0
        residuals: dict[str, list[np.ndarray]] = {}
        for o, values, used in zip(misfit.observations, predicted, misfit.used, strict=True):
            for j, column in enumerate(o.columns):
                column_residuals = (values - o.values)[used[:, j], j]
                residuals.setdefault(column, []).append(column_residuals)
        for o, noise in zip(misfit.observations, misfit.noise, strict=True):
            for j, column in enumerate(o.columns):
                if not np.all(np.isfinite(o.noise[:, j])):
                    column_residuals = np.concatenate(residuals[column])
                    robust = NORMAL * float(np.median(abs(column_residuals)))
                    rms = float(np.sqrt(np.mean(column_residuals**2) / freedom_share))
                    level = rms if self.loss == "linear" else robust
                    noise[:, j] = max(level, NOISE_FLOOR * floor[column], 1e-300)

    def _scatter(self) -> dict[str, float]:
        """Column → standard deviation of its data, or its magnitude if it is constant."""
        samples: dict[str, list[np.ndarray]] = {}
        for o, used in zip(self.misfit.observations, self.misfit.used, strict=True):
            for j, column in enumerate(o.columns):
                samples.setdefault(column, []).append(o.values[used[:, j], j])
        columns = {c: np.concatenate(v) for c, v in samples.items()}
        return {
            c: float(np.std(v)) or float(np.max(abs(v), initial=0)) or 1.0
            for c, v in columns.items()
        }

    def _noise_levels(self) -> dict[str, float]:
        """Column → root mean square of its noise."""
        deviations: dict[str, Any] = {}
        for o, noise in zip(self.misfit.observations, self.misfit.noise, strict=True):
            for j, column in enumerate(o.columns):
                deviations.setdefault(column, []).append(noise[:, j])
        return {c: float(np.sqrt(np.mean(np.concatenate(v) ** 2))) for c, v in deviations.items()}
