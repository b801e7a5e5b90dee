"""All assembly configurations of a mechanism.

The square system of the start (independent equations, and what is held of the given places) has as
many roots as the mechanism has assemblies. Newton's method from random positions finds them, many
at once; how often each root is reached decides when to stop and what may be missing.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.model.absolute import at_ground
from dalembert.model.assembly.closure import Closure
from dalembert.model.assembly.completeness import Completeness, covered
from dalembert.model.assembly.many_roots import ManyRoots
from dalembert.model.assembly.random_starts import RandomStarts
from dalembert.symbolic.evaluation.backends import VirtualMachine
from dalembert.symbolic.evaluation.shared_columns import in_blocks
from dalembert.symbolic.formulas.expression import stack

CLOSED, IMPLIED = 1e-10, 1e-9
"""Largest residual of an assembly, by natural sizes; of equations that others imply."""
SAME, SAME_SINGULAR = 1e-6, 1e-3
"""Distance, by natural sizes, of two assemblies that are one; where the equations are singular."""
SINGULAR = 1e-6
"""Smallest singular value relative to the largest at which equations count as singular."""
LEAST, EACH, RAREST = 800, 200, 10
"""Successful starts before the search ends: at least, per assembly, for the rarest one."""
MOST, WORK = 60_000, 3e9
"""Starts at most, and the same times the cube of the number of displacements."""
ALONG = 1e-2
"""Displacement along which an assembly that is not isolated stays closed."""


class Assemblies:
    """Assemblies of one mechanism at an instant.

    Parameters
    ----------
    closure : Closure of the mechanism
    t, p : instant [s] and (np,) parameter values

    Attributes
    ----------
    known : (n_y,) positions, the first one first, then the nearest to it
    hits : how many starts led to each
    """

    def __init__(self, closure: Closure, t: float, p: np.ndarray):
        self.closure, self.t, self.p = closure, t, p
        self.roots = ManyRoots(closure.assembler, t, p, closure.pinned)
        self.joints = ManyRoots(closure.assembler, t, p)
        self.sizes = closure.scales.displacements
        self.known: list[np.ndarray] = []
        self.hits: list[int] = []
        self.singular: list[bool] = []
        self.not_isolated = 0
        e, parts = closure.all_equations, closure.description.constraints
        conditions = stack(c.assembly_conditions() for c in parts)
        facing = at_ground(closure.description.ground, conditions)
        self._facing = ca.Function("facing", [e.t, e.y, e.p], [ca.densify(facing)])

    def search(
        self, first: np.ndarray | None, count: int | None, rng: np.random.Generator
    ) -> Completeness:
        """Find all, or so many; the first one is known already, or None.

        Without a first one, joints are put together as they are in the nominal assembly.
        """
        closure, size = self.closure, self.sizes.size
        anchor = closure.anchor[1]
        self.reference = np.sign(self._face(anchor[None])[0])
        if first is not None:
            self._append(first, 0, not self._regular(first[None])[0])
        starts = RandomStarts(
            closure.description, closure.all_equations, closure.guesses, anchor, self.p
        )
        most = int(np.clip(WORK / max(size, 1) ** 3, 40, MOST))
        done, ended = 0, f"the search ended at its limit of {most} starts"
        while done < most:
            batch = min(256 if done < 1024 else 1024, most - done)
            self._take(self.roots.newton(starts.draw(batch, rng)).y)
            done += batch
            if count is not None and len(self.known) >= count:
                ended = f"the search ended at the requested number of {count}"
                break
            if count is None and self._covered(done):
                ended = "every assembly was reached often enough"
                break
        self._order(first, count)
        return Completeness(done, tuple(self.hits), self.not_isolated, ended)

    def _covered(self, starts: int) -> bool:
        """Whether the search may end; singular assemblies are reached by chance only."""
        hits = [h for h, singular in zip(self.hits, self.singular, strict=True) if not singular]
        return covered(hits, LEAST, EACH, RAREST) if hits else starts >= 5 * LEAST

    def _append(self, y: np.ndarray, hits: int, singular: bool) -> None:
        self.known.append(y)
        self.hits.append(hits)
        self.singular.append(singular)

    def _order(self, first: np.ndarray | None, count: int | None) -> None:
        """The nearest to the first one, or to the nominal assembly, first."""
        if not self.known:
            return
        near = self.closure.anchor[1] if first is None else first
        far = np.linalg.norm(self.roots.apart(near, np.array(self.known)), axis=1)
        order = np.argsort(far, kind="stable")[:count]
        for name in ("known", "hits", "singular"):
            values = getattr(self, name)
            setattr(self, name, [values[k] for k in order])
        begin = 0 if first is None else 1
        self.known[begin:] = [self.roots.unwound(near, y) for y in self.known[begin:]]

    # which ends are assemblies, and which of them are the same ----------------------------------
    def _face(self, y: np.ndarray) -> np.ndarray:
        columns = VirtualMachine().columns(self._facing)
        t, p = np.full((len(y), 1), self.t), np.tile(self.p, (len(y), 1))
        return in_blocks(columns, 1, t, y, p)[0]

    def _take(self, y: np.ndarray) -> None:
        """Count the ends that are assemblies, and keep those that are new."""
        y = y[self._assembled(y)]
        for k in range(len(self.known)):
            y = y[~self._same(k, y)]
        regular = self._regular(y)
        while len(y):
            if not regular[0] and self._continuous(y[0]):
                self.not_isolated += int(np.sum(~regular))  # one test stands for those of a batch
                y, regular = y[regular], regular[regular]
                continue
            self._append(y[0], 0, not regular[0])
            left = ~self._same(len(self.known) - 1, y)
            y, regular = y[left], regular[left]

    def _same(self, k: int, y: np.ndarray) -> np.ndarray:
        """(k,) which positions are one of those known; counts them."""
        if not len(y):
            return np.zeros(0, dtype=bool)
        far = np.max(np.abs(self.roots.apart(self.known[k], y)), axis=1, initial=0.0)
        same = far <= (SAME_SINGULAR if self.singular[k] else SAME)
        self.hits[k] += int(np.sum(same))
        return same

    def _assembled(self, y: np.ndarray) -> np.ndarray:
        """(k,) which positions close, with all joints the same way round."""
        with np.errstate(all="ignore"):
            pinned, joints = (np.abs(r.evaluate(y)[0]) for r in (self.roots, self.joints))
            closed = np.max(pinned, axis=1, initial=0.0) <= CLOSED
            closed &= np.max(joints, axis=1, initial=0.0) <= IMPLIED
            return closed & np.all(np.sign(self._face(y)) == self.reference, axis=1)

    def _regular(self, y: np.ndarray) -> np.ndarray:
        """(k,) where the equations have a single solution nearby."""
        if not len(y) or not self.sizes.size:
            return np.ones(len(y), dtype=bool)
        values = np.linalg.svd(self.roots.evaluate(y)[2], compute_uv=False)
        return values[:, -1] > SINGULAR * values[:, 0]

    def _continuous(self, y: np.ndarray) -> bool:
        """Whether other assemblies are arbitrarily near."""
        jacobian = self.roots.evaluate(y[None])[2][0]
        motion = np.linalg.svd(jacobian)[2][-1]
        step = ALONG * motion / np.max(np.abs(motion))
        there = self.roots.moved(y[None], step[None])
        for _ in range(20):
            value, _, jacobians = self.roots.evaluate(there)
            if not np.all(np.isfinite(value)):
                return False
            back = -np.linalg.lstsq(jacobians[0], value[0], rcond=SINGULAR)[0]
            there = self.roots.moved(there, back[None])
        if not np.max(np.abs(self.roots.evaluate(there)[0]), initial=0.0) <= CLOSED:
            return False
        return bool(np.max(np.abs(self.roots.apart(y, there))) > ALONG / 2)
