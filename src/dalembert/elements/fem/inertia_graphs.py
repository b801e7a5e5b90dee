"""Kinetic energy of one kind of elements: mass matrices and inertia forces."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import casadi as ca

from dalembert.elements.fem.energies import Energies
from dalembert.elements.fem.nodal import in_node_axes, spin_map
from dalembert.symbolic.once import CacheOwner


class InertiaGraphs(CacheOwner):
    """Mass matrices of elements in their initial positions, and inertia forces of displaced ones.

    The velocities ``v`` of nodes may have fewer entries than their displacements. With ``T(u, v)``
    the inertia forces are ``d/dt ∂T/∂v − ∂T/∂u``. A lumped inertia is the diagonal of a mass
    matrix, which rotates with the nodes.
    """

    cls: type[Energies]
    linear: bool
    u: ca.SX
    v: ca.SX
    data: ca.SX
    _u: list[ca.SX]
    _v: list[ca.SX]
    _x: list[ca.SX]
    _q: dict[str, Any]

    @cached_property
    def kinetic(self) -> ca.SX:
        """Kinetic energy of velocities ``v`` in the initial position."""
        return ca.SX(self.cls.kinetic(self._v, self._x, self._q))

    @cached_property
    def mass(self) -> ca.SX:
        """Total mass: twice the kinetic energy at a unit velocity of all nodes."""
        unit = [ca.vertcat(1, ca.DM.zeros(v.numel() - 1)) for v in self._v]
        return 2 * ca.substitute(self.kinetic, self.v, ca.vertcat(*unit))

    @cached_property
    def mass_center(self) -> ca.SX | None:
        """Mass centre of the displaced element; None if it is that of the masses of its nodes."""
        return self.cls.mass_center(self._u, self._x, self._q)

    # mass matrices ------------------------------------------------------------------------
    def _masses(self):
        return [self.data], [ca.vec(ca.hessian(self.kinetic, self.v)[0])]

    @property
    def _inertia(self) -> ca.SX:
        """Diagonal of the mass matrix, and the mass."""
        return ca.vertcat(ca.diag(ca.hessian(self.kinetic, self.v)[0]), self.mass)

    def _diagonal(self):
        return [self.data], [self._inertia]

    def _push_diagonal(self):
        (change,) = self._symbols("change")
        return [self.data, change], [ca.jtimes(self._inertia, self.data, change)]

    def _pull_diagonal(self):
        w = ca.SX.sym("w", self.u.numel() + 1)
        return [self.data, w], [ca.jtimes(self._inertia, self.data, w, True)]

    # displaced elements -------------------------------------------------------------------
    @cached_property
    def moving(self) -> dict[str, tuple[ca.SX, ca.SX]]:
        """``"consistent"`` and ``"lumped"`` → kinetic energy and the data that it depends on."""
        v, diagonal = self._v, ca.SX.sym("diagonal", self.v.numel())
        local, consistent = v, self.kinetic
        if not self.linear:
            consistent = self.displaced_kinetic
            local = [in_node_axes(*node) for node in zip(self._u, v, strict=True)]
        return {
            "consistent": (consistent, self.data),
            "lumped": (ca.dot(diagonal, ca.vertcat(*local) ** 2) / 2, diagonal),
        }

    @cached_property
    def own_axes(self) -> ca.SX | None:
        """Axes with which its inertia rotates, as columns."""
        return self.cls.own_axes(self._u, self._x, self._q)

    @cached_property
    def displaced_kinetic(self) -> ca.SX:
        """Kinetic energy of velocities ``v`` of the displaced element."""
        if self.own_axes is None:
            return self.kinetic
        d, to_axes = self._x[0].numel(), self.own_axes.T
        velocities = []
        for u, v in zip(self._u, self._v, strict=True):
            spin = v[d:] if d == 2 else ca.mtimes(to_axes, self._spin(u, v))
            velocities.append(ca.vertcat(ca.mtimes(to_axes, v[:d]), spin))
        return ca.SX(self.cls.kinetic_in_axes(velocities, self._x, self._q))

    def _spin(self, u: ca.SX, v: ca.SX) -> ca.SX:
        """Angular velocity of a spatial node in fixed axes."""
        return ca.mtimes(spin_map(u[3:]), v[3:])

    def turning(self, kind: str) -> bool:
        """Whether the inertia depends on the displacements."""
        return not self.kinetic.is_zero() and ca.depends_on(self.moving[kind][0], self.u)

    def inertia_force(self, kind: str) -> tuple[list[ca.SX], ca.SX]:
        """Inputs (displacements, velocities, accelerations, data) and the inertia force."""
        energy, data = self.moving[kind]
        a, momentum = ca.SX.sym("a", self.u.numel()), ca.gradient(energy, self.v)
        force = ca.jtimes(momentum, ca.vertcat(self.u, self.v), ca.vertcat(self.v, a))
        return [self.u, self.v, a, data], force - ca.gradient(energy, self.u)

    def _inertia_forces(self, kind: str):
        inputs, force = self.inertia_force(kind)
        return inputs, [force]

    def _inertia_slopes(self, kind: str):
        """Derivatives by displacements, velocities and accelerations."""
        inputs, force = self.inertia_force(kind)
        by_v, by_a = (ca.jacobian(force, by) for by in inputs[1:3])
        return inputs, [ca.vec(slope) for slope in (self._slopes(force), by_v, by_a)]

    def _push_inertia(self, kind: str):
        inputs, force = self.inertia_force(kind)
        change = ca.SX.sym("change", inputs[3].numel())
        return [*inputs, change], [ca.jtimes(force, inputs[3], change)]

    def _pull_inertia(self, kind: str):
        inputs, force = self.inertia_force(kind)
        w = ca.SX.sym("w", self.u.numel())
        return [*inputs, w], [ca.jtimes(force, inputs[3], w, True)]

    def _turn_inertia(self, kind: str):
        """Derivative of ``pull_inertia`` along the data."""
        inputs, (pulled,) = self._pull_inertia(kind)
        change = ca.SX.sym("change", inputs[3].numel())
        return [*inputs, change], [ca.jtimes(pulled, inputs[3], change)]

    def _kinetic_energy(self, kind: str):
        """The energy and its gradients by displacements, velocities and data."""
        energy, data = self.moving[kind]
        slopes = [ca.gradient(energy, by) for by in (self.u, self.v, data)]
        return [self.u, self.v, data], [energy, *slopes]

    def _slopes(self, value: ca.SX) -> ca.SX:
        """Jacobian by the displacements."""
        if not self.cls.floats:
            return ca.jacobian(value, self.u)
        n, d = self._u[0].numel(), self._x[0].numel()
        columns = ca.jacobian(value, self.u[d:])
        first = sum((columns[:, k - d : k] for k in range(n, self.u.numel(), n)), 0)
        return ca.horzcat(-first, columns)

    def _symbols(self, *names: str) -> list[ca.SX]:
        return [ca.SX.sym(n, (self.data if n == "change" else self.u).numel()) for n in names]
