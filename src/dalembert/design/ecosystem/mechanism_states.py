"""State equations of a mechanism: assembled position, or static equilibrium with multipliers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np
import scipy

from dalembert.analysis.equilibrium.equilibrium import Equilibrium
from dalembert.analysis.equilibrium.statics_kernel import statics_kernel
from dalembert.design.ecosystem.states import (
    Change,
    Measures,
    StateEquations,
    StateTangent,
    StateVariable,
    labelled_measures,
)
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.model.graph.model import Model
from dalembert.sparse.factorise import general_factors
from dalembert.sparse.solver import Factors

Solver = Callable[[np.ndarray, np.ndarray | None], np.ndarray]


@dataclass(frozen=True)
class PositionEquations:
    """Equations of a position and of additional unknowns.

    Attributes
    ----------
    residual : SX
    rows : scales of the residual
    additional : SX symbols of additional unknowns
    additional_sizes : scales of the additional unknowns
    solve : ``(p, initial state) → state``
    """

    residual: ca.SX
    rows: np.ndarray
    additional: ca.SX
    additional_sizes: np.ndarray
    solve: Solver


def assembly_equations(model: Model, time: float) -> PositionEquations:
    """``Φ(y, p) = 0`` and the prescribed coordinates."""
    model.closure.refuse_singular_start()
    recipe = model.closure.recipe
    residual, rows = recipe.position_equations

    def solve(p: np.ndarray, initial: np.ndarray | None) -> np.ndarray:
        return model.assemble(p, time).y

    return PositionEquations(residual, rows, ca.SX(0, 1), np.zeros(0), solve)


def equilibrium_equations(model: Model, analysis: Equilibrium) -> PositionEquations:
    """``f − d − Cᵀ λ = 0``, ``Φ = 0``."""
    kernel, e, s = statics_kernel(model), model.equations, model.scales
    residual = ca.vertcat(kernel.balance, e.constraints)
    sizes = e.scales

    def solve(p: np.ndarray, initial: np.ndarray | None) -> np.ndarray:
        start = None if initial is None else initial[: e.coordinate_count]
        equilibrium = analysis.run(model, p, start=start)
        if not equilibrium.status.success:
            raise AnalysisError(f"{model.name}: no equilibrium, {equilibrium.status}")
        return kernel.near(equilibrium.trajectory)[:, 0]

    rows = np.concatenate([sizes.efforts, sizes.rows])
    forces = np.maximum(sizes.multipliers, s.energy * 1e-12)
    return PositionEquations(residual, rows, e.multiplier, forces, solve)


class MechanismStates(StateEquations):
    """Coordinates ``y`` at rest, and multipliers in equilibrium.

    Parameters
    ----------
    model : Model
    analysis : Equilibrium, or None for the assembled position
    measures : of position, and of multipliers in equilibrium
    time : instant of an assembled position [s]

    Raises
    ------
    UnsupportedError
        Positions are path-dependent (rolling).
    AnalysisError
        A measure depends on more than the state.
    """

    model: Model
    samples = 1

    def __init__(
        self, model: Model, analysis: Equilibrium | None, measures: Measures, time: float = 0.0
    ):
        e = model.equations
        if e.slips:
            raise UnsupportedError(
                f"{model.name}: positions of rolling bodies are path-dependent and no solution of "
                "state equations"
            )
        self.model, self.at_rest = model, analysis is not None
        self.time = time if analysis is None else analysis.time
        self.system = (
            assembly_equations(model, time)
            if analysis is None
            else equilibrium_equations(model, analysis)
        )
        self.measured = labelled_measures(model, measures)
        self.unknown = ca.vertcat(e.y, self.system.additional)
        bounds = e.manifold.bounds
        self.equations = ca.vertcat(self.system.residual, bounds)
        self.sizes = np.concatenate([self.system.rows, np.ones(bounds.numel())])
        self.scales = np.concatenate([e.scales.coordinates, self.system.additional_sizes])
        self.variables = [StateVariable("coordinates", (e.coordinate_count,), model.guesses.names)]
        if self.at_rest and e.constraint_count:
            names = [model.equation_names[k] for k in model.closure.rows]
            self.variables.append(StateVariable("multipliers", (len(names),), names))
        self._measure_graphs = [self._static_measure(label) for label in self.measured]

    def _static_measure(self, label: str) -> ca.SX:
        """Graph of a measure at rest, as a function of the state."""
        e = self.model.equations
        sx = e.without_dropped(self.measured[label].sx)
        if self.at_rest:
            rates = ca.vertcat(e.v, e.a)
            sx = ca.substitute(sx, rates, ca.SX.zeros(rates.numel()))
        elif ca.depends_on(sx, ca.vertcat(e.v, e.a, e.multiplier)):
            raise AnalysisError(
                f"{label}: an assembled position has no speeds and no forces; use a measure of "
                "positions, or analysis=Equilibrium() for forces"
            )
        return sx

    def solve(self, p: np.ndarray, initial: np.ndarray | None = None) -> np.ndarray:
        return self.system.solve(p, initial)

    def residual(self, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        return self._values(self.time, x, p)[0].full().ravel()

    def measures(self, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        return self._values(self.time, x, p)[1].full().ravel()

    def tangent(self, x: np.ndarray, p: np.ndarray) -> MechanismTangent:
        slopes = [scipy.sparse.csc_array(s.sparse()) for s in self._slopes(self.time, x, p)]
        return MechanismTangent(self, slopes)

    @cached_property
    def _inputs(self) -> list[ca.SX]:
        return [self.model.equations.t, self.unknown, self.model.equations.p]

    @cached_property
    def _values(self) -> ca.Function:
        """``(t, x, p) → r, m``."""
        outputs = [ca.densify(self.equations), ca.densify(ca.vertcat(*self._measure_graphs))]
        return ca.Function("state", self._inputs, outputs, {"cse": True})

    @cached_property
    def _slopes(self) -> ca.Function:
        """``(t, x, p) →`` derivatives of ``r`` and ``m`` by ``x`` and ``p``."""
        _, x, p = self._inputs
        functions = [self.equations, ca.vertcat(ca.SX(0, 1), *self._measure_graphs)]
        outputs = [ca.jacobian(function, argument) for function in functions for argument in (x, p)]
        return ca.Function("state_slopes", self._inputs, outputs, {"cse": True})


class MechanismTangent(StateTangent):
    """Sparse derivatives, factorised on demand."""

    def __init__(self, states: MechanismStates, slopes: list[scipy.sparse.csc_array]):
        self.states = states
        self.by_state, self.by_p, self.measure_by_state, self.measure_by_p = slopes

    @cached_property
    def _factors(self) -> Factors:
        """Factors of the scaled derivative by the state."""
        rows = scipy.sparse.diags_array(1 / self.states.sizes)
        columns = scipy.sparse.diags_array(self.states.scales)
        try:
            return general_factors(scipy.sparse.csc_array(rows @ self.by_state @ columns))
        except np.linalg.LinAlgError:
            raise AnalysisError(
                f"{self.states.model.name}: the position is singular or not fixed; its "
                "equations have no unique solution nearby"
            ) from None

    def push(self, dx: np.ndarray, dp: np.ndarray) -> Change:
        return Change(
            self.by_state @ dx + self.by_p @ dp,
            self.measure_by_state @ dx + self.measure_by_p @ dp,
        )

    def pull(self, r_bar: np.ndarray, m_bar: np.ndarray) -> Change:
        return Change(
            self.by_state.T @ r_bar + self.measure_by_state.T @ m_bar,
            self.by_p.T @ r_bar + self.measure_by_p.T @ m_bar,
        )

    def solve(self, rhs: np.ndarray, trans: str = "N") -> np.ndarray:
        left, right = self.states.scales, 1 / self.states.sizes
        if trans == "T":
            left, right = right, left
        return left * self._factors.solve(right * rhs, trans)
