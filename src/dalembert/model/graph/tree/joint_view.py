"""Equations of motion in joint coordinates (6.2), (6.21), and joint reactions by (7.13).

The joints of a spanning tree are satisfied exactly, by ``y = g(q)``; the other constraints close
the loops:

    DᵀMD q̈ + Dᵀ(Mγ + d) = Dᵀf − (C_II D)ᵀ λ_II,      Φ_II(g(q), t) = 0
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.model.graph.absolute import inertia_of, with_rotors
from dalembert.model.graph.assembly.independence import independent_rows
from dalembert.model.graph.coordinates import CoordinateView
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.inertia import TreeInertia
from dalembert.model.graph.manifold import Manifold
from dalembert.model.graph.model import Model
from dalembert.model.graph.rigid_gaps import RigidGap
from dalembert.model.graph.tree.kinematic_tree import (
    between_neighbours,
    links_of,
    rotors_of,
)
from dalembert.model.graph.tree.link import Link
from dalembert.model.graph.tree.motion import TreeMotion
from dalembert.symbolic.equations.factor import LdlFactor, block_inverse
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.formulas.expression import stack

ROUNDING = 1e-10
"""Threshold for zero rows of C, in natural sizes."""
SAMPLES = (0.0, 0.31, -0.17)
"""Joint displacements at which identities are tested [rad]."""


class JointView(CoordinateView):
    """The equations of a model in the coordinates of a tree of its joints.

    Attributes
    ----------
    motion : TreeMotion, motion of the bodies as a function of q
    manifold : of q
    tree_rows, loop_rows : rows of ``Φ`` satisfied by the tree (in its order), and the others
    """

    def __init__(
        self,
        model: Model,
        cut: tuple[str, ...],
        absolute_angles: bool,
        reactions: str,
        every_equation: bool,
    ):
        self.model, self.reactions = model, reactions
        self.bodies = model.all_equations
        self.links = self._as_at_start(links_of(model.parts, cut, absolute_angles))
        spaces = [link.space for link in self.links]
        self.names = [name for space in spaces for name in space.coordinate_names]
        self.speed_names = [name for space in spaces for name in space.speed_names]
        self.units = [unit for space in spaces for unit in space.coordinate_units]
        self.speed_units = [unit for space in spaces for unit in space.speed_units]
        self.motion = TreeMotion(self.links, model.coordinates)
        self.manifold = Manifold.of([link.space for link in self.links])
        first: dict[str, int] = {}
        for k, (constraint, _) in enumerate(model.closure.owners):
            first.setdefault(constraint.name, k)
        carrying = [link.joint for link in self.links if link.joint is not None]
        self.tree_rows = [
            first[joint.name] + k for joint in carrying for k in range(joint.equations.numel())
        ]
        of_tree = set(self.tree_rows)
        self.loop_rows = [k for k in range(self.bodies.constraint_count) if k not in of_tree]
        e = self._equations()
        self.whole = e = e.with_rows(self._loop_equations(e))
        self.rows = tuple(range(e.constraint_count) if every_equation else self._independent(e))

    def _as_at_start(self, links: list[Link]) -> list[Link]:
        """Links on the branches of their joints at the assembled start."""
        offsets = self.model.at_ground(ca.horzcat(*(link.branch_offset for link in links)))
        function = ca.Function("offsets", [self.bodies.t, self.bodies.y, self.bodies.p], [offsets])
        at_start = function(0.0, self.model.start.y, self.model.nominal).full()
        return [link.on_branch(at_start[:, k]) for k, link in enumerate(links)]

    @cached_property
    def _exchange(self) -> tuple[ca.SX, ca.SX]:
        """``y, v, v̇`` of the bodies: symbols, and expressions of ``q, u, u̇``."""
        e, m = self.bodies, self.motion
        return ca.vertcat(e.y, e.v, e.a), ca.vertcat(m.pose, m.speed, m.acceleration)

    def moved(self, expressions: list[ca.SX]) -> list[ca.SX]:
        """Expressions of ``y, v, v̇`` of the bodies in ``q, u, u̇``."""
        symbols, values = self._exchange
        return ca.substitute(expressions, [symbols], [values])

    def _equations(self) -> Equations:
        """Equations with all loop equations."""
        e, m = self.bodies, self.motion
        loops = [x[self.loop_rows, :] for x in (e.constraints, e.nonholonomic)]
        rate = self.model.at_ground(ca.densify(m.rate))
        rotors, driven = rotors_of(self.model.parts, self.links), with_rotors(self.model.parts)
        mass, bias = inertia_of(self.model.parts, e.v, driven) if driven else (e.mass, e.bias)
        rate, bias, force, potential, powers, mass, *loops = self.moved(
            [rate, bias, e.force, e.potential, e.powers, mass, *loops]
        )
        masses = [mass[b.rows, b.rows] for b in m.basis.branches]
        inertia = TreeInertia(m.basis, masses, rotors)
        sizes = self._sizes()
        equations = Equations(
            t=e.t,
            y=m.q,
            v=m.u,
            p=e.p,
            a=m.a,
            multiplier=e.multiplier[self.loop_rows, :],
            pose_rate=rate,
            inertia=inertia,
            bias=ca.densify(m.basis.transposed(ca.mtimes(mass, m.gamma) + bias)),
            force=ca.densify(m.basis.transposed(force)),
            constraints=self._shortened(loops[0]),
            nonholonomic=loops[1],
            potential=potential,
            powers=powers,
            scales=replace(
                e.scales.with_rows(self.loop_rows),
                coordinates=self._reach(sizes),
                displacements=sizes,
            ),
            manifold=self.manifold,
            contacts=tuple(self._moved_gap(gap) for gap in e.contacts),
        )
        return replace(equations, massless=self._massless(inertia)) if e.massless else equations

    def _moved_gap(self, gap: RigidGap) -> RigidGap:
        distance, slip, friction = self.moved([gap.distance, gap.slip, gap.impact.friction])
        law = replace(gap.impact, friction=friction)
        moving = ca.vertcat(self.bodies.t, self.manifold.y)
        return replace(gap, distance=distance, slip=slip, impact=law, moving=moving)

    def _shortened(self, constraints: ca.SX) -> ca.SX:
        """Loop equations; those between a body and its carrier in coordinates of their joint."""
        constraints = ca.densify(constraints)
        for row, equation in enumerate(self.loop_rows):
            owner, component = self.model.closure.owners[equation]
            between = between_neighbours(owner, self.links)
            if between is not None:
                constraints[row] = between[component]
        return constraints

    @cached_property
    def reduce(self) -> ImplicitFunction:
        e = self.bodies
        q = self.model.at_ground(stack(link.space.reading for link in self.links))
        u = ca.mtimes(ca.substitute(self.manifold.reading, self.manifold.y, q), e.rate(q))
        return ImplicitFunction("reduce", [e.t, e.y, e.v, e.p], [], [q, u])

    def _sizes(self) -> np.ndarray:
        """Natural sizes of the joint speeds, from those of the bodies."""
        e, start = self.bodies, self.model.start
        reach = ca.Function("reach", [e.t, e.y, e.p], [ca.jacobian(self.reduce.outputs[1], e.v)])
        by_body = reach(0.0, start.y, self.model.nominal).full()
        return np.abs(by_body * e.scales.displacements).max(axis=1, initial=0.0)

    def _reach(self, sizes: np.ndarray) -> np.ndarray:
        """Natural sizes of the joint coordinates, from those of their displacements."""
        reach: list[float] = []
        of_bodies = dict(zip(self.model.guesses.names, self.bodies.scales.coordinates, strict=True))
        for link, columns in zip(self.links, self.motion.columns, strict=True):
            space, own = link.space, sizes[columns]
            if not own.size:  # states of first order
                reach += [of_bodies.get(name, 1.0) for name in space.coordinate_names]
                continue
            lengths = [unit == "m" for unit in space.speed_units]
            metres = own[lengths].max(initial=0.0)
            by_unit = [metres if unit == "m" else 1.0 for unit in space.coordinate_units]
            reach += list(own) if space.flat else by_unit
        return np.array(reach)

    def _at_start(self, expression: ca.SX, displacement: np.ndarray | None = None) -> np.ndarray:
        """Value of an expression of t, q and p at the assembled start, or displaced from it."""
        start, p = self.model.start, self.model.nominal
        q = self.reduce.function(0.0, start.y, start.v, p)[0].full().ravel()
        if displacement is not None:
            q = self.manifold.go(q, displacement)
        function = ca.Function("start", [self.bodies.t, self.motion.q, self.bodies.p], [expression])
        return function(0.0, q, p).full()

    def _loop_equations(self, e: Equations) -> list[int]:
        """Loop equations, without those that every position satisfies, such as of a doubled pin.

        Rows of C of the latter are rounding only, which would spoil the weights of equations.
        """
        if not self.loop_rows:
            return []
        sizes, count = e.scales.displacements, np.arange(1, e.speed_count + 1)
        jacobians = [self._at_start(e.jacobian, d * sizes * np.cos(count)) for d in SAMPLES]
        natural = [c * sizes / e.scales.rows[:, None] for c in jacobians]
        largest = np.max([np.linalg.norm(c, axis=1) for c in natural], axis=0)
        return [int(k) for k in np.flatnonzero(~(largest < ROUNDING))]

    def _independent(self, e: Equations) -> list[int]:
        """Loop equations that do not depend linearly on the ones before them."""
        if not e.constraint_count:
            return []
        natural = self._at_start(e.jacobian) * e.scales.displacements / e.scales.rows[:, None]
        natural[np.linalg.norm(natural, axis=1) < ROUNDING] = 0.0
        return independent_rows(natural)

    def _massless(self, inertia: TreeInertia) -> tuple[int, ...]:
        """Coordinates that take part in a motion without kinetic energy."""
        mass = self._at_start(inertia.matrix)
        size = np.sqrt(np.diag(mass))
        unit = np.where(size > 0, size, 1.0)
        values, vectors = np.linalg.eigh(mass / np.outer(unit, unit))
        part = np.abs(vectors[:, values < 1e-12]).max(axis=1, initial=0.0)
        return tuple(int(k) for k in np.flatnonzero(part > 1e-6))

    # motion of the bodies and reactions of joints -----------------------------------------------
    def lift(self, expression: ca.SX) -> ca.SX:
        symbols, values = self._exchange
        tree = self.bodies.multiplier[self.tree_rows, :]
        if tree.numel() and ca.depends_on(expression, tree):
            symbols, values = ca.vertcat(symbols, tree), ca.vertcat(values, self.tree_reactions)
        return ca.substitute(expression, symbols, values)

    @cached_property
    def tree_reactions(self) -> ca.SX:
        """``λ_I`` of the joints in the tree, as expressions of ``q, u, u̇`` and ``λ_II``."""
        e, m = self.bodies, self.motion
        loop_forces = ca.SX.zeros(e.speed_count)
        if self.loop_rows:  # C_IIᵀ λ_II
            columns = e.jacobian[self.loop_rows, :].T
            loop_forces = ca.mtimes(columns, e.multiplier[self.loop_rows, :])
        applied = e.force + e.contact_push
        transmitted = self.moved([applied - e.bias - loop_forces - ca.mtimes(e.mass, e.a)])[0]
        if self.reactions == "augmented":  # (7.13)
            return ca.densify(m.basis.opened_transposed(transmitted))
        jacobian = e.by_displacement(e.constraints[self.tree_rows, :])
        c, mass = self.moved([jacobian, e.metric])
        response = ca.mtimes(block_inverse(mass), c.T)
        return LdlFactor(ca.mtimes(c, response)).solve(ca.mtimes(response.T, transmitted))
