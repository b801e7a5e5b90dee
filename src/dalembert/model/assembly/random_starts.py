"""Random positions of a mechanism as starts of searches.

Three quarters of them are sampled in joint coordinates of a spanning tree: the joints of the tree
are closed, and their axes have the correct direction. In the rest every body is placed freely.
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
