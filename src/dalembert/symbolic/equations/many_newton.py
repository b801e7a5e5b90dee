"""Newton's method for many designs at once, by the criteria of ``newton.py``.

Arrays have the design as first axis. Every design takes its own steps and ends on its own;
those that still iterate are evaluated together.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from copy import copy, deepcopy
from dataclasses import dataclass, field, fields
from typing import Generic, Self, TypeVar

import numpy as np

from dalembert.symbolic.equations.newton import NewtonSettings, largest, relative


@dataclass(eq=False)
class Points:
    """Points of many designs with their residuals; a subclass may add arrays for the steps.

    Attributes
    ----------
    x : (k, n) unknowns
    value : (k, m) residuals
    zero : (k, m) thresholds below which they are zero
    size : (k,) largest residual relative to its threshold
    """

    x: np.ndarray
    value: np.ndarray
    zero: np.ndarray
    size: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        self.size = np.asarray(largest(self.value, self.zero))

    def some(self, designs: np.ndarray) -> Self:
        """The points of selected designs, by number or by flag; itself if all are selected."""
        if np.all(designs) if designs.dtype == bool else designs.size == len(self.x):
            return self
        part = copy(self)
        for f in fields(self):
            setattr(part, f.name, getattr(self, f.name)[designs])
        return part

    def put(self, designs: np.ndarray, points: Self) -> None:
        """Replace the points of selected designs."""
        for f in fields(self):
            getattr(self, f.name)[designs] = getattr(points, f.name)


P = TypeVar("P", bound=Points)


class ManyEquations(ABC, Generic[P]):
    """Equations of many designs for ``solve_many``; ``designs`` are their numbers."""

    @abstractmethod
    def points(self, x: np.ndarray, designs: np.ndarray) -> P:
        """Points with their residuals; not finite where undefined."""

    @abstractmethod
    def steps(self, here: P, designs: np.ndarray) -> np.ndarray:
        """Steps to the roots of the linearised equations, not finite where singular."""

    def after(self, here: P, steps: np.ndarray, designs: np.ndarray) -> P:
        """Points reached by steps."""
        return self.points(here.x + steps, designs)

    def nearer(self, here: P, there: P) -> np.ndarray:
        """(k,) whether steps reduce the residuals, measured in their thresholds."""
        norms = (np.linalg.norm(relative(p.value, here.zero), axis=1) for p in (there, here))
        return np.less(*norms)


@dataclass(frozen=True)
class ManySolutions(Generic[P]):
    """Results of an iteration.

    Attributes
    ----------
    points : P, roots, or the points of the smallest residual
    iterations : (k,) numbers of steps
    accepted : (k,) whether the equations are solved
    """

    points: P
    iterations: np.ndarray
    accepted: np.ndarray


def solve_many(
    equations: ManyEquations[P], x: np.ndarray, settings: NewtonSettings
) -> ManySolutions[P]:
    """Roots of the equations of many designs near ``x``, (k, n).

    Parameters
    ----------
    equations : ManyEquations
    x : initial guesses
    settings : NewtonSettings
    """
    with np.errstate(all="ignore"):
        here = equations.points(x.copy(), np.arange(len(x)))
        best, iterations = deepcopy(here), np.zeros(len(x), dtype=int)
        ended = ~np.isfinite(here.size)
        for _ in range(settings.max_iterations):
            ended |= here.size <= 1
            if not (active := np.flatnonzero(~ended)).size:
                break
            taken, ended[active] = _advance(equations, here, best, active, settings)
            iterations[active[taken]] += 1
            better = active[here.size[active] <= best.size[active]]
            best.put(better, here.some(better))
    converged = best.size <= 1
    return ManySolutions(best, iterations, converged | (best.size <= settings.slack))


def _advance(
    equations: ManyEquations[P], here: P, best: P, active: np.ndarray, settings: NewtonSettings
) -> tuple[np.ndarray, np.ndarray]:
    """Take a step of the active designs; flags of those that took one, and of those that end."""
    before = here.some(active)
    steps, near = equations.steps(before, active).copy(), settings.near(before.size)
    taken, ended = np.zeros(active.size, dtype=bool), np.ones(active.size, dtype=bool)
    waiting = np.flatnonzero(np.isfinite(steps).all(axis=1))
    for _ in range(settings.halvings + 1):
        if not waiting.size:
            break
        old = before.some(waiting)
        new = equations.after(old, steps[waiting], active[waiting])
        finite = np.isfinite(new.size)
        nearer = finite & equations.nearer(old, new)
        accepted = nearer | (finite & ~near[waiting] & (settings.halvings == 0))
        slow = settings.slow(old.size, new.size)
        diverged = ~nearer & settings.diverged(new.size, best.size[active[waiting]])
        chosen = waiting[accepted]
        here.put(active[chosen], new.some(accepted))
        taken[chosen], ended[chosen] = True, (slow & nearer | diverged)[accepted]
        waiting = waiting[~accepted & ~near[waiting]]
        steps[waiting] /= 2
    return taken, ended
