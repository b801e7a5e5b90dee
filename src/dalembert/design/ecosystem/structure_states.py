"""Displacements of a structure under its load cases as a state."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from dalembert.analysis.structural.nonlinear_statics import NonlinearStatics
from dalembert.analysis.structural.static_equations import StaticEquations
from dalembert.analysis.structural.statics import Statics, StaticsRecord
from dalembert.design.ecosystem.states import (
    Change,
    Measures,
    StateEquations,
    StateTangent,
    StateVariable,
    labelled,
)
from dalembert.errors import AnalysisError, SingularityError
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.result import StructuralResult
from dalembert.structures.model import StructuralModel

GIVEN = Status(Outcome.COMPLETED, "displacements from elsewhere", 0.0, 0.0)


class StructureStates(StateEquations):
    """All displacements ``U`` (n, cases): ``∂W/∂U = P`` where they are free, ``U = U_p`` else.

    Parameters
    ----------
    model : StructuralModel
    analysis : Statics or NonlinearStatics
    measures : of displacements, forces, elements
    """

    model: StructuralModel

    def __init__(
        self, model: StructuralModel, analysis: Statics | NonlinearStatics, measures: Measures
    ):
        self.model, self.analysis = model, analysis
        self.seen = model if isinstance(analysis, NonlinearStatics) else model.linearized
        self.measured = labelled(model, measures)
        self.cases = list(model.loads)
        shape = len(model.degrees), len(self.cases)
        self.samples = shape[1]
        self.variables = [StateVariable("displacements", shape, model.degrees.names)]
        self._last: StructuralResult | None = None
        start = self.solve(model.nominal)
        assert self._last is not None
        arms = np.where(model.degrees.rotations, model.assembly.arm(model.nominal), 1.0)
        force = float(np.abs(self._last.forces / arms[:, None]).max(initial=0.0)) or 1.0
        held = model.assembly.prescribed
        rows = force * arms
        rows[held] = model.assembly.arm(model.nominal) / arms[held]
        self.sizes = np.repeat(rows, shape[1])
        moved = float(np.abs(start.reshape(shape) * arms[:, None]).max(initial=0.0)) or 1.0
        self.reach = np.repeat(moved / arms, shape[1])

    def solve(self, p: np.ndarray, near: np.ndarray | None = None) -> np.ndarray:
        result = self.analysis.run(self.model, p)
        if not result.status.success:
            raise AnalysisError(f"{self.model.name}: {result.status}")
        self._last = result
        return result.displacements.ravel()

    def residual(self, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        u, rest = self._shaped(x), np.zeros_like(self._shaped(x))
        for k, equations in enumerate(self._equations(p)):
            left = sum(equations.internal_terms(u[:, k], 1.0), -equations.applied)
            left[equations.held] = u[equations.held, k] - equations.prescribed
            rest[:, k] = left
        return rest.ravel()

    def measures(self, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        result = self.result(x, p)
        found = [result.values(one) for one in self.measured.values()]
        return np.concatenate([np.zeros(0), *found])

    def tangent(self, x: np.ndarray, p: np.ndarray) -> StructureTangent:
        try:
            return StructureTangent(self, self.result(x, p))
        except SingularityError as error:
            raise AnalysisError(str(error)) from None

    def result(self, x: np.ndarray, p: np.ndarray) -> StructuralResult:
        """The displacements with forces and reactions there; the last run where that is it."""
        u, last = self._shaped(x), self._last
        same = np.array_equal
        if last is not None and same(last.parameters, p) and same(last.displacements, u):
            return last
        pairs = list(enumerate(self._equations(p)))
        forces = np.stack([one.forces(u[:, k], 1.0) for k, one in pairs], axis=1)
        record = [_Lazy(one, u[:, k]) for k, one in pairs]
        return StructuralResult(
            self.seen, self.analysis, p, self.cases, u, forces, GIVEN, {}, record
        )

    def _equations(self, p: np.ndarray) -> list[StaticEquations]:
        return [StaticEquations(self.seen, p, case) for case in self.cases]

    def _shaped(self, x: np.ndarray) -> np.ndarray:
        return x.reshape(self.variables[0].shape)


@dataclass
class _Lazy:
    """Stiffness at displacements from elsewhere, and factors when something is solved."""

    equations: StaticEquations
    u: np.ndarray

    @cached_property
    def stiffness(self) -> Any:
        return self.equations.stiffness(self.u, 1.0)

    @cached_property
    def factor(self) -> Any:
        return self.equations.factor(self.stiffness)


class StructureTangent(StateTangent):
    """Of all load cases at displacements, with the factors of the analysis where they are there."""

    def __init__(self, of: StructureStates, result: StructuralResult):
        self.of, self.result, self.p = of, result, result.parameters
        self.model = result.model
        self.free = self.model.assembly.free
        self.held = self.model.assembly.prescribed
        self.weights = [
            [result.weights(one.sx, k) for one in of.measured.values()]
            for k in range(len(of.cases))
        ]

    def push(self, dx: np.ndarray, dp: np.ndarray) -> Change:
        du = dx.reshape(-1, self.cases)
        residual, measures = np.zeros_like(du), np.zeros((len(self.of.measured), self.cases))
        for k in range(self.cases):
            applied, internal, given = self._moved(k, dp)
            if du[:, k].any():
                internal = internal + self.record(k).stiffness @ du[:, k]
            left, forces = internal - applied, applied.copy()
            forces[self.held] = left[self.held]
            left[self.held] = du[self.held, k] - given
            residual[:, k] = left
            for i, seen in enumerate(self.weights[k]):
                measures[i, k] = seen.u @ du[:, k] + seen.forces @ forces + seen.p @ dp
        return Change(residual.ravel(), measures.ravel())

    def _moved(self, case: int, dp: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Changes with the parameters: of loads, of internal forces, of what is prescribed."""
        u, model = self.result.displacements[:, case], self.model
        if not dp.any():
            return np.zeros_like(u), np.zeros_like(u), np.zeros(self.held.size)
        loads = model.loads[self.of.cases[case]]
        internal = model.assembly.push(u, self.p, dp) + loads.configuration.push(u, self.p, dp)
        return loads.push(self.p, dp), internal, model.prescribed.push(self.p, dp)

    def pull(self, r_bar: np.ndarray, m_bar: np.ndarray) -> Change:
        model, held = self.model, self.held
        by_case, by_measure = r_bar.reshape(-1, self.cases), m_bar.reshape(-1, self.cases)
        u_bar, p_bar = np.zeros_like(by_case), np.zeros(self.p.size)
        for k, case in enumerate(self.of.cases):
            u, loads = self.result.displacements[:, k], model.loads[case]
            internal, forces, own = by_case[:, k].copy(), np.zeros(u.size), np.zeros(u.size)
            own[held] = by_case[held, k]
            p_bar -= model.prescribed.pull(self.p, by_case[held, k])
            internal[held] = 0.0
            for weight, seen in zip(by_measure[:, k], self.weights[k], strict=True):
                own += weight * seen.u
                forces += weight * seen.forces
                p_bar += weight * seen.p
            applied = forces - internal
            applied[held], internal[held] = -forces[held], forces[held]  # of reactions
            u_bar[:, k] = own + self.record(k).stiffness.T @ internal
            p_bar += model.assembly.pull(u, self.p, internal)
            p_bar += loads.configuration.pull(u, self.p, internal)
            p_bar += loads.pull(self.p, applied)
        return Change(u_bar.ravel(), p_bar)

    def solve(self, rhs: np.ndarray, trans: str = "N") -> np.ndarray:
        given = rhs.reshape(-1, self.cases)
        found = given.copy()
        for k in range(self.cases):
            record = self.record(k)
            if record.factor is None:
                continue
            across = record.stiffness[self.free][:, self.held]
            open_by = given[self.free, k]
            if trans == "N":
                open_by = open_by - across @ given[self.held, k]
            found[self.free, k] = record.factor.solve(np.ascontiguousarray(open_by), trans)
            if trans == "T":
                found[self.held, k] -= across.T @ found[self.free, k]
        return found.ravel()

    @property
    def cases(self) -> int:
        return len(self.of.cases)

    def record(self, case: int) -> StaticsRecord:
        """Stiffness and factors of a load case."""
        found: StaticsRecord = self.result.record[case]
        return found
