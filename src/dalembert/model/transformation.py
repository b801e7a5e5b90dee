"""Changes of coordinates and speeds, book section 4.2.2; new ones are primed.

    y = g(y', t),      v = B v' + b,      v̇ = B v̇' + γ,      γ = Ḃ v' + ḃ        (4.5)–(4.6)

The equations of motion are projected onto the columns of B and keep their form:

    M' = Bᵀ M B,      d' = Bᵀ (M γ + d),      f' = Bᵀ f,      C' = C B                  (4.8)

B is square for a change of basis. With fewer new speeds it is the D of the explicit constraint
equations (4.15)–(4.17), ``C D = 0``, and the result are the equations in joint coordinates (6.2),
by velocity partitioning (6.8), and the general projective scheme (6.9). Constraints that are then
satisfied identically are left out by ``with_rows([])``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from dalembert.model.equations import Equations
from dalembert.model.inertia import BlockInertia
from dalembert.model.manifold import Manifold
from dalembert.model.scales import Scales
from dalembert.symbolic.equations.factor import LdlFactor


@dataclass(frozen=True, eq=False)
class Transformation:
    """A motion in new coordinates and speeds.

    Attributes
    ----------
    t : SX symbol, time
    y, v, a : SX symbols (n',), (k,), (k,): new coordinates ``y'``, speeds ``v'`` and ``v̇'``
    pose_rate : SX (n',), ``ẏ'`` of ``t, y', v'``
    old_y : SX (n_y,), ``g(y', t)``
    old_v : SX (n,), ``B v' + b`` of ``t, y', v'``
    """

    t: ca.SX
    y: ca.SX
    v: ca.SX
    a: ca.SX
    pose_rate: ca.SX
    old_y: ca.SX
    old_v: ca.SX

    @property
    def basis(self) -> ca.SX:
        """``B``, or ``D``: ``∂v/∂v'``."""
        return ca.jacobian(self.old_v, self.v)

    @property
    def gamma(self) -> ca.SX:
        """``γ = Ḃ v' + ḃ`` (4.6), (4.17)."""
        return self._rate(self.old_v, ca.SX.zeros(self.v.numel()))

    @property
    def old_a(self) -> ca.SX:
        """``v̇ = B v̇' + γ``, the total time derivative of ``v``."""
        return self._rate(self.old_v, self.a)

    def _rate(self, expression: ca.SX, acceleration: ca.SX) -> ca.SX:
        state = ca.vertcat(self.t, self.y, self.v)
        return ca.jtimes(expression, state, ca.vertcat(1, self.pose_rate, acceleration))

    def seen(self, equations: Equations, expression: ca.SX) -> ca.SX:
        """An expression of ``y, v, v̇`` in the new variables."""
        return ca.substitute(expression, *self._exchange(equations))

    def _exchange(self, e: Equations) -> tuple[ca.SX, ca.SX]:
        return ca.vertcat(e.y, e.v, e.a), ca.vertcat(self.old_y, self.old_v, self.old_a)

    def apply(self, equations: Equations) -> Equations:
        """The equations of motion in the new variables (4.8), (6.9).

        Kinetic energy is ``v'ᵀ M' v' / 2`` without drift. A new speed is massless if it combines
        massless speeds only. Leaving out the equations of a driver afterwards also removes its
        power.
        """
        e, b = equations, self.basis
        mass = e.inertia.substitute(*self._exchange(e))
        bias = mass.times(self.gamma) + self.seen(e, e.bias)
        return replace(
            e,
            y=self.y,
            v=self.v,
            a=self.a,
            pose_rate=self.pose_rate,
            inertia=BlockInertia(ca.mtimes([b.T, mass.matrix, b])),
            bias=ca.mtimes(b.T, bias),
            force=ca.mtimes(b.T, self.seen(e, e.force)),
            rubbing=ca.sparsify(ca.mtimes(b.T, self.seen(e, e.rubbing))),
            constraints=self.seen(e, e.constraints),
            nonholonomic=self.seen(e, e.nonholonomic),
            kinematics=None,
            potential=self.seen(e, e.potential),
            powers=self.seen(e, e.powers),
            massless=_massless(e.massless, b),
            scales=self._scales(e),
            manifold=self._manifold(e),
        )

    def _manifold(self, e: Equations) -> Manifold:
        """The manifold of the new positions, with displacements of the new speeds."""
        if self.y.shape == e.y.shape and ca.is_equal(self.y, e.y):
            return e.manifold.along(self.basis)
        return Manifold.plain(self.y)

    def _scales(self, e: Equations) -> Scales:
        """Scales of the new variables; one for new coordinates and for fewer speeds."""
        same = self.y.shape == e.y.shape and ca.is_equal(self.y, e.y) and self.v.shape == e.v.shape
        if same:
            return e.scales
        units = np.ones(self.y.numel()), np.ones(self.v.numel())
        return replace(e.scales, coordinates=units[0], displacements=units[1])


def consistent_speeds(mass: ca.SX, basis: ca.SX, speeds: ca.SX) -> ca.SX:
    """``u = (Dᵀ M D)⁻¹ Dᵀ M v``: momenta projected onto the admissible motions (6.10)–(6.11).

    Parameters
    ----------
    mass, basis : SX ``M`` (n, n), ``D`` (n, k)
    speeds : SX ``v`` (n,), less the drift where constraints depend on time
    """
    momenta = ca.mtimes(basis.T, mass)
    return LdlFactor(ca.mtimes(momenta, basis)).solve(ca.mtimes(momenta, speeds))


def _massless(massless: tuple[int, ...], basis: ca.SX) -> tuple[int, ...]:
    pattern = ca.sparsify(basis).sparsity()
    rows, starts = pattern.row(), pattern.colind()
    columns = [set(rows[starts[k] : starts[k + 1]]) for k in range(basis.shape[1])]
    return tuple(k for k, combined in enumerate(columns) if combined and combined <= set(massless))
