"""Stiffness of one kind of elements at rest: by stresses, and its change along displacements."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import casadi as ca

from dalembert.elements.fem.inertia_graphs import InertiaGraphs


class StiffnessGraphs(InertiaGraphs):
    """Geometric stiffness ``σ · ∂²ε/∂u² (0)``, the change ``∂³W/∂u³ (0) · u`` of the exact tangent,
    and moduli of elements whose energy depends on the displacement gradient only.

    Attributes
    ----------
    at : symbol of the sample
    """

    at: ca.SX

    @property
    def exact(self) -> ca.SX:
        """Strain energy at displacements of any size."""
        raise NotImplementedError

    def _at_rest(self, value: ca.SX) -> ca.SX:
        return ca.substitute(value, self.u, ca.SX.zeros(self.u.numel()))

    def _change(self):
        """Derivative of the exact tangent at rest along displacements ``u0``."""
        (u0,) = self._symbols("u0")
        change = ca.jtimes(ca.gradient(self.exact, self.u), self.u, u0)
        return [u0, self.data], [ca.vec(self._at_rest(ca.jacobian(change, self.u)))]

    def _push_change(self):
        u0, change, du, b = self._symbols("u0", "change", "du", "b")
        product = ca.jtimes(ca.gradient(self.exact, self.u), self.u, b)
        at_rest = self._at_rest(ca.jtimes(product, self.u, u0))
        pushed = ca.jtimes(at_rest, u0, du) + ca.jtimes(at_rest, self.data, change)
        return [u0, self.data, change, du, b], [pushed]

    def _pull_change(self):
        u0, a, b = self._symbols("u0", "a", "b")
        value = self.exact
        for direction in (b, a, u0):
            value = ca.jtimes(value, self.u, direction)
        value = self._at_rest(value)
        return [u0, self.data, a, b], [ca.gradient(value, s) for s in (u0, self.data)]

    def _stressed_work(self, u0: ca.SX) -> ca.SX:
        """``σ·ε(u)``, with the stresses ``σ`` by the strains to first order in ``u0``."""
        strains = self.cls.strains(self._u, self._x, self._q)
        stresses = self._stresses(self._at_rest(ca.jtimes(strains, self.u, u0)))
        return ca.dot(stresses, strains)

    def _stresses(self, strains: ca.SX) -> ca.SX:
        """``∂W/∂ε`` at generalised strains."""
        symbol = ca.SX.sym("strains", strains.numel())
        stresses = ca.gradient(ca.SX(self.cls.energy_of(symbol, self._x, self._q)), symbol)
        return ca.substitute(ca.densify(stresses), symbol, ca.densify(strains))

    def _geometric(self):
        """Stiffness at rest by the stresses of displacements ``u0``."""
        (u0,) = self._symbols("u0")
        stiffness, _ = ca.hessian(self._stressed_work(u0), self.u)
        return [u0, self.data], [ca.vec(self._at_rest(stiffness))]

    def _push_geometric(self):
        u0, change, du, b = self._symbols("u0", "change", "du", "b")
        product = ca.jtimes(ca.gradient(self._stressed_work(u0), self.u), self.u, b)
        at_rest = self._at_rest(product)
        pushed = ca.jtimes(at_rest, u0, du) + ca.jtimes(at_rest, self.data, change)
        return [u0, self.data, change, du, b], [pushed]

    def _pull_geometric(self):
        u0, a, b = self._symbols("u0", "a", "b")
        value = self._stressed_work(u0)
        for direction in (b, a):
            value = ca.jtimes(value, self.u, direction)
        value = self._at_rest(value)
        return [u0, self.data, a, b], [ca.gradient(value, s) for s in (u0, self.data)]

    # elements whose energy depends on the displacement gradient only
    def _moduli(self):
        h, gradient, slopes, moduli = self._second_derivative
        at = ca.SX.zeros(*h.shape) if self.linear else gradient
        return [self.u, self.data], [slopes, ca.substitute(moduli, h, at)]

    def _change_moduli(self):
        """Change of the moduli at rest along displacements ``u0``."""
        (u0,) = self._symbols("u0")
        h, gradient, slopes, moduli = self._second_derivative
        direction = ca.vec(ca.substitute(gradient, self.u, u0))
        change = ca.reshape(ca.jtimes(ca.vec(moduli), ca.vec(h), direction), moduli.shape)
        return [u0, self.data], [slopes, ca.substitute(change, h, ca.SX.zeros(*h.shape))]

    def _geometric_moduli(self):
        """Those of the work of the stresses of displacements ``u0``."""
        (u0,) = self._symbols("u0")
        cls: Any = self.cls
        h, gradient, slopes, _ = self._second_derivative
        strains, rest = ca.vec(cls.strain(h)), ca.SX.zeros(*h.shape)
        direction = ca.vec(ca.substitute(gradient, self.u, u0))
        first = ca.substitute(ca.jtimes(strains, ca.vec(h), direction), h, rest)
        moduli, _ = ca.hessian(ca.dot(self._stresses(first), strains), ca.vec(h))
        return [u0, self.data], [slopes, ca.substitute(moduli, h, rest)]

    @cached_property
    def _second_derivative(self) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """A symbol of the displacement gradient, the gradient, derivatives of the shape functions,
        and the second derivative of the energy by the symbol."""
        cls: Any = self.cls
        slopes, volume = cls.slopes(self._x, self._q)
        gradient = ca.mtimes(ca.horzcat(*self._u), slopes)
        h = ca.SX.sym("h", *gradient.shape)
        moduli, _ = ca.hessian(volume * cls.energy_density(cls.strain(h), self._q), ca.vec(h))
        return h, gradient, slopes, moduli
