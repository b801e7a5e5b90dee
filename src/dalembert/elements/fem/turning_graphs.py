"""One finite element whose nodes turn, as part of a mechanism.

A node is displaced by ``u`` and turned by an angle, in space by a matrix ``R``, so that no rotation
is too large for it. Speeds are ``w = (u̇, ω)`` in fixed axes, in space no rates of coordinates: with
momenta ``(P, H) = ∂T/∂w`` and the spin ``Ω`` of the axes that the inertia turns with,

    δT = P·δu̇ + H·δω + δΘ·Σ (P × u̇ + H × ω),      δω = δφ̇ + δφ × ω,

takes the effort ``Ṗ`` on ``u̇``, ``Ḣ − ω × H`` on ``ω`` and ``Σ (u̇ × P + ω × H)`` on ``Ω``
(Boltzmann and Hamel). Of a rigid body they are Newton's and Euler's equations.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from dalembert.elements.fem.graphs import ElementGraphs


class TurningGraphs(ElementGraphs):
    """Energies of one element between nodes with places and rotations.

    Vectors of the plane are those of space across its z axis.
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
        """By displacements, and by small turns in fixed axes."""
        return ca.jtimes(self.rates, self.v, ca.gradient(energy, self.u), True)

    def taken(self) -> tuple[list[ca.SX], list[ca.SX]]:
        """Displacements, speeds, accelerations and numbers; efforts on speeds, Ω, that on Ω.

        ``p = Q M Qᵀ w`` with the rotation ``Q`` of the axes, so that ``ṗ = Ω × p + Q M Qᵀ ẇ'`` with
        the change ``ẇ' = ẇ − Ω × w`` that is seen in them. All is computed in these axes.
        """
        a, spin = ca.SX.sym("a", self.v.numel()), self._own_spin
        axes = self._inertia_axes
        seen, speeds, accelerations = (
            ca.mtimes(axes.T, x) for x in (spin, self._vectors(self.v), self._vectors(a))
        )
        momenta = self._momenta(speeds)
        efforts = self._momenta(accelerations - _across(seen, speeds)) + _across(seen, momenta)
        pairs = zip(ca.horzsplit(speeds), ca.horzsplit(momenta), strict=True)
        turning = ca.horzcat(*(_across(w, p) for w, p in pairs))
        efforts[:, 1::2] = efforts[:, 1::2] - turning[:, 1::2]  # of spins
        effort, couple = (ca.mtimes(axes, x) for x in (efforts, ca.sum2(turning)))
        return [self.u, self.v, a, self.data], [self._column(effort), spin, couple]

    @cached_property
    def _inertia_axes(self) -> ca.SX:
        """(3, 3) axes of its inertia."""
        if self.own_axes is None:
            return ca.SX.eye(3)
        return self.own_axes if self.dimension == 3 else ca.diagcat(self.own_axes, 1)

    def _momenta(self, speeds: ca.SX) -> ca.SX:
        """Of speeds, by columns in the axes of its inertia."""
        energy = ca.SX(self.cls.kinetic_seen(self._v, self._x, self._q))
        return self._vectors(ca.mtimes(ca.hessian(energy, self.v)[0], self._column(speeds)))

    @cached_property
    def _own_spin(self) -> ca.SX:
        """Angular velocity of the axes of its inertia."""
        turning = ca.jtimes(ca.vec(ca.densify(self._inertia_axes)), self.u, self.rates)
        return ca.inv_skew(ca.mtimes(ca.reshape(turning, 3, 3), self._inertia_axes.T))

    def _vectors(self, column: ca.SX) -> ca.SX:
        """(3, 2 nodes) what is of displacements and of rotations, beside each other."""
        if self.dimension == 3:
            return ca.reshape(column, 3, -1)
        parts = (
            ca.horzcat(ca.vertcat(node[:2], 0), ca.vertcat(0, 0, node[2]))
            for node in ca.vertsplit(column, 3)
        )
        return ca.horzcat(*parts)

    def _column(self, vectors: ca.SX) -> ca.SX:
        """The same one below the other."""
        if self.dimension == 3:
            return ca.vec(vectors)
        nodes = ca.horzsplit(vectors, 2)
        return ca.vertcat(*(ca.vertcat(node[:2, 0], node[2, 1]) for node in nodes))


def _across(spin: ca.SX, columns: ca.SX) -> ca.SX:
    """``Ω ×`` each column."""
    return ca.mtimes(ca.skew(spin), columns)
