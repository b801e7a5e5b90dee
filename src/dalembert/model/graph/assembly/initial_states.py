"""Initial values of the states of first order: prescribed, or steady."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.errors import AssemblyError, ModelError
from dalembert.model.graph.assembly.guesses import Guesses
from dalembert.model.graph.equations import Equations
from dalembert.symbolic.equations import newton
from dalembert.symbolic.equations.factor import QrFactor
from dalembert.symbolic.equations.implicit import Stage

SETTINGS = newton.NewtonSettings(tolerance=1e-12, max_iterations=100)
"""Settings for steady states."""


class InitialStates:
    """Values ``x`` of the states at the start: formulas of parameters, or the root of ``f = 0``.

    Parameters
    ----------
    equations : Equations
    guesses : a state without a guess is steady

    Attributes
    ----------
    y : SX (n_y,), coordinates at the start after the last of ``stages``
    """

    def __init__(self, equations: Equations, guesses: Guesses):
        self.e, self.guesses = equations, guesses
        states = equations.states
        self.steady = [k for k in states if guesses.pose[k] is None]
        self.prescribed = [k for k in states if guesses.pose[k] is not None]
        self.root = ca.SX.sym("steady", len(self.steady))
        self.y = ca.SX(equations.y)
        if self.steady:
            self.y[self.steady] = self.root
            self._check()

    def _check(self) -> None:
        e, steady = self.e, self.e.y[self.steady]
        if ca.depends_on(ca.densify(e.constraints), steady):
            names = ", ".join(self.guesses.names[k] for k in self.steady)
            text = f"a constraint depends on the steady states {names}; give their start"
            raise ModelError(text)

    @property
    def at_start(self) -> Equations:
        """The equations with the prescribed states as formulas of parameters."""
        if not self.prescribed:
            return self.e
        moved = ca.SX(self.e.manifold.moved)
        moved[self.prescribed] = self.guesses.place[self.prescribed]
        return replace(self.e, manifold=replace(self.e.manifold, moved=moved))

    @cached_property
    def _rates(self) -> ca.SX:
        """Rates of the steady states, as functions of ``root``."""
        e = self.e
        return ca.substitute(ca.densify(e.pose_rate[self.steady]), e.y[self.steady], self.root)

    @property
    def sizes(self) -> tuple[np.ndarray, np.ndarray]:
        """Natural sizes of the rates and of the states."""
        size = self.e.scales.coordinates[self.steady]
        return size / self.e.scales.time, size

    def stages(self, start: ca.SX) -> list[Stage]:
        """Stages of an implicit function that follow positions and speeds.

        Parameters
        ----------
        start : SX (n_y,), assembled coordinates
        """
        if not self.steady:
            return []
        factor = QrFactor(ca.jacobian(self._rates, self.root), *self.sizes)
        value = start[self.steady]
        return [Stage(self.root, self._rates, value, factor.solve, factor.solve_transposed)]

    def prescribed_at(self, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Coordinates with the prescribed states for parameter values."""
        if not self.prescribed:
            return y
        y = y.copy()
        y[self.prescribed] = self.guesses.values(p)[0][self.prescribed]
        return y

    def steady_at(self, t: float, y: np.ndarray, v: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Coordinates with steady states at a position and speeds.

        Raises
        ------
        AssemblyError
            There is no steady state.
        """
        if not self.steady:
            return y
        root = newton.solve(_Steady(self, t, y, v, p), y[self.steady], SETTINGS)
        if not root.accepted:
            names = ", ".join(self.guesses.names[k] for k in self.steady)
            text = f"no steady values of {names} at the start ({root}); give their start"
            raise AssemblyError(text, root.residual)
        y = y.copy()
        y[self.steady] = root.x
        return y

    @cached_property
    def function(self) -> ca.Function:
        """``(t, y, v, p, x) → f, ∂f/∂x`` of the steady states."""
        e, rates = self.e, self._rates
        outputs = [rates, ca.densify(ca.jacobian(rates, self.root))]
        return ca.Function("steady", [e.t, e.y, e.v, e.p, self.root], outputs)

    @cached_property
    def columns(self) -> ca.Function:
        """The same with the Jacobian as a column."""
        arguments = self.function.sx_in()
        value, jacobian = self.function.call(arguments)
        return ca.Function("steady_columns", arguments, [value, ca.vec(jacobian)], {"cse": True})


class _Steady(newton.Equations[np.ndarray]):
    """``f = 0`` at a position and speeds."""

    def __init__(
        self, states: InitialStates, t: float, y: np.ndarray, v: np.ndarray, p: np.ndarray
    ):
        self.states, self.at = states, (t, y, v, p)

    def residual(self, x: np.ndarray) -> newton.Residual:
        value, jacobian = (out.full() for out in self.states.function(*self.at, x))
        size = self.states.sizes[0]
        scale = np.maximum(size, np.abs(jacobian) @ np.abs(x))
        return newton.Residual(value.ravel(), scale)

    def step(self, x: np.ndarray, residual: newton.Residual) -> np.ndarray:
        jacobian = self.states.function(*self.at, x)[1].full()
        return -np.linalg.solve(jacobian, residual.value)
