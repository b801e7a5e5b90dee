"""One finite element whose nodes turn in space, as part of a mechanism.

A node is displaced by ``u`` and turned by a matrix ``R``, so that no rotation is too large for it.
Speeds are ``w = (u̇, ω)`` in fixed axes, no rates of coordinates: with momenta ``(P, H) = ∂T/∂w``
and the spin ``Ω`` of the axes that the inertia turns with,

    δT = P·δu̇ + H·δω + δΘ·Σ (P × u̇ + H × ω),      δω = δφ̇ + δφ × ω,

takes the effort ``Ṗ`` on ``u̇``, ``Ḣ − ω × H`` on ``ω`` and ``Σ (u̇ × P + ω × H)`` on ``Ω``
(Boltzmann and Hamel). Of a rigid body they are Newton's and Euler's equations.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from dalembert.elements.fem.graphs import ElementGraphs


class TurningGraphs(ElementGraphs):
    """Energies of one element between nodes with places and rotation matrices."""

    rotation_numbers = {3: 9}

    def _spin(self, u: ca.SX, v: ca.SX) -> ca.SX:
        return v[3:]

    @cached_property
    def rates(self) -> ca.SX:
        """``u̇`` and ``Ṙ = ω̃ R``."""
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
        the change ``ẇ' = ẇ − Ω × w`` that is seen in them.
        """
        a, spin = ca.SX.sym("a", self.v.numel()), self._own_spin
        speeds, accelerations = (ca.reshape(s, 3, -1) for s in (self.v, a))
        momenta = self._momenta(speeds)
        efforts = self._momenta(accelerations - _across(spin, speeds)) + _across(spin, momenta)
        turning = ca.horzcat(*(_across(w, p) for w, p in _pairs(speeds, momenta)))
        efforts[:, 1::2] -= turning[:, 1::2]  # of spins
        return [self.u, self.v, a, self.data], [ca.vec(efforts), spin, ca.sum2(turning)]

    def _momenta(self, speeds: ca.SX) -> ca.SX:
        """Of speeds, by columns."""
        turn = ca.SX.eye(3) if self.own_axes is None else self.own_axes
        seen = ca.SX(self.cls.kinetic_seen(self._v, self._x, self._q))
        masses = ca.hessian(seen, self.v)[0]
        seen = ca.mtimes(masses, ca.vec(ca.mtimes(turn.T, speeds)))
        return ca.mtimes(turn, ca.reshape(seen, 3, -1))

    @property
    def _own_spin(self) -> ca.SX:
        """Angular velocity of the axes of its inertia."""
        if self.own_axes is None:
            return ca.SX.zeros(3)
        turning = ca.jtimes(ca.vec(self.own_axes), self.u, self.rates)
        return ca.inv_skew(ca.mtimes(ca.reshape(turning, 3, 3), self.own_axes.T))


def _across(spin: ca.SX, columns: ca.SX) -> ca.SX:
    """``Ω ×`` each column."""
    return ca.mtimes(ca.skew(spin), columns)


def _pairs(first: ca.SX, second: ca.SX) -> zip[tuple[ca.SX, ca.SX]]:
    """Columns beside each other."""
    return zip(ca.horzsplit(first), ca.horzsplit(second), strict=True)
