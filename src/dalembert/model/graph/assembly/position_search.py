"""Search for assembled positions from random starts, if a single start fails.

Starts spread from a given position to the whole space. Three quarters of them are sampled in joint
coordinates of a spanning tree: the joints of the tree are closed, and their axes have the correct
direction. In the rest every body is placed freely. The search is reproducible, with a fixed seed.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.elements.body import BodyElement
from dalembert.model.graph.absolute import at_ground
from dalembert.model.graph.assembly.assembly import MISSING_WEIGHT, Assembler
from dalembert.model.graph.assembly.guesses import Guesses
from dalembert.model.graph.assembly.many_roots import Ends, ManyRoots
from dalembert.model.graph.assembly.recipe import Pinned
from dalembert.model.graph.description import Description
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.manifold import Manifold
from dalembert.model.graph.tree.kinematic_tree import links_of
from dalembert.model.graph.tree.motion import TreeMotion
from dalembert.symbolic.evaluation.backends import VirtualMachine
from dalembert.symbolic.evaluation.parallel import in_blocks
from dalembert.symbolic.formulas.expression import stack

REACH = 2.0
"""Upper limit of the displacement of a body, in natural lengths."""


class RandomStarts:
    """Random positions around a reference position.

    Parameters
    ----------
    d, e, guesses : the mechanism
    y, p : reference position, which determines the branches of the joints, and parameter values
    """

    def __init__(
        self, d: Description, e: Equations, guesses: Guesses, y: np.ndarray, p: np.ndarray
    ):
        self.y, self.p = y, p
        self.bodies = _Sampler(
            e.manifold, e.scales.displacements, guesses.speed_units, guesses.angles
        )
        sizes = dict(zip(guesses.speed_names, e.scales.displacements, strict=True))
        links = links_of(d, (), False)

        def number(expression: ca.SX) -> np.ndarray:
            fixed = at_ground(d.ground, ca.densify(expression))
            return ca.Function("at", [e.t, e.y, e.p], [fixed])(0.0, y, p).full()

        branches = number(ca.horzcat(ca.SX(4, 0), *(link.branch_offset for link in links)))
        links = [link.on_branch(branches[:, k]) for k, link in enumerate(links)]
        self.q = number(stack(link.space.reading for link in links)).ravel()
        motion = TreeMotion(links, d.coordinates)
        spaces = [link.space for link in links]
        names = [name for space in spaces for name in space.speed_names]
        units = [unit for space in spaces for unit in space.speed_units]
        angles = [space.flat and u == "rad" for space in spaces for u in space.speed_units]
        natural = {"m": e.scales.length, "rad": 1.0}
        joints = np.array(
            [sizes.get(n, natural.get(u, 1.0)) for n, u in zip(names, units, strict=True)]
        )
        self.joints = _Sampler(Manifold.of(spaces), joints, units, angles)
        self.intervals = [
            (k, link.group.interval)
            for link, columns in zip(links, motion.columns, strict=True)
            for k in range(columns.start, columns.stop)
            if not isinstance(link.group, BodyElement) and np.all(np.isfinite(link.group.interval))
        ]
        pose = at_ground(d.ground, motion.pose)
        self._pose = VirtualMachine().columns(ca.Function("pose", [motion.q, e.p], [pose]))

    def draw(self, count: int, rng: np.random.Generator, share: float = 1.0) -> np.ndarray:
        """(count, n_y) positions; ``share`` scales the largest displacements."""
        carried_count = count - count // 4
        q = self.joints.sample(self.q, carried_count, rng, share)
        for k, (low, high) in self.intervals:
            q[:, k] = rng.uniform(low, high, carried_count)
        (carried,) = in_blocks(self._pose, 1, q, np.tile(self.p, (carried_count, 1)))
        free = self.bodies.sample(self.y, count - carried_count, rng, share)
        return np.concatenate([carried, free])


class _Sampler:
    """Random sampling of displacements of coordinates."""

    def __init__(self, manifold: Manifold, sizes: np.ndarray, units: list[str], angles: list[bool]):
        self.manifold, self.sizes = manifold, sizes
        self.turns = np.array([unit == "rad" for unit in units], dtype=bool)
        self.angles = np.array(angles, dtype=bool)

    def sample(
        self, y: np.ndarray, count: int, rng: np.random.Generator, share: float
    ) -> np.ndarray:
        """(count, n_y) positions around ``y``, within some natural lengths and any rotation."""
        uniform = share * rng.uniform(-1, 1, (count, self.sizes.size))
        rotations = np.where(self.angles, np.pi * uniform, 2 * np.tan(np.pi / 2 * uniform))
        steps = self.sizes * np.where(self.turns, rotations, REACH * uniform)
        if self.manifold.flat:
            return y + steps
        retract = VirtualMachine().columns(self.manifold.going)
        return in_blocks(retract, 1, np.tile(y, (count, 1)), steps)[0]


SHARES = (0.1, 0.3, 1.0)
"""Upper limits of the displacements of starts, as shares of turns and of two natural lengths."""
STARTS, WORK = 100, 1e8
"""Upper limits of the starts per share, and of starts times the cube of the displacements."""
ENOUGH = 10
"""Successful starts after which more distant ones are left out."""
FARTHER = 2.0
"""Upper limit of the distance of a position from the guesses, relative to a reference."""
SAME = 1e-6
"""Threshold for the distance of equal positions, in natural sizes."""


def facing_function(d: Description, e: Equations) -> ca.Function:
    """``(t, y, p)`` → orientations of all joints, positive if correct."""
    facing = at_ground(d.ground, stack(c.assembly_conditions() for c in d.constraints))
    return ca.Function("facing", [e.t, e.y, e.p], [ca.densify(facing)])


@dataclass(frozen=True, eq=False)
class SearchResult:
    """Result of a search.

    Attributes
    ----------
    starts : number of random starts
    positions : (k, n_y) assembled positions, the nearest to the given one first
    best : (n_y,) position of the smallest residual
    residual : smallest residual, relative to its natural size
    """

    starts: int
    positions: np.ndarray
    best: np.ndarray
    residual: float


class PositionSearch:
    """Search for assembled positions of a mechanism at an instant.

    Parameters
    ----------
    assembler, d : the mechanism
    t, p : instant [s] and (np,) parameter values
    """

    def __init__(self, assembler: Assembler, d: Description, t: float, p: np.ndarray):
        self.assembler, self.d, self.t, self.p = assembler, d, t, p
        self.weight = np.where(assembler.guesses.missing, MISSING_WEIGHT, 1.0)
        self._facing = facing_function(d, assembler.equations)

    def near(self, y: np.ndarray) -> SearchResult:
        """Positions that satisfy all joints, drivers and initial conditions."""
        roots = ManyRoots(self.assembler, self.t, self.p)
        return self._search(y, roots, roots.nearest)

    def with_fixed(self, y: np.ndarray, pinned: Pinned) -> SearchResult:
        """Positions that satisfy the square system of the start, with its fixed coordinates."""
        roots = ManyRoots(self.assembler, self.t, self.p, pinned)
        return self._search(y, roots, roots.newton)

    def keeping(self, y: np.ndarray, pinned: Pinned) -> np.ndarray | None:
        """An assembled position with the fixed coordinates, about as near to the guesses as ``y``.

        None if there is none within ``FARTHER`` times the distance.
        """
        guess = self.assembler.start(self.t, self.p).full().ravel()
        roots = ManyRoots(self.assembler, self.t, self.p, pinned)
        positions = self._search(guess, roots, roots.newton).positions
        if not len(positions):
            return None
        distances = np.linalg.norm(
            self.weight * roots.apart(guess, np.array([y, positions[0]])), axis=1
        )
        return positions[0] if distances[1] <= FARTHER * distances[0] else None

    def _search(self, y: np.ndarray, roots: ManyRoots, search) -> SearchResult:
        a, rng = self.assembler, np.random.default_rng(0)
        starts = RandomStarts(self.d, a.equations, a.guesses, y, self.p)
        size = max(a.longest.size, 1)
        count = int(np.clip(WORK / size**3, 8, STARTS))
        ends, closed = [], np.zeros(0, dtype=bool)
        for share in SHARES:
            ends.append(search(starts.draw(count, rng, share)))
            closed = np.concatenate([closed, self._closed(ends[-1])])
            if roots.pinned is None and np.sum(closed) >= ENOUGH:
                break  # more distant starts lead to more distant positions
        y_end, residual = (np.concatenate([getattr(e, x) for e in ends]) for x in ("y", "open"))
        positions = self._distinct(y, y_end[closed], roots)
        best = int(np.argmin(np.nan_to_num(residual, nan=np.inf)))
        return SearchResult(len(y_end), positions, y_end[best], float(residual[best]))

    def _closed(self, ends: Ends) -> np.ndarray:
        """(k,) which final positions are assembled, with joints in the correct orientation."""
        a, closed = self.assembler, ends.closed.copy()
        for k in np.flatnonzero(closed):
            closed[k] = bool(np.all(a.facing(self.t, ends.y[k], self.p).full() > 0))
        return closed

    def _distinct(self, y: np.ndarray, positions: np.ndarray, roots: ManyRoots) -> np.ndarray:
        """Distinct positions, the nearest first."""
        if not len(positions):
            return positions
        away = np.linalg.norm(self.weight * roots.apart(y, positions), axis=1)
        reversed_joints = [np.any(self._facing(self.t, q, self.p).full() <= 0) for q in positions]
        remaining, distinct = positions[np.lexsort((away, reversed_joints))], []
        while len(remaining):
            distinct.append(remaining[0])
            distance = np.max(np.abs(roots.apart(remaining[0], remaining)), axis=1, initial=0.0)
            remaining = remaining[distance > SAME]
        return np.array([roots.unwound(y, position) for position in distinct])
