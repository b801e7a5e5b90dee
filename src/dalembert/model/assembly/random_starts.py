"""Random positions of a mechanism, from which searches start.

Three quarters of them are drawn in joint coordinates of a spanning tree: the joints of the tree
close, and their axes point the right way. In the others every body is placed anywhere.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.elements.body import BodyElement
from dalembert.model.absolute import at_ground
from dalembert.model.assembly.guesses import Guesses
from dalembert.model.description import Description
from dalembert.model.equations import Equations
from dalembert.model.manifold import Manifold
from dalembert.model.tree.kinematic_tree import links_of
from dalembert.model.tree.motion import TreeMotion
from dalembert.symbolic.evaluation.backends import VirtualMachine
from dalembert.symbolic.evaluation.parallel import in_blocks
from dalembert.symbolic.formulas.expression import stack

REACH = 2.0
"""Largest displacement of a body, in natural lengths."""


class RandomStarts:
    """Random positions around one.

    Parameters
    ----------
    d, e, guesses : the mechanism
    y, p : a position, which settles the branches of the joints, and parameter values
    """

    def __init__(
        self, d: Description, e: Equations, guesses: Guesses, y: np.ndarray, p: np.ndarray
    ):
        self.y, self.p = y, p
        self.bodies = _Throw(
            e.manifold, e.scales.displacements, guesses.speed_units, guesses.angles
        )
        sizes = dict(zip(guesses.speed_names, e.scales.displacements, strict=True))
        links = links_of(d, (), False)

        def number(expression: ca.SX) -> np.ndarray:
            fixed = at_ground(d.ground, ca.densify(expression))
            return ca.Function("at", [e.t, e.y, e.p], [fixed])(0.0, y, p).full()

        standing = number(ca.horzcat(ca.SX(4, 0), *(link.standing for link in links)))
        links = [link.on_branch(standing[:, k]) for k, link in enumerate(links)]
        self.q = number(stack(link.space.reading for link in links)).ravel()
        motion = TreeMotion(links, d.coordinates)
        spaces = [link.space for link in links]
        named = [name for space in spaces for name in space.speed_names]
        units = [unit for space in spaces for unit in space.speed_units]
        angles = [space.flat and u == "rad" for space in spaces for u in space.speed_units]
        natural = {"m": e.scales.length, "rad": 1.0}
        joints = np.array(
            [sizes.get(n, natural.get(u, 1.0)) for n, u in zip(named, units, strict=True)]
        )
        self.joints = _Throw(Manifold.of(spaces), joints, units, angles)
        self.intervals = [
            (k, link.group.interval)
            for link, columns in zip(links, motion.columns, strict=True)
            for k in range(columns.start, columns.stop)
            if not isinstance(link.group, BodyElement) and np.all(np.isfinite(link.group.interval))
        ]
        pose = at_ground(d.ground, motion.pose)
        self._pose = VirtualMachine().columns(ca.Function("pose", [motion.q, e.p], [pose]))

    def draw(self, count: int, rng: np.random.Generator, share: float = 1.0) -> np.ndarray:
        """(count, n_y) positions; ``share`` of the largest displacements."""
        carried_count = count - count // 4
        q = self.joints.thrown(self.q, carried_count, rng, share)
        for k, (low, high) in self.intervals:
            q[:, k] = rng.uniform(low, high, carried_count)
        (carried,) = in_blocks(self._pose, 1, q, np.tile(self.p, (carried_count, 1)))
        thrown = self.bodies.thrown(self.y, count - carried_count, rng, share)
        return np.concatenate([carried, thrown])


class _Throw:
    """Random displacements of coordinates."""

    def __init__(self, manifold: Manifold, sizes: np.ndarray, units: list[str], angles: list[bool]):
        self.manifold, self.sizes = manifold, sizes
        self.turns = np.array([unit == "rad" for unit in units], dtype=bool)
        self.angles = np.array(angles, dtype=bool)

    def thrown(
        self, y: np.ndarray, count: int, rng: np.random.Generator, share: float
    ) -> np.ndarray:
        """(count, n_y) positions anywhere near one: some natural lengths away, turned anyhow."""
        way = share * rng.uniform(-1, 1, (count, self.sizes.size))
        turned = np.where(self.angles, np.pi * way, 2 * np.tan(np.pi / 2 * way))
        steps = self.sizes * np.where(self.turns, turned, REACH * way)
        if self.manifold.flat:
            return y + steps
        going = VirtualMachine().columns(self.manifold.going)
        return in_blocks(going, 1, np.tile(y, (count, 1)), steps)[0]
