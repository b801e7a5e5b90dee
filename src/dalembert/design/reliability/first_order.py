"""First-order reliability: the point of a limit state that is nearest to the origin of ``u``.

Hasofer and Lind's index ``β = αᵀu*`` of the point ``u*`` with ``G(u*) = 0``, ``α = −∇G/|∇G|``.
The methods are sequential quadratic programming, the iteration of Rackwitz and Fiessler (HL-RF),
and the improved iteration of Zhang and Der Kiureghian (1995); the first and the last use a line
search on the merit function ``|u|²/2 + c|G|``.

A step ``d`` and its multiplier ``λ`` solve ``B d + λ∇G = −u``, ``∇Gᵀd = −G``. ``B = I`` is the step
of Rackwitz and Fiessler, which converges only if the curvature of the surface is less than that of
the sphere about the origin, ``|βκ| < 1``. Otherwise ``B`` approximates the Hessian of
``|u|²/2 + λG`` by damped BFGS updates (Powell 1978; Liu and Der Kiureghian, Structural Safety 9,
1991), which also converges for strongly curved surfaces.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dalembert.design.methods.search_options import check_stop
from dalembert.design.reliability.limit_state import LimitStates
from dalembert.design.reliability.nataf import Nataf
from dalembert.errors import AnalysisError, UnsupportedError

METHODS = ("sqp", "improved-hlrf", "hlrf")
DAMPING = 0.2
"""Smallest ratio of measured to predicted curvature of an undamped update."""
CONDITION = 1e-10
"""Threshold for a restart of ``B``: ratio of its smallest to its largest eigenvalue."""


@dataclass
class LagrangianHessian:
    """Quasi-Newton approximation ``B`` of the Hessian of the Lagrangian, positive definite.

    Parameters
    ----------
    size : n, number of variables
    """

    size: int
    matrix: np.ndarray = field(init=False)
    new: bool = field(init=False)

    def __post_init__(self) -> None:
        self.matrix, self.new = np.eye(self.size), True

    def step(self, u: np.ndarray, g: float, slope: np.ndarray) -> tuple[np.ndarray, float]:
        """(n,) ``d`` and ``λ``."""
        solutions = np.linalg.solve(self.matrix, np.column_stack([u, slope]))
        multiplier = (g - slope @ solutions[:, 0]) / (slope @ solutions[:, 1])
        return -solutions @ np.array([1.0, multiplier]), float(multiplier)

    def update(self, displacement: np.ndarray, change: np.ndarray) -> None:
        """Damped BFGS update.

        Parameters
        ----------
        displacement : (n,) difference of two points
        change : (n,) difference of the gradients of the Lagrangian at these points
        """
        image = self.matrix @ displacement
        predicted, self.new = float(displacement @ image), False
        if not predicted > 1e-30:
            return
        measured = float(displacement @ change)
        if measured < DAMPING * predicted:
            fraction = (1 - DAMPING) * predicted / (predicted - measured)
            change = fraction * change + (1 - fraction) * image
            measured = float(displacement @ change)
        self.matrix = (
            self.matrix - np.outer(image, image) / predicted + np.outer(change, change) / measured
        )
        sizes = np.linalg.eigvalsh(self.matrix)
        if not sizes[0] > CONDITION * sizes[-1]:
            self.__post_init__()


@dataclass(frozen=True)
class DesignPoint:
    """Most probable failure point of a limit state.

    Attributes
    ----------
    limit : label of the limit state
    beta : reliability index, negative if the median fails
    u : (n,) in independent standard normal variables
    x : random parameter → value
    alpha : (n,) unit vector towards failure
    slope : ``|∇G|``
    residual : ``|G(u*)|`` over ``|G|`` at the median; zero on the limit state
    ray_distance : distance of ``u*`` from the ray along ``α``; zero at the nearest point
    converged : whether both are within the tolerance
    gradient, other_gradient : of ``g`` by the random and by the other parameters
    iterations : number of iterations
    curvatures : (n − 1,) principal curvatures of the surface; None before they are computed
    """

    limit: str
    row: int
    beta: float
    u: np.ndarray
    x: dict[str, float]
    alpha: np.ndarray
    slope: float
    residual: float
    ray_distance: float
    converged: bool
    gradient: np.ndarray
    other_gradient: np.ndarray
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
    tolerance : of residual and distance
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
            raise UnsupportedError(f"unknown method {self.method!r}; known: {', '.join(METHODS)}")

    def value(self, u: np.ndarray) -> float:
        """``G(u)``; NaN if a run fails."""
        return float(self.limits.values(self.nataf.values(u))[self.row])

    def slope(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """``∇G``, and ``∂g`` by random and other parameters."""
        random, other = self.limits.gradients(self.nataf.values(u))
        return self.nataf.slopes(u).T @ random[self.row], random[self.row], other[self.row]

    def solve(self, start: np.ndarray, scale: float) -> DesignPoint:
        """The design point reached from a start.

        Parameters
        ----------
        scale : magnitude of ``G``, its value at the median

        Raises
        ------
        AnalysisError
            A run fails, or the limit state does not depend on the random parameters.
        """
        u, weight = start, 0.0
        g, hessian = self.finite_value(u), LagrangianHessian(start.size)
        previous: tuple[np.ndarray, np.ndarray, float] | None = None
        for iteration in range(self.max_iterations + 1):
            slope, random, other_gradient = self.slope(u)
            size = float(np.linalg.norm(slope))
            if not size > 0:
                raise AnalysisError(
                    f"{self.limits.labels[self.row]}: does not change with the random parameters "
                    f"at {self._point_text(u)}; its gradient is {size:g}"
                )
            alpha = -slope / size
            ray_distance = float(np.linalg.norm(u - (alpha @ u) * alpha))
            radius = max(1.0, float(np.linalg.norm(u)))
            done = abs(g) <= self.tolerance * scale and ray_distance <= self.tolerance**0.5 * radius
            exact = done and ray_distance <= 10 * self.tolerance * radius
            if exact or iteration == self.max_iterations:
                break
            if previous is not None and self.method == "sqp":
                displacement = u - previous[0]
                hessian.update(displacement, displacement + previous[2] * (slope - previous[1]))
            step, multiplier = hessian.step(u, g, slope)
            previous = u, slope, multiplier
            if self.method == "hlrf":
                following, value = u + step, self.finite_value(u + step)
            else:
                if self.method == "improved-hlrf":
                    multiplier = float(np.linalg.norm(u)) / size
                required_weight = 2 * abs(multiplier) + 1e-3 / scale
                # Powell 1978: the weight may decrease
                weight = max(required_weight, (weight + required_weight) / 2)
                following, value = self._line_search(u, g, step, slope, weight)
            if np.array_equal(following, u):
                if hessian.new:
                    break
                hessian, previous, weight = LagrangianHessian(u.size), None, 0.0
            u, g = following, value
        x = dict(zip(self.limits.names, map(float, self.nataf.values(u)), strict=True))
        return DesignPoint(
            *(self.limits.labels[self.row], self.row, float(alpha @ u), u, x, alpha, size),
            *(abs(g) / scale, ray_distance, done, random, other_gradient, iteration),
        )

    def _line_search(
        self, u: np.ndarray, g: float, step: np.ndarray, slope: np.ndarray, weight: float
    ) -> tuple[np.ndarray, float]:
        """Backtracking line search with the Armijo condition on the merit function.

        A rejected step is projected on the surface once, so that the curvature of the surface does
        not shorten it (Maratos effect).
        """

        def merit_function(u: np.ndarray, g: float) -> float:
            return 0.5 * float(u @ u) + weight * abs(g)

        initial_merit = merit_function(u, g)
        directional_derivative = float((u + weight * np.sign(g) * slope) @ step)
        length, rounding = 1.0, 1e-14 * (1 + abs(initial_merit))

        def sufficient_decrease(u: np.ndarray, g: float) -> bool:
            bound = initial_merit + 0.1 * length * min(directional_derivative, 0) + rounding
            return bool(np.isfinite(g) and merit_function(u, g) <= bound)

        for _ in range(40):
            trial = u + length * step
            value = self.value(trial)
            if sufficient_decrease(trial, value):
                return trial, value
            if self.method == "sqp" and np.isfinite(value):
                corrected = trial - value / float(slope @ slope) * slope
                value = self.value(corrected)
                if sufficient_decrease(corrected, value):
                    return corrected, value
            length /= 2
        return u, g

    def finite_value(self, u: np.ndarray) -> float:
        """``G(u)``; an error if a run fails."""
        g = self.value(u)
        if not np.isfinite(g):
            reason = self.limits.failure
            raise AnalysisError(
                f"{self.limits.labels[self.row]}: cannot be evaluated at {self._point_text(u)}"
                f"{': ' if reason else ''}{reason}"
            )
        return g

    def _point_text(self, u: np.ndarray) -> str:
        x = self.nataf.values(u)
        return ", ".join(f"{n} = {v:.6g}" for n, v in zip(self.limits.names, x, strict=True))
