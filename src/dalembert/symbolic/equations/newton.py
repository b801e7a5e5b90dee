"""Newton's method: one loop and one criterion for all equations and step strategies.

Equations ``r(x) = 0`` are solved if every residual is small relative to its terms,

    |r_i| ≤ tolerance · scale_i + rounding_i ,

with ``scale_i`` the size of the terms whose difference is ``r_i``: never ``r_i`` itself, nor a
number with a unit. So neither scaled rows nor scaled unknowns change an iteration. If rounding
keeps the residual from falling further, ``slack`` times as much is accepted.

Equations derive from ``Equations``: ``residual`` returns values with their scale, ``step`` a step
towards the root, by factors, least squares or a Hessian made positive definite. ``retract``
applies a step, so that ``x`` may be a point of a manifold, and ``steps`` may be overridden if a
shorter step is not a fraction of the longer one (Levenberg–Marquardt). ``solve`` iterates and
always returns a ``Solution``. ``NewtonNode`` is the same iteration inside a graph.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from itertools import islice
from typing import Any, Generic, TypeVar

import numpy as np

from dalembert.errors import SingularityError
from dalembert.text.wording import counted

X = TypeVar("X")
ROUNDING = 16 * float(np.finfo(float).eps)
"""Default round-off of a difference, relative to its terms."""
TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True, kw_only=True)
class NewtonSettings:
    """Stopping criteria and step control.

    Parameters
    ----------
    tolerance : threshold for residuals, relative to the terms whose difference they are
    max_iterations : upper limit of steps
    slack : residual, in tolerances, that is accepted if no step reduces it further
    halvings : of a step that increases the residual; 0 always takes full steps
    growth : threshold for divergence: ratio of the residual to the smallest so far
    """

    tolerance: float
    max_iterations: int
    slack: float = 1e3
    halvings: int = 30
    growth: float = float("inf")

    def near(self, size: Any) -> Any:
        """Whether residuals of this size, in thresholds, are accepted if no step reduces them."""
        return size <= self.slack

    def slow(self, before: Any, after: Any) -> Any:
        """Whether rounding limits the residuals: they are near and a step hardly reduces them."""
        return self.near(before) & (after > 1) & (after > before / 2)

    def diverged(self, size: Any, smallest: Any) -> Any:
        """Whether residuals have grown too far above the smallest ones."""
        return size > self.growth * smallest


@dataclass(frozen=True)
class Residual:
    """Residuals of equations with the size of their terms.

    Attributes
    ----------
    value : (m,) residuals
    scale : (m,) or scalar, not negative: size of their terms
    rounding : (m,) or scalar: round-off error of the residuals; by default ``ROUNDING · scale``
    """

    value: np.ndarray
    scale: np.ndarray | float
    rounding: np.ndarray | float | None = None

    def zero(self, tolerance: float) -> np.ndarray:
        """(m,) thresholds below which residuals are zero."""
        rounding = ROUNDING * self.scale if self.rounding is None else self.rounding
        return np.broadcast_to(tolerance * self.scale + rounding, self.value.shape)

    def relative(self, tolerance: float) -> float:
        """Largest residual relative to its scale with rounding."""
        with np.errstate(all="ignore"):
            return float(largest(self.value, self.zero(tolerance)) * tolerance)


class Equations(ABC, Generic[X]):
    """Equations for ``solve``; unknowns and steps are arrays unless ``retract`` is overridden."""

    longest: np.ndarray | float = float("inf")
    """Upper limit of the entries of a step, (n,) or scalar, in their units."""

    @abstractmethod
    def residual(self, x: X) -> Residual:
        """Residuals at ``x`` with their scale; a subclass may add data for ``step``."""

    @abstractmethod
    def step(self, x: X, residual: Residual) -> np.ndarray:
        """Step to the root of the linearised equations at ``x``.

        Raises
        ------
        numpy.linalg.LinAlgError, SingularityError
            The linearised equations are singular.
        """

    def retract(self, x: X, step: np.ndarray) -> X:
        """Point reached from ``x`` by a step."""
        return x + step  # type: ignore[operator,no-any-return]

    def steps(self, x: X, residual: Residual) -> Iterator[np.ndarray]:
        """Trial steps in order: the full step, then its halves."""
        step = self.step(x, residual)
        step = step * np.min(self.longest / np.maximum(np.abs(step), TINY), initial=1.0)
        while True:
            yield step
            step = step / 2

    def nearer(self, here: Residual, there: Residual, zero: np.ndarray) -> bool:
        """Whether a step reduces the residuals, measured in their thresholds ``zero``."""
        return bool(_norm(there.value, zero) < _norm(here.value, zero))


class Ending(StrEnum):
    """Termination reasons of the iteration."""

    CONVERGED = "converged"
    STANDSTILL = "no step reduces the residual"
    DIVERGED = "the residual grows"
    NOT_FINITE = "the residual is not finite"
    SINGULAR = "the linearised equations are singular"
    ITERATIONS = "too many iterations"


@dataclass(frozen=True)
class Solution(Generic[X]):
    """Result of an iteration.

    Attributes
    ----------
    x : unknowns
    residual : largest residual at x, relative to its scale with rounding
    iterations : number of steps
    ending : Ending
    accepted : whether the equations are solved
    """

    x: X
    residual: float
    iterations: int
    ending: Ending
    accepted: bool

    def __str__(self) -> str:
        iterations = counted(self.iterations, "iteration")
        return f"{self.ending.value} after {iterations}, relative residual {self.residual:.3g}"


def solve(equations: Equations[X], x: X, settings: NewtonSettings) -> Solution[X]:
    """Root of equations near ``x``.

    Parameters
    ----------
    equations : Equations
    x : initial guess
    settings : NewtonSettings
    """
    with np.errstate(all="ignore"):
        return _Iteration(equations, x, settings).run()


class _Iteration(Generic[X]):
    """State of the iteration: the current point and the best one."""

    def __init__(self, equations: Equations[X], x: X, settings: NewtonSettings):
        self.equations, self.settings = equations, settings
        self.best = self.current = self._evaluate(x)

    def run(self) -> Solution[X]:
        """Iterate until a termination criterion is met."""
        if not np.isfinite(self.current.size):
            return self._solution(Ending.NOT_FINITE, 0)
        for count in range(self.settings.max_iterations):
            if self.current.size <= 1:
                return self._solution(Ending.CONVERGED, count)
            try:
                ending = self._advance()
            except (np.linalg.LinAlgError, SingularityError):
                ending = Ending.SINGULAR
            if ending is not None:
                return self._solution(ending, count)
        ending_at_limit = Ending.CONVERGED if self.current.size <= 1 else Ending.ITERATIONS
        return self._solution(ending_at_limit, self.settings.max_iterations)

    def _advance(self) -> Ending | None:
        """Take a step; the reason to terminate, if there is one."""
        here, equations, settings = self.current, self.equations, self.settings
        near = settings.near(here.size)
        trials = 1 if near else settings.halvings + 1
        finite = False
        for step in islice(equations.steps(here.x, here.residual), trials):
            there = self._evaluate(equations.retract(here.x, step))
            finite = finite or bool(np.isfinite(there.size))
            if equations.nearer(here.residual, there.residual, here.zero):
                slow = settings.slow(here.size, there.size)
                return self._arrive(there, Ending.STANDSTILL if slow else None)
        if near:
            return Ending.STANDSTILL
        if not finite:
            return Ending.NOT_FINITE
        if settings.halvings:
            return Ending.STANDSTILL
        diverged = settings.diverged(there.size, self.best.size)
        return self._arrive(there, Ending.DIVERGED if diverged else None)

    def _arrive(self, there: _Point[X], ending: Ending | None) -> Ending | None:
        self.current = there
        if there.size <= self.best.size:
            self.best = there
        return ending

    def _evaluate(self, x: X) -> _Point[X]:
        residual = self.equations.residual(x)
        zero = residual.zero(self.settings.tolerance)
        return _Point(x, residual, zero, float(largest(residual.value, zero)))

    def _solution(self, ending: Ending, count: int) -> Solution[X]:
        point = self.current if ending is Ending.CONVERGED else self.best
        accepted = ending is Ending.CONVERGED or self.settings.near(point.size)
        size = point.size * self.settings.tolerance
        return Solution(point.x, size, count, ending, bool(accepted))


@dataclass(frozen=True)
class _Point(Generic[X]):
    """A point with its residuals; ``size`` is the largest one relative to its threshold."""

    x: X
    residual: Residual
    zero: np.ndarray
    size: float


def relative(value: np.ndarray, zero: np.ndarray) -> np.ndarray:
    """``|value| / zero``, and 0 for a residual of zero."""
    return np.where(value == 0, 0.0, np.abs(value) / zero)


def largest(value: np.ndarray, zero: np.ndarray) -> np.ndarray:
    """Largest ``|value| / zero`` along the last axis."""
    return np.max(relative(value, zero), axis=-1, initial=0.0)  # type: ignore[no-any-return]


def _norm(value: np.ndarray, zero: np.ndarray) -> float:
    return float(np.linalg.norm(relative(value, zero)))
