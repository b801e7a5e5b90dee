"""Finite elements of mechanisms with nodes that rotate.

A node is displaced by ``u`` and rotated by an angle, in space by a matrix ``R``, without a limit of
the rotation. Speeds are ``w = (u̇, ω)`` in fixed axes, in space not rates of coordinates: with
momenta ``(P, H) = ∂T/∂w`` and the angular velocity ``Ω`` of the axes of the inertia,

    δT = P·δu̇ + H·δω + δΘ·Σ (P × u̇ + H × ω),      δω = δφ̇ + δφ × ω,

the efforts are ``Ṗ`` on ``u̇``, ``Ḣ − ω × H`` on ``ω`` and ``Σ (u̇ × P + ω × H)`` on ``Ω``
(Boltzmann and Hamel). For a rigid body they are Newton's and Euler's equations.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from dalembert.elements.fem.graphs import ElementGraphs


class TurningGraphs(ElementGraphs):
    """Energies of one element between nodes with positions and rotations.

    Planar vectors are spatial ones normal to the z axis.
    """

    rotation_numbers = {3: 9}

    def _spin(self, u: ca.SX, v: ca.SX) -> ca.SX:
        return v[3:]

    @cached_property
    def rates(self) -> ca.SX:
        """``u̇`` and ``Ṙ = ω̃ R``."""
        if self.dimension == 2:
            return self.v
        parts = []
        for u, v in zip(self._u, self._v, strict=True):
            parts += [v[:3], ca.vec(ca.mtimes(ca.skew(v[3:]), ca.reshape(u[3:], 3, 3)))]
        return ca.vertcat(*parts)

    def slope(self, energy: ca.SX) -> ca.SX:
        """Gradient by displacements and by small rotations in fixed axes."""
        return ca.jtimes(self.rates, self.v, ca.gradient(energy, self.u), True)

    def spin_inertia(self) -> tuple[list[ca.SX], list[ca.SX]]:
        """Inputs (displacements, speeds, accelerations, data); efforts on speeds, Ω, effort on Ω.

        ``p = Q M Qᵀ w`` with the rotation ``Q`` of the axes, so that ``ṗ = Ω × p + Q M Qᵀ ẇ'`` with
        the relative derivative ``ẇ' = ẇ − Ω × w``. The computation is in these axes.
        """
        a, spin = ca.SX.sym("a", self.v.numel()), self._own_spin
        axes = self._inertia_axes
        local_spin, speeds, accelerations = (
            ca.mtimes(axes.T, x) for x in (spin, self._vectors(self.v), self._vectors(a))
        )
        momenta = self._momenta(speeds)
        relative = accelerations - _cross(local_spin, speeds)
        efforts = self._momenta(relative) + _cross(local_spin, momenta)
        pairs = zip(ca.horzsplit(speeds), ca.horzsplit(momenta), strict=True)
        products = ca.horzcat(*(_cross(w, p) for w, p in pairs))
        efforts[:, 1::2] = efforts[:, 1::2] - products[:, 1::2]  # moments
        effort, couple = (ca.mtimes(axes, x) for x in (efforts, ca.sum2(products)))
        return [self.u, self.v, a, self.data], [self._column(effort), spin, couple]

    @cached_property
    def _inertia_axes(self) -> ca.SX:
        """(3, 3) axes of its inertia."""
        if self.own_axes is None:
            return ca.SX.eye(3)
        return self.own_axes if self.dimension == 3 else ca.diagcat(self.own_axes, 1)

    def _momenta(self, speeds: ca.SX) -> ca.SX:
        """Momenta of speeds, as columns in the axes of the inertia."""
        energy = ca.SX(self.cls.kinetic_in_axes(self._v, self._x, self._q))
        return self._vectors(ca.mtimes(ca.hessian(energy, self.v)[0], self._column(speeds)))

    @cached_property
    def _own_spin(self) -> ca.SX:
        """Angular velocity of the axes of the inertia."""
        axes_rate = ca.jtimes(ca.vec(ca.densify(self._inertia_axes)), self.u, self.rates)
        return ca.inv_skew(ca.mtimes(ca.reshape(axes_rate, 3, 3), self._inertia_axes.T))

    def _vectors(self, column: ca.SX) -> ca.SX:
        """(3, 2 nodes) the translational and rotational vector of each node as columns."""
        if self.dimension == 3:
            return ca.reshape(column, 3, -1)
        parts = (
            ca.horzcat(ca.vertcat(node[:2], 0), ca.vertcat(0, 0, node[2]))
            for node in ca.vertsplit(column, 3)
        )
        return ca.horzcat(*parts)

    def _column(self, vectors: ca.SX) -> ca.SX:
        """The vectors as one column, the inverse of ``_vectors``."""
        if self.dimension == 3:
            return ca.vec(vectors)
        nodes = ca.horzsplit(vectors, 2)
        return ca.vertcat(*(ca.vertcat(node[:2, 0], node[2, 1]) for node in nodes))


def _cross(spin: ca.SX, columns: ca.SX) -> ca.SX:
    """``Ω ×`` each column."""
    return ca.mtimes(ca.skew(spin), columns)
