"""First-order reliability: the point of a limit state that is nearest to the origin of ``u``.

Hasofer and Lind's index ``β = αᵀu*`` of the point ``u*`` with ``G(u*) = 0``, ``α = −∇G/|∇G|``,
found by the iteration of Rackwitz and Fiessler (HL-RF), or the improved one of Zhang and Der
Kiureghian (1995) with a line search on the merit ``|u|²/2 + c|G|``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.design.methods.stop import check_stop
from dalembert.design.reliability.limit_state import LimitStates
from dalembert.design.reliability.nataf import Nataf
from dalembert.errors import AnalysisError, UnsupportedError

METHODS = ("improved-hlrf", "hlrf")
NEGLIGIBLE = 1e-6
STARTS = 3
"""Searches from beside a median at which the limit state does not change."""
BESIDE = 0.1
"""How far from a point, of its index, it is looked whether the limit state bends back there."""


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
    method: str = "improved-hlrf"
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
        g = self.needed(u)
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
            step = (slope @ u - g) / size**2 * slope - u
            if self.method == "hlrf":
                following, value = u + step, self.needed(u + step)
            else:
                weight = max(weight, 2 * float(np.linalg.norm(u)) / size + 1e-3 / scale)
                following, value = self._searched(u, g, step, slope, weight)
            if np.array_equal(following, u):
                break
            u, g = following, value
        x = dict(zip(self.limits.names, map(float, self.nataf.values(u)), strict=True))
        return DesignPoint(
            *(self.limits.labels[self.row], self.row, float(alpha @ u), u, x, alpha, size),
            *(abs(g) / scale, off, done, random, others, iteration),
        )

    def _searched(
        self, u: np.ndarray, g: float, step: np.ndarray, slope: np.ndarray, weight: float
    ) -> tuple[np.ndarray, float]:
        """The longest of halved steps that lowers the merit enough, by Armijo's rule."""

        def merit(u: np.ndarray, g: float) -> float:
            return 0.5 * float(u @ u) + weight * abs(g)

        before = merit(u, g)
        falls = float((u + weight * np.sign(g) * slope) @ step)
        length = 1.0
        for _ in range(40):
            value = self.value(u + length * step)
            rounding = 1e-14 * (1 + abs(before))
            if np.isfinite(value) and (
                merit(u + length * step, value) <= before + 0.1 * length * min(falls, 0) + rounding
            ):
                return u + length * step, value
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


def _first(search: Search, scale: float, rng: Any) -> DesignPoint:
    """The point reached from the median, or from beside it where no gradient shows the way there.

    Raises
    ------
    AnalysisError
        None of these searches can be made.
    """
    n = search.nataf.size
    try:
        return search.solve(np.zeros(n), scale)
    except AnalysisError:
        if np.any(search.slope(np.zeros(n))[0]):
            raise
        for _ in range(STARTS):
            direction = rng.normal(size=n)
            try:
                return search.solve(direction / np.linalg.norm(direction), scale)
            except AnalysisError:
                continue
        raise


def _nearest(search: Search, point: DesignPoint, scale: float) -> DesignPoint:
    """The point itself, unless the limit state bends around the origin there.

    Then points beside it on the sphere of the same index fail already, and the search goes on from
    one of them: from a median on an axis of symmetry it may have come to the farthest point.
    """
    u, beta = point.u, point.beta
    beside = np.random.default_rng(0).normal(size=u.size)
    beside -= (beside @ point.alpha) * point.alpha
    size = float(np.linalg.norm(beside))
    if not (point.converged and beta > 0 and size > 1e-6):
        return point
    there = u + BESIDE * max(beta, 1.0) * beside / size
    there *= beta / np.linalg.norm(there)
    if not search.value(there) < -10 * search.tolerance * scale:
        return point
    try:
        nearer = search.solve(there, scale)
    except AnalysisError:
        return point
    return nearer if nearer.converged and nearer.beta < beta else point


def design_points(search: Search, starts: int, rng: Any) -> list[DesignPoint]:
    """Design points of a limit state from the median and from starts around it, nearest first.

    Points that matter less than ``NEGLIGIBLE`` of the nearest are left out.

    Raises
    ------
    AnalysisError
        Not even the search from the median can be made.
    """
    n = search.nataf.size
    scale = abs(search.needed(np.zeros(n)))
    scale = scale or abs(search.needed(np.full(n, 0.1))) or 1.0
    found = [_nearest(search, _first(search, scale, rng), scale)]
    radius = max(abs(found[0].beta), 1.0)
    for _ in range(starts - 1):
        direction = rng.normal(size=n)
        begin = radius * direction / np.linalg.norm(direction)
        try:
            one = search.solve(begin, scale)
        except AnalysisError:
            continue
        near = 0.05 * max(abs(one.beta), 1.0)
        if one.converged and all(np.linalg.norm(one.u - other.u) > near for other in found):
            found.append(one)
    some = sorted([o for o in found if o.converged] or found, key=lambda one: one.beta)
    return [o for o in some if o is some[0] or o.probability > NEGLIGIBLE * some[0].probability]
