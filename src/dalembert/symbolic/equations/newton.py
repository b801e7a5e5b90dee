"""Newton's method: one loop, one criterion, whatever is solved and however its steps are made.

Equations ``r(x) = 0`` count as solved where every residual is small against what it is left of,

    |r_i| ≤ tolerance · scale_i + rounding_i ,

with ``scale_i`` the size of the terms whose difference ``r_i`` is: never ``r_i`` itself, nor a
number with a unit. So neither scaled rows nor scaled unknowns change an iteration. Where rounding
keeps the residual from falling further, ``slack`` times as much is accepted.

Who has equations derives from ``Equations``: ``residual`` gives values with their scale, ``step``
a way to the root, by factors, a least-squares solution or a Hessian made positive definite.
``retract`` goes there, so that ``x`` may be a point of a manifold, and ``steps`` may be replaced
where a shorter step is not a part of the longer one (Levenberg–Marquardt). ``solve`` iterates and
ends in a ``Solution`` whatever happens. The same inside a graph is ``NewtonNode``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from itertools import islice
from typing import Generic, TypeVar

import numpy as np

from dalembert.errors import SingularityError

X = TypeVar("X")
ROUNDING = 16 * float(np.finfo(float).eps)
"""What round-off leaves of a difference, relative to its terms, where nothing is said about it."""
TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True, kw_only=True)
class NewtonSettings:
    """When and how the iteration ends.

    Parameters
    ----------
    tolerance : residuals that count as zero, relative to the terms they are left of
    max_iterations : steps at most
    slack : residual, in tolerances, that is accepted where no step makes it smaller
    halvings : of a step that makes the residual larger; 0 takes full steps whatever they do
    growth : of the residual over the smallest one so far at which full steps diverge
    """

    tolerance: float
    max_iterations: int
    slack: float = 1e3
    halvings: int = 30
    growth: float = float("inf")


@dataclass(frozen=True)
class Residual:
    """What is left of equations, and what it is left of.

    Attributes
    ----------
    value : (m,) residuals
    scale : (m,) or one for all, not negative: size of their terms
    rounding : likewise, what round-off alone may leave; by default some ε of the scale
    """

    value: np.ndarray
    scale: np.ndarray | float
    rounding: np.ndarray | float | None = None

    def zero(self, tolerance: float) -> np.ndarray:
        """(m,) residuals that count as zero."""
        rounding = ROUNDING * self.scale if self.rounding is None else self.rounding
        return np.broadcast_to(tolerance * self.scale + rounding, self.value.shape)

    def relative(self, tolerance: float) -> float:
        """Largest residual relative to its scale with rounding."""
        with np.errstate(all="ignore"):
            return _largest(self.value, self.zero(tolerance)) * tolerance


class Equations(ABC, Generic[X]):
    """What ``solve`` solves; unknowns and steps are arrays unless ``retract`` says otherwise."""

    longest: np.ndarray | float = float("inf")
    """Largest size of the entries of a step, (n,) or one for all, in their units."""

    @abstractmethod
    def residual(self, x: X) -> Residual:
        """Residuals at ``x`` with their scale; what ``step`` needs beside may come along."""

    @abstractmethod
    def step(self, x: X, residual: Residual) -> np.ndarray:
        """Step to the root of the equations as they are near ``x``.

        Raises
        ------
        numpy.linalg.LinAlgError, SingularityError
            There is none.
        """

    def retract(self, x: X, step: np.ndarray) -> X:
        """Where a step leads to."""
        return x + step  # type: ignore[operator,no-any-return]

    def steps(self, x: X, residual: Residual) -> Iterator[np.ndarray]:
        """Steps in the order in which they are tried: the whole one, then its halves."""
        step = self.step(x, residual)
        step = step * np.min(self.longest / np.maximum(np.abs(step), TINY), initial=1.0)
        while True:
            yield step
            step = step / 2

    def nearer(self, here: Residual, there: Residual, zero: np.ndarray) -> bool:
        """Whether a step has led nearer to the root: by the residuals, row by row in ``zero``."""
        return bool(_norm(there.value, zero) < _norm(here.value, zero))


class Ending(StrEnum):
    """Ways in which the iteration ends."""

    CONVERGED = "converged"
    STANDSTILL = "no step makes the residual smaller"
    DIVERGED = "the residual grows"
    NOT_FINITE = "the residual is not finite"
    SINGULAR = "the equations have no single step to their root"
    ITERATIONS = "too many iterations"


@dataclass(frozen=True)
class Solution(Generic[X]):
    """Where an iteration ended.

    Attributes
    ----------
    x : unknowns
    residual : largest residual there, relative to its scale with rounding
    iterations : steps taken
    ending : Ending
    accepted : the equations count as solved
    """

    x: X
    residual: float
    iterations: int
    ending: Ending
    accepted: bool

    def __str__(self) -> str:
        counted = f"{self.iterations} iteration{'s' if self.iterations != 1 else ''}"
        return f"{self.ending.value} after {counted}, relative residual {self.residual:.3g}"


def solve(equations: Equations[X], x: X, settings: NewtonSettings) -> Solution[X]:
    """Root of equations near ``x``.

    Parameters
    ----------
    equations : Equations
    x : first guess
    settings : NewtonSettings
    """
    with np.errstate(all="ignore"):
        return _Iteration(equations, x, settings).run()


class _Iteration(Generic[X]):
    """The point reached and the best one."""

    def __init__(self, equations: Equations[X], x: X, settings: NewtonSettings):
        self.equations, self.settings = equations, settings
        self.best = self.here = self._look(x)

    def run(self) -> Solution[X]:
        """Steps until the iteration ends."""
        if not np.isfinite(self.here.size):
            return self._ended(Ending.NOT_FINITE, 0)
        for count in range(self.settings.max_iterations):
            if self.here.size <= 1:
                return self._ended(Ending.CONVERGED, count)
            try:
                ending = self._advance()
            except (np.linalg.LinAlgError, SingularityError):
                ending = Ending.SINGULAR
            if ending is not None:
                return self._ended(ending, count)
        done = Ending.CONVERGED if self.here.size <= 1 else Ending.ITERATIONS
        return self._ended(done, self.settings.max_iterations)

    def _advance(self) -> Ending | None:
        """Take a step; what ends the iteration, if something does."""
        here, equations, settings = self.here, self.equations, self.settings
        near = here.size <= settings.slack
        trials = 1 if near else settings.halvings + 1
        finite = False
        for step in islice(equations.steps(here.x, here.residual), trials):
            there = self._look(equations.retract(here.x, step))
            finite = finite or bool(np.isfinite(there.size))
            if equations.nearer(here.residual, there.residual, here.zero):
                slow = near and there.size > 1 and there.size > here.size / 2
                return self._arrive(there, Ending.STANDSTILL if slow else None)
        if near:
            return Ending.STANDSTILL
        if not finite:
            return Ending.NOT_FINITE
        if settings.halvings:
            return Ending.STANDSTILL
        lost = there.size > settings.growth * self.best.size
        return self._arrive(there, Ending.DIVERGED if lost else None)

    def _arrive(self, there: _Point[X], ending: Ending | None) -> Ending | None:
        self.here = there
        if there.size <= self.best.size:
            self.best = there
        return ending

    def _look(self, x: X) -> _Point[X]:
        residual = self.equations.residual(x)
        zero = residual.zero(self.settings.tolerance)
        return _Point(x, residual, zero, _largest(residual.value, zero))

    def _ended(self, ending: Ending, count: int) -> Solution[X]:
        found = self.here if ending is Ending.CONVERGED else self.best
        accepted = found.size <= (1 if ending is Ending.CONVERGED else self.settings.slack)
        size = found.size * self.settings.tolerance
        return Solution(found.x, size, count, ending, bool(accepted))


@dataclass(frozen=True)
class _Point(Generic[X]):
    """A point with its residuals; ``size`` is the largest in what counts as zero."""

    x: X
    residual: Residual
    zero: np.ndarray
    size: float


def _relative(value: np.ndarray, zero: np.ndarray) -> np.ndarray:
    """``|value| / zero``, where nothing is left of nothing: 0."""
    return np.where(value == 0, 0.0, np.abs(value) / zero)


def _largest(value: np.ndarray, zero: np.ndarray) -> float:
    return float(np.max(_relative(value, zero), initial=0.0))


def _norm(value: np.ndarray, zero: np.ndarray) -> float:
    return float(np.linalg.norm(_relative(value, zero)))
