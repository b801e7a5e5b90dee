"""Finite elements between bodies of a mechanism, and the bodies at their nodes.

Strain and kinetic energies are those of structures, for displacements of any size; the displacement
of a node is that of its body.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import casadi as ca

from dalembert.elements.base import Condition, Look, Powers, Rate
from dalembert.elements.body import BodyElement
from dalembert.elements.fem.cell_functions import CellFunctions
from dalembert.elements.fem.nodal import TRANSLATIONS, Nodal
from dalembert.elements.look import Ball
from dalembert.errors import ModelError


class NodeBody(Nodal):
    """Mixin of bodies that are nodes of finite elements, placed before the body class.

    Elements are free of stress at its ``position`` and its ``angle`` or ``rotation``.
    """

    turning: ca.SX
    spin: ca.SX
    turned: Callable[[ca.SX], ca.SX]

    @property
    def body(self) -> Any:  # type: ignore[override]
        """Itself."""
        return self

    @property
    def natural(self) -> ca.SX:  # type: ignore[override]
        """Stress-free position.

        Raises
        ------
        ModelError
            The body has no ``position``.
        """
        body: Any = self
        position = body.initial[0]
        if position is None:
            raise ModelError("needs a position, where its elements are free of stress", self.name)
        return position.sx

    @property
    def place(self) -> ca.SX:
        """Current position."""
        body: Any = self
        return body.mass_center

    def displaced(self, turns: bool, entity: str) -> ca.SX:
        """Its displacement, followed by its rotation for elements with rotations.

        Raises
        ------
        ModelError
            It is a particle, which has no rotation.
        """
        body: Any = self
        displacement = self.place - self.natural
        if not turns:
            return displacement
        if not body.rotates:
            kind = "planar.Node" if self.dimension == 2 else "spatial.Node"
            raise ModelError(f"rotates its node {self.name}, a point; use {kind}", entity)
        return ca.vertcat(displacement, self.turned_by)

    @property
    def turned_by(self) -> ca.SX:
        """Its rotation: the angle in the plane, the entries of the matrix in space."""
        raise NotImplementedError

    def measures(self) -> dict[str, tuple[ca.SX, str]]:
        """Measures of a body, and displacements ``ux``, …, from the stress-free position."""
        body: Any = self
        own: dict[str, tuple[ca.SX, str]] = super().measures()  # type: ignore[misc]
        if body.initial[0] is None:
            return own
        displacement = self.place - self.natural
        own |= {d: (displacement[k], "m") for k, d in enumerate(TRANSLATIONS[: self.dimension])}
        if body.rotates and self.dimension == 2:
            own |= {"rz": (self.turned_by, "rad"), "vrz": own["angular_velocity"]}
        return own

    def look(self) -> list[Look]:
        body: BodyElement = self  # type: ignore[assignment]
        return [Ball(body.center)]


@dataclass(frozen=True, eq=False)
class BetweenBodies:
    """A finite element between bodies.

    Attributes
    ----------
    name : of the element
    functions : functions of its kind
    nodes : the bodies at its nodes
    numbers : SX column of its quantities
    """

    name: str
    functions: CellFunctions
    nodes: tuple[NodeBody, ...]
    numbers: ca.SX

    @property
    def u(self) -> ca.SX:
        """Displacements of its nodes in their current coordinates."""
        turns = self.functions.graphs.cls.turns
        return ca.vertcat(*(node.displaced(turns, self.name) for node in self.nodes))

    @cached_property
    def data(self) -> ca.SX:
        """Stress-free positions of its nodes, then its quantities."""
        return ca.vertcat(*(node.natural for node in self.nodes), self.numbers)

    @property
    def stored(self) -> ca.SX:
        """Strain energy [J]."""
        return self.functions.stored(self.u, self.data)[0]

    def powers(self, rate: Rate) -> Powers:
        """The internal forces, ``−∂W/∂u``."""
        return [(self.speeds(rate), -self.functions.stored(self.u, self.data)[1])]

    def speeds(self, rate: Rate) -> ca.SX:
        """Velocities of its nodes, with angular velocities in fixed axes if they rotate."""
        if not self._with_spins:
            return rate(self.u)
        return ca.vertcat(*(part for n in self.nodes for part in (rate(n.place), n.turning)))

    def accelerations(self, rate: Rate) -> ca.SX:
        """Rates of the speeds."""
        if not self._with_spins:
            return rate(self.speeds(rate))
        parts = ((rate(rate(n.place)), n.turned(rate(n.spin))) for n in self.nodes)
        return ca.vertcat(*(part for pair in parts for part in pair))

    @property
    def _with_spins(self) -> bool:
        """Whether its speeds are angular velocities instead of rates of displacements."""
        return self.functions.by_spins and self.functions.graphs.dimension == 3

    def inertial_powers(self, rate: Rate) -> Powers:
        """``d/dt ∂T/∂v − ∂T/∂u``."""
        if self.functions.massless:
            return []
        speed = self.speeds(rate)
        motion = [self.u, speed, self.accelerations(rate), self.data]
        if self.functions.by_spins:
            effort, spin, couple = self.functions.spin_inertia.call(motion)
            pairs = [(speed, effort), (spin, couple)]
        else:
            pairs = [(speed, self.functions.inertia(*motion))]
        return [pair for pair in pairs if not pair[1].is_zero()]

    def masses(self) -> list[tuple[ca.SX, ca.SX]]:
        """(position, mass) of its mass centre, or of its nodes if these have all of its mass."""
        if self.functions.massless:
            return []
        shares, center = self.functions.shares(self.data), self.functions.mass_center
        if center is not None:
            return [(center(self.u, self.data), ca.sum1(shares))]
        return list(zip((n.place for n in self.nodes), ca.vertsplit(shares), strict=True))

    def recovered(self) -> dict[str, tuple[ca.SX, str]]:
        """Its strains, stresses and forces."""
        measures = self.functions.graphs.measures
        if not measures:
            return {}
        values = self.functions.recovered.call([self.u, self.data])
        return {n: (v, unit) for (n, (_, unit)), v in zip(measures.items(), values, strict=True)}

    def conditions(self) -> list[Condition]:
        """Conditions of its shape and material."""
        conditions: list[Condition] = []
        for check, wrong in self.functions.checks:
            value = check(self.data)
            conditions.append((2 * (value > 0) - 1, wrong.replace("{:", "{0:"), value))
        return conditions

    def edges(self) -> list[tuple[Any, Any]]:
        """Pairs of nodes along the outlines of its faces."""
        rings = [[*face, face[0]] for face in self.functions.graphs.cls.outlines()]
        pairs = [pair for ring in rings for pair in pairwise(ring) if pair[0] != pair[1]]
        return [(self.nodes[i], self.nodes[j]) for i, j in pairs]
