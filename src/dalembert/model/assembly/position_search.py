"""Search for assembled positions from random places, where the way from one place leads nowhere.

Starts spread from the given position until bodies lie anywhere. The search repeats itself exactly:
its random numbers have a fixed seed.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.model.absolute import at_ground
from dalembert.model.assembly.assembly import MISSING_WEIGHT, Assembler
from dalembert.model.assembly.many_roots import Ends, ManyRoots
from dalembert.model.assembly.random_starts import RandomStarts
from dalembert.model.assembly.recipe import Pinned
from dalembert.model.description import Description
from dalembert.symbolic.formulas.expression import stack

SHARES = (0.1, 0.3, 1.0)
"""Largest displacements of the starts, as shares of turns and of twice the natural length."""
STARTS, WORK = 100, 1e8
"""Starts of each share at most, and the same times the cube of the number of displacements."""
ENOUGH = 10
"""Starts that lead to assembled positions before those farther away are left out."""
FARTHER = 2.0
SAME = 1e-6
"""Distance, by natural sizes, of two positions that are one."""


@dataclass(frozen=True, eq=False)
class Searched:
    """Outcome of a search.

    Attributes
    ----------
    starts : random starts
    positions : (k, n_y) assembled positions, the nearest to the given one first
    best : (n_y,) position of the smallest residual where none is assembled
    residual : that residual, relative to its natural size
    """

    starts: int
    positions: np.ndarray
    best: np.ndarray
    residual: float


class PositionSearch:
    """Assembled positions of a mechanism at an instant, the nearest to a given one first.

    Parameters
    ----------
    assembler, d : the mechanism
    t, p : instant [s] and (np,) parameter values
    """

    def __init__(self, assembler: Assembler, d: Description, t: float, p: np.ndarray):
        self.assembler, self.d, self.t, self.p = assembler, d, t, p
        self.weight = np.where(assembler.guesses.missing, MISSING_WEIGHT, 1.0)
        e, facing = (
            assembler.equations,
            at_ground(d.ground, stack(c.assembly_conditions() for c in d.constraints)),
        )
        self._facing = ca.Function("facing", [e.t, e.y, e.p], [ca.densify(facing)])

    def near(self, y: np.ndarray) -> Searched:
        """Positions that satisfy all joints, drivers and initial conditions."""
        roots = ManyRoots(self.assembler, self.t, self.p)
        return self._searched(y, roots, roots.nearest)

    def held(self, y: np.ndarray, pinned: Pinned) -> Searched:
        """Positions that satisfy the square system of the start, with what it holds."""
        roots = ManyRoots(self.assembler, self.t, self.p, pinned)
        return self._searched(y, roots, roots.newton)

    def keeping(self, y: np.ndarray, pinned: Pinned) -> np.ndarray | None:
        """An assembled position that keeps what is held, about as near to the guesses as ``y``.

        None where there is none, or only such as are ``FARTHER`` times as far.
        """
        guess = self.assembler.start(self.t, self.p).full().ravel()
        roots = ManyRoots(self.assembler, self.t, self.p, pinned)
        found = self._searched(guess, roots, roots.newton).positions
        if not len(found):
            return None
        far = np.linalg.norm(self.weight * roots.apart(guess, np.array([y, found[0]])), axis=1)
        return found[0] if far[1] <= FARTHER * far[0] else None

    def _searched(self, y: np.ndarray, roots: ManyRoots, search) -> Searched:
        a, rng = self.assembler, np.random.default_rng(0)
        starts = RandomStarts(self.d, a.equations, a.guesses, y, self.p)
        size = max(a.longest.size, 1)
        each = int(np.clip(WORK / size**3, 8, STARTS))
        ends, closed = [], np.zeros(0, dtype=bool)
        for share in SHARES:
            ends.append(search(starts.draw(each, rng, share)))
            closed = np.concatenate([closed, self._closed(ends[-1])])
            if roots.pinned is None and np.sum(closed) >= ENOUGH:
                break  # starts farther away lead farther away
        y_end, residual = (np.concatenate([getattr(e, x) for e in ends]) for x in ("y", "open"))
        positions = self._distinct(y, y_end[closed], roots)
        best = int(np.argmin(np.nan_to_num(residual, nan=np.inf)))
        return Searched(len(y_end), positions, y_end[best], float(residual[best]))

    def _closed(self, ends: Ends) -> np.ndarray:
        """(k,) which ends are assembled, with hinges the right way round."""
        a, closed = self.assembler, ends.closed.copy()
        for k in np.flatnonzero(closed):
            closed[k] = bool(np.all(a.facing(self.t, ends.y[k], self.p).full() > 0))
        return closed

    def _distinct(self, y: np.ndarray, found: np.ndarray, roots: ManyRoots) -> np.ndarray:
        """Different positions, the nearest first."""
        if not len(found):
            return found
        away = np.linalg.norm(self.weight * roots.apart(y, found), axis=1)
        turned = [np.any(self._facing(self.t, y, self.p).full() <= 0) for y in found]
        left, kept = found[np.lexsort((away, turned))], []  # hinges turned over come last
        while len(left):
            kept.append(left[0])
            left = left[np.max(np.abs(roots.apart(left[0], left)), axis=1, initial=0.0) > SAME]
        return np.array([roots.unwound(y, one) for one in kept])
