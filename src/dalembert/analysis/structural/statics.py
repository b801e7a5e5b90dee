"""Linear statics of structures: ``K_ff U_f = P_f − K_fp U_p`` (8.17), reactions by (8.18)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.results.result import Analysis, Given
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.result import StructuralResult
from dalembert.sparse.solver import Factors
from dalembert.structures.factors import factors_of
from dalembert.structures.model import StructuralModel


@dataclass(frozen=True)
class StaticsRecord:
    """What a gradient needs: the stiffness, and the factors of its free part ``K_ff``."""

    factor: Factors | None
    stiffness: Any


@dataclass(frozen=True)
class Statics(Analysis[StructuralModel, StructuralResult]):
    """Linear statics as a strategy object; all load cases share one factorisation."""

    spoken = "linear statics"
    at_rest = True

    def run(
        self, model: StructuralModel, parameters: Given = None, progress: Any = False
    ) -> StructuralResult:
        """Displacements and reactions of every load case.

        Raises
        ------
        SingularityError
            The structure can move without straining; names the nodes that do.
        """
        model = model.linearized
        p = model.values(parameters)
        assembly, size = model.assembly, len(model.degrees)
        free, held = assembly.free, assembly.prescribed
        rest = np.zeros(size)
        stiffness = assembly.stiffness(rest, p)
        factor = factorised(model, assembly.inner(stiffness))
        start = assembly.internal_forces(rest, p)
        u = np.zeros((size, len(model.loads)))
        forces = np.zeros_like(u)
        for k, load in enumerate(model.loads.values()):
            applied, begin = load.values(p), start + load.configuration.forces(rest, p)
            u[held, k] = model.prescribed.values(p)
            if factor is not None:
                open_by = applied - begin - stiffness @ u[:, k]
                u[free, k] = factor.solve(open_by[free])
            internal = begin + stiffness @ u[:, k]
            forces[:, k] = applied
            forces[held, k] = (internal - applied)[held]
        residual = self._residual(model, p, u, forces)
        status = Status(Outcome.COMPLETED, "linear statics", 0.0, residual)
        record = StaticsRecord(factor, stiffness)
        statistics = {"displacements": size, "free": int(free.size)}
        return StructuralResult(
            model, self, p, list(model.loads), u, forces, status, statistics, [record] * u.shape[1]
        )

    @staticmethod
    def _residual(model: StructuralModel, p, u: np.ndarray, forces: np.ndarray) -> float:
        """Largest force left over on free displacements, relative to the largest of all."""
        free, left = model.assembly.free, []
        for k, load in enumerate(model.loads.values()):
            rest = model.assembly.internal_forces(u[:, k], p) - forces[:, k]
            rest += load.configuration.forces(u[:, k], p)
            left.append(np.abs(rest[free]).max(initial=0.0))
        return float(max(left, default=0.0) / max(np.abs(forces).max(initial=0.0), 1e-300))


def factorised(model: StructuralModel, matrix) -> Factors | None:
    """Sparse factors of the stiffness of the free displacements.

    Raises
    ------
    SingularityError
        It is singular: names the nodes that can move without straining anything.
    """
    return factors_of(matrix, model.degrees, model.assembly.free)
