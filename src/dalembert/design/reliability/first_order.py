"""First-order reliability: the point of a limit state that is nearest to the origin of ``u``.

Hasofer and Lind's index ``β = αᵀu*`` of the point ``u*`` with ``G(u*) = 0``, ``α = −∇G/|∇G|``.
The methods are sequential quadratic programming (``quasi_newton.py``), the iteration of Rackwitz
and Fiessler (HL-RF), and the improved one of Zhang and Der Kiureghian (1995); the first and the
last have a line search on the merit ``|u|²/2 + c|G|``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.design.methods.search_options import check_stop
from dalembert.design.reliability.limit_state import LimitStates
from dalembert.design.reliability.nataf import Nataf
from dalembert.design.reliability.quasi_newton import LagrangianHessian
from dalembert.errors import AnalysisError, UnsupportedError

METHODS = ("sqp", "improved-hlrf", "hlrf")


@dataclass(frozen=True)
class DesignPoint:
    """Where a limit state is likeliest to break.

    Attributes
    ----------
    limit : label of the limit state
    beta : reliability index, below zero where the means fail already
    u : (n,) in independent standard normal variables
    x : random parameter → value
    alpha : (n,) unit vector towards failure
    slope : ``|∇G|``
    residual : ``|G(u*)|`` over ``|G|`` at the median: zero if it lies on the limit state
    off : distance of ``u*`` from the ray along ``α``: zero if it is the nearest
    converged : whether both are within the tolerance
    gradient, others : of ``g`` by the random and by the other parameters
    iterations : taken
    curvatures : (n − 1,) principal curvatures of the surface there; None before they are computed
    """

    limit: str
    row: int
    beta: float
    u: np.ndarray
    x: dict[str, float]
    alpha: np.ndarray
    slope: float
    residual: float
    off: float
    converged: bool
    gradient: np.ndarray
    others: np.ndarray
    iterations: int
    curvatures: np.ndarray | None = None

    @property
    def probability(self) -> float:
        """``Φ(−β)``."""
        from scipy.special import ndtr

        return float(ndtr(-self.beta))


@dataclass
class Search:
    """Search for design points of one limit state.

    Parameters
    ----------
    row : number of the limit state
    tolerance : on residual and distance
    """

    limits: LimitStates
    nataf: Nataf
    row: int
    method: str = "sqp"
    tolerance: float = 1e-8
    max_iterations: int = 100

    def __post_init__(self) -> None:
        check_stop(self.max_iterations, self.tolerance)
        if self.method not in METHODS:
            known = ", ".join(METHODS)
            raise UnsupportedError(f"unknown method {self.method!r}; known: {known}")

    def value(self, u: np.ndarray) -> float:
        """``G(u)``; NaN where a run fails."""
        return float(self.limits.values(self.nataf.values(u))[self.row])

    def slope(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """``∇G``, and ``∂g`` by random and other parameters."""
        random, others = self.limits.gradients(self.nataf.values(u))
        return self.nataf.slopes(u).T @ random[self.row], random[self.row], others[self.row]

    def solve(self, start: np.ndarray, scale: float) -> DesignPoint:
        """The design point reached from a start.

        Parameters
        ----------
        scale : size of ``G``, that of the median

        Raises
        ------
        AnalysisError
            A run fails, or the limit state does not depend on what is random.
        """
        u, weight = start, 0.0
        g, hessian = self.needed(u), LagrangianHessian(start.size)
        before: tuple[np.ndarray, np.ndarray, float] | None = None
        for iteration in range(self.max_iterations + 1):
            slope, random, others = self.slope(u)
            size = float(np.linalg.norm(slope))
            if not size > 0:
                raise AnalysisError(
                    f"{self.limits.labels[self.row]}: does not change with the random parameters "
                    f"at {self._told(u)}; its gradient is {size:g}"
                )
            alpha = -slope / size
            off = float(np.linalg.norm(u - (alpha @ u) * alpha))
            far = max(1.0, float(np.linalg.norm(u)))
            done = abs(g) <= self.tolerance * scale and off <= self.tolerance**0.5 * far
            exact = done and off <= 10 * self.tolerance * far
            if exact or iteration == self.max_iterations:
                break
            if before is not None and self.method == "sqp":
                moved = u - before[0]
                hessian.update(moved, moved + before[2] * (slope - before[1]))
            step, multiplier = hessian.step(u, g, slope)
            before = u, slope, multiplier
            if self.method == "hlrf":
                following, value = u + step, self.needed(u + step)
            else:
                if self.method == "improved-hlrf":
                    multiplier = float(np.linalg.norm(u)) / size
                wanted = 2 * abs(multiplier) + 1e-3 / scale
                weight = max(wanted, (weight + wanted) / 2)  # Powell 1978: it may fall again
                following, value = self._searched(u, g, step, slope, weight)
            if np.array_equal(following, u):
                if hessian.new:
                    break
                hessian, before, weight = LagrangianHessian(u.size), None, 0.0
            u, g = following, value
        x = dict(zip(self.limits.names, map(float, self.nataf.values(u)), strict=True))
        return DesignPoint(
            *(self.limits.labels[self.row], self.row, float(alpha @ u), u, x, alpha, size),
            *(abs(g) / scale, off, done, random, others, iteration),
        )

    def _searched(
        self, u: np.ndarray, g: float, step: np.ndarray, slope: np.ndarray, weight: float
    ) -> tuple[np.ndarray, float]:
        """The longest of halved steps that lowers the merit enough, by Armijo's rule.

        A step that does not is corrected back on to the surface once, for the curvature of the
        surface alone must not shorten it (Maratos's effect).
        """

        def merit(u: np.ndarray, g: float) -> float:
            return 0.5 * float(u @ u) + weight * abs(g)

        before = merit(u, g)
        falls = float((u + weight * np.sign(g) * slope) @ step)
        length, rounding = 1.0, 1e-14 * (1 + abs(before))

        def enough(u: np.ndarray, g: float) -> bool:
            wanted = before + 0.1 * length * min(falls, 0) + rounding
            return bool(np.isfinite(g) and merit(u, g) <= wanted)

        for _ in range(40):
            there = u + length * step
            value = self.value(there)
            if enough(there, value):
                return there, value
            if self.method == "sqp" and np.isfinite(value):
                corrected = there - value / float(slope @ slope) * slope
                value = self.value(corrected)
                if enough(corrected, value):
                    return corrected, value
            length /= 2
        return u, g

    def needed(self, u: np.ndarray) -> float:
        """``G(u)``, an error where a run fails."""
        g = self.value(u)
        if not np.isfinite(g):
            why = self.limits.failure
            raise AnalysisError(
                f"{self.limits.labels[self.row]}: cannot be evaluated at {self._told(u)}"
                f"{': ' if why else ''}{why}"
            )
        return g

    def _told(self, u: np.ndarray) -> str:
        x = self.nataf.values(u)
        return ", ".join(f"{n} = {v:.6g}" for n, v in zip(self.limits.names, x, strict=True))
