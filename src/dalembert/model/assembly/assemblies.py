"""All ways in which a mechanism closes.

The square system of the start (independent equations, and what is held of the given places) has as
many roots as the mechanism has assemblies. They are looked for from random places. Roots known
already are deflated: residuals count ``m = Π (1 + 1/|x − x_k|²)`` times, so that steps shy away
from them (P. Farrell, Á. Birkisson and S. Funke 2015).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from dalembert.model.absolute import at_ground
from dalembert.model.assembly.closure import Closure
from dalembert.model.assembly.recipe import Square
from dalembert.symbolic.equations import newton
from dalembert.symbolic.formulas.expression import stack

SETTINGS = newton.NewtonSettings(tolerance=1e-14, max_iterations=60, slack=1e3, halvings=8)
CLOSED = 1e-10
"""Largest residual of an assembly, by natural sizes."""
SAME = 1e-6
"""Distance, by natural sizes, of two assemblies that are one."""
PATIENCE, MORE = 40, 10
"""Starts in a row that lead to nothing new before the search ends: at least, and per root."""
MOST = 2000
"""Starts at all."""
REACH = 2.0
"""How far bodies are thrown, in natural lengths."""


class Assemblies:
    """Assemblies of one mechanism at an instant.

    Parameters
    ----------
    closure : Closure of the mechanism
    t, p : instant [s] and (np,) parameter values

    Attributes
    ----------
    known : (n_y,) positions found
    """

    def __init__(self, closure: Closure, t: float, p: np.ndarray):
        self.closure, self.pinned = closure, closure.pinned.at(t, p)
        self.manifold, guesses = closure.all_equations.manifold, closure.guesses
        self.sizes = closure.scales.displacements
        self.angles = np.array(guesses.angles, dtype=bool)
        self.turns = np.array([unit == "rad" for unit in guesses.speed_units], dtype=bool)
        self.known: list[np.ndarray] = []
        e, parts = closure.all_equations, closure.description.constraints
        facing = at_ground(closure.description.ground, stack(c.facing() for c in parts))
        self._facing = ca.Function("facing", [e.t, e.y, e.p], [facing])
        self.t, self.p = t, p

    def facing(self, y: np.ndarray) -> np.ndarray:
        """Which way round the joints are put together, by signs."""
        return np.sign(self._facing(self.t, y, self.p).full().ravel())

    def search(self, first: np.ndarray, count: int | None, rng: np.random.Generator) -> None:
        """Find others than the first one, until there are so many or none is new."""
        self.known.append(first)
        idle = 0
        for _ in range(MOST):
            enough = idle >= PATIENCE + MORE * len(self.known)
            if enough if count is None else len(self.known) >= count:
                return
            found = newton.solve(_Deflated(self), self.thrown(first, rng), SETTINGS)
            new = self.is_new(found.x)
            idle = 0 if new else idle + 1
            if new:
                self.known.append(found.x)

    def thrown(self, y: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        """Somewhere else: a few natural lengths away, turned anyhow."""
        way = rng.uniform(-1, 1, self.sizes.size)
        turned = np.where(self.angles, np.pi * way, 2 * np.tan(np.pi / 2 * way))
        return self.manifold.go(y, self.sizes * np.where(self.turns, turned, REACH * way))

    def apart(self, y: np.ndarray, other: np.ndarray) -> np.ndarray:
        """(n,) displacement from one place to another, by natural sizes and without whole turns."""
        way = self.manifold.lead(y, other) / self.sizes
        return np.where(self.angles, np.remainder(way + np.pi, 2 * np.pi) - np.pi, way)

    def is_new(self, y: np.ndarray) -> bool:
        """It closes with its joints the same way round, and is none of those known."""
        with np.errstate(all="ignore"):
            residual = self.pinned.residual(y)
            open_by = np.max(np.abs(residual.value / residual.scale), initial=0.0)
        if not open_by <= CLOSED:
            return False
        if np.any(self.facing(y) != self.facing(self.known[0])):
            return False
        return all(np.max(np.abs(self.apart(x, y)), initial=0.0) > SAME for x in self.known)


@dataclass(frozen=True)
class _Shunned(Square):
    """Deflated residuals; ``plain`` are those of the mechanism, ``growth`` is ``m``."""

    plain: Square = field(kw_only=True)
    growth: float = field(kw_only=True)


class _Deflated(newton.Equations[np.ndarray]):
    """The square system without the roots known."""

    def __init__(self, assemblies: Assemblies):
        self.of, self.pinned = assemblies, assemblies.pinned
        self.longest = assemblies.pinned.longest

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        return self.of.manifold.go(x, step)

    def _ways(self, x: np.ndarray) -> list[np.ndarray]:
        return [self.of.apart(root, x) for root in self.of.known]

    def residual(self, x: np.ndarray) -> _Shunned:
        plain = self.pinned.residual(x)
        growth = float(np.prod([1 + 1 / (way @ way) for way in self._ways(x)]))
        rounding = np.asarray(plain.rounding) * growth
        return _Shunned(
            plain.value * growth,
            plain.scale,
            rounding,
            entries=plain.entries,
            plain=plain,
            growth=growth,
        )

    def step(self, x: np.ndarray, residual: newton.Residual) -> np.ndarray:
        """Newton's, lengthened or turned round: ``δ / (1 − m'δ/m)``."""
        assert isinstance(residual, _Shunned)
        step = self.pinned.step(x, residual.plain)
        natural, slope = step / self.of.sizes, 0.0
        for way in self._ways(x):
            square = way @ way
            slope -= 2 * (way @ natural) / (square * (square + 1))
        return step / (1 - slope)
