"""State equations of a structure: displacements under its load cases."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from dalembert.analysis.equilibrium.equilibrium import Equilibrium
from dalembert.analysis.equilibrium.static_equations import StaticEquations
from dalembert.analysis.equilibrium.statics import Statics, StaticsRecord
from dalembert.design.ecosystem.states import (
    Change,
    Measures,
    StateEquations,
    StateTangent,
    StateVariable,
    labelled_measures,
)
from dalembert.errors import AnalysisError, SingularityError
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.result import StructuralResult

PRESCRIBED = Status(Outcome.COMPLETED, "prescribed displacements", 0.0, 0.0)
"""Status of results at displacements set by another package."""


class StructureStates(StateEquations):
    """Displacements ``U`` (n, cases): ``∂W/∂U = P`` if free, ``U = U_p`` if prescribed.

    Parameters
    ----------
    model : StructuralModel
    analysis : Statics or Equilibrium
    measures : of displacements, forces or elements
    """

    model: StructuralModel

    def __init__(self, model: StructuralModel, analysis: Statics | Equilibrium, measures: Measures):
        self.model, self.analysis = model, analysis
        self.analysed_model = model if isinstance(analysis, Equilibrium) else model.linearized
        self.measured = labelled_measures(model, measures)
        self.cases = list(model.loads)
        shape = len(model.degrees), len(self.cases)
        self.samples = shape[1]
        self.variables = [StateVariable("displacements", shape, model.degrees.names)]
        self._last: StructuralResult | None = None
        start = self.solve(model.nominal)
        assert self._last is not None
        arms = np.where(model.degrees.rotations, model.assembly.arm(model.nominal), 1.0)
        force = float(np.abs(self._last.forces / arms[:, None]).max(initial=0.0)) or 1.0
        prescribed = model.assembly.prescribed
        rows = force * arms
        rows[prescribed] = model.assembly.arm(model.nominal) / arms[prescribed]
        self.sizes = np.repeat(rows, shape[1])
        displacement = float(np.abs(start.reshape(shape) * arms[:, None]).max(initial=0.0)) or 1.0
        self.scales = np.repeat(displacement / arms, shape[1])

    def solve(self, p: np.ndarray, initial: np.ndarray | None = None) -> np.ndarray:
        result = self.analysis.run(self.model, p)
        if not result.status.success:
            raise AnalysisError(f"{self.model.name}: {result.status}")
        self._last = result
        return result.displacements.ravel()

    def residual(self, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        u, residuals = self._shaped(x), np.zeros_like(self._shaped(x))
        for k, equations in enumerate(self._equations(p)):
            residual = sum(equations.internal_terms(u[:, k], 1.0), -equations.applied)
            residual[equations.held] = u[equations.held, k] - equations.prescribed
            residuals[:, k] = residual
        return residuals.ravel()

    def measures(self, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        result = self.result(x, p)
        values = [result.values(measure) for measure in self.measured.values()]
        return np.concatenate([np.zeros(0), *values])

    def tangent(self, x: np.ndarray, p: np.ndarray) -> StructureTangent:
        try:
            return StructureTangent(self, self.result(x, p))
        except SingularityError as error:
            raise AnalysisError(str(error)) from None

    def result(self, x: np.ndarray, p: np.ndarray) -> StructuralResult:
        """Result with forces and reactions at displacements; the last run if it is the same."""
        u, last = self._shaped(x), self._last
        is_equal = np.array_equal
        if last is not None and is_equal(last.parameters, p) and is_equal(last.displacements, u):
            return last
        pairs = list(enumerate(self._equations(p)))
        forces = np.stack([equations.forces(u[:, k], 1.0) for k, equations in pairs], axis=1)
        record = [_LazyRecord(equations, u[:, k]) for k, equations in pairs]
        return StructuralResult(
            self.analysed_model, self.analysis, p, self.cases, u, forces, PRESCRIBED, {}, record
        )

    def _equations(self, p: np.ndarray) -> list[StaticEquations]:
        return [StaticEquations(self.analysed_model, p, case) for case in self.cases]

    def _shaped(self, x: np.ndarray) -> np.ndarray:
        return x.reshape(self.variables[0].shape)


@dataclass
class _LazyRecord:
    """Stiffness at prescribed displacements, factorised on demand."""

    equations: StaticEquations
    u: np.ndarray

    @cached_property
    def stiffness(self) -> Any:
        return self.equations.stiffness(self.u, 1.0)

    @cached_property
    def factor(self) -> Any:
        return self.equations.factor(self.stiffness)


class StructureTangent(StateTangent):
    """Derivatives for all load cases, with the factors of the analysis if available."""

    def __init__(self, states: StructureStates, result: StructuralResult):
        self.states, self.result, self.p = states, result, result.parameters
        self.model = result.model
        self.free = self.model.assembly.free
        self.held = self.model.assembly.prescribed
        self.weights = [
            [result.weights(measure.sx, k) for measure in states.measured.values()]
            for k in range(len(states.cases))
        ]

    def push(self, dx: np.ndarray, dp: np.ndarray) -> Change:
        du = dx.reshape(-1, self.cases)
        residual, measures = np.zeros_like(du), np.zeros((len(self.states.measured), self.cases))
        for k in range(self.cases):
            applied, internal, prescribed = self._parameter_changes(k, dp)
            if du[:, k].any():
                internal = internal + self.record(k).stiffness @ du[:, k]
            unbalanced, forces = internal - applied, applied.copy()
            forces[self.held] = unbalanced[self.held]
            unbalanced[self.held] = du[self.held, k] - prescribed
            residual[:, k] = unbalanced
            for i, weight in enumerate(self.weights[k]):
                measures[i, k] = weight.u @ du[:, k] + weight.forces @ forces + weight.p @ dp
        return Change(residual.ravel(), measures.ravel())

    def _parameter_changes(
        self, case: int, dp: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Changes with the parameters: of loads, internal forces and prescribed displacements."""
        u, model = self.result.displacements[:, case], self.model
        if not dp.any():
            return np.zeros_like(u), np.zeros_like(u), np.zeros(self.held.size)
        loads = model.loads[self.states.cases[case]]
        internal = model.assembly.push(u, self.p, dp) + loads.configuration.push(u, self.p, dp)
        return loads.push(self.p, dp), internal, model.prescribed.push(self.p, dp)

    def pull(self, r_bar: np.ndarray, m_bar: np.ndarray) -> Change:
        model, held = self.model, self.held
        by_case, by_measure = r_bar.reshape(-1, self.cases), m_bar.reshape(-1, self.cases)
        u_bar, p_bar = np.zeros_like(by_case), np.zeros(self.p.size)
        for k, case in enumerate(self.states.cases):
            u, loads = self.result.displacements[:, k], model.loads[case]
            internal, forces, u_weight = by_case[:, k].copy(), np.zeros(u.size), np.zeros(u.size)
            u_weight[held] = by_case[held, k]
            p_bar -= model.prescribed.pull(self.p, by_case[held, k])
            internal[held] = 0.0
            for m_weight, weight in zip(by_measure[:, k], self.weights[k], strict=True):
                u_weight += m_weight * weight.u
                forces += m_weight * weight.forces
                p_bar += m_weight * weight.p
            applied = forces - internal
            applied[held], internal[held] = -forces[held], forces[held]  # of reactions
            u_bar[:, k] = u_weight + self.record(k).stiffness.T @ internal
            p_bar += model.assembly.pull(u, self.p, internal)
            p_bar += loads.configuration.pull(u, self.p, internal)
            p_bar += loads.pull(self.p, applied)
        return Change(u_bar.ravel(), p_bar)

    def solve(self, rhs: np.ndarray, trans: str = "N") -> np.ndarray:
        loads = rhs.reshape(-1, self.cases)
        solution = loads.copy()
        for k in range(self.cases):
            record = self.record(k)
            if record.factor is None:
                continue
            coupling = record.stiffness[self.free][:, self.held]
            free_loads = loads[self.free, k]
            if trans == "N":
                free_loads = free_loads - coupling @ loads[self.held, k]
            solution[self.free, k] = record.factor.solve(np.ascontiguousarray(free_loads), trans)
            if trans == "T":
                solution[self.held, k] -= coupling.T @ solution[self.free, k]
        return solution.ravel()

    @property
    def cases(self) -> int:
        return len(self.states.cases)

    def record(self, case: int) -> StaticsRecord:
        """Stiffness and factors of a load case."""
        record: StaticsRecord = self.result.record[case]
        return record
