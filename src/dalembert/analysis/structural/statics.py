"""Linear statics of structures: ``K_ff U_f = P_f − K_fp U_p`` (8.17), reactions by (8.18)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.options import options
from dalembert.results.result import Analysis, Given
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.result import StructuralResult
from dalembert.sparse.multigrid import Multigrid
from dalembert.sparse.solver import Factors, SparseSolver
from dalembert.structures.evaluation.factors import factors_of
from dalembert.structures.evaluation.iterative import better_iterative, multigrid_of
from dalembert.structures.model import StructuralModel
from dalembert.timing import Timing

AUTO, DIRECT, ITERATIVE = SOLVERS = ("auto", "direct", "iterative")


@dataclass(frozen=True)
class StaticsRecord:
    """What a gradient needs: the stiffness, and what solves with its free part ``K_ff``."""

    factor: SparseSolver | None
    stiffness: Any


@options
class Statics(Analysis[StructuralModel, StructuralResult]):
    """Linear statics as a strategy object; all load cases share one factorisation.

    Parameters
    ----------
    solver : ``"direct"`` factors the stiffness; ``"iterative"`` takes conjugate gradients with
        algebraic multigrid, which needs less memory; ``"auto"`` that where factors would not fit

    Raises
    ------
    UnsupportedError
        Another solver.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> rod = da.Structure("rod")
    >>> length = rod.parameter("length", 2.0, unit="m")
    >>> top, end = rod.node("top", 0), rod.node("end", length)
    >>> part = rod.add(structures.Truss("rod", top, end, area=1e-4, modulus=2e11))
    >>> rod.support(top)
    >>> rod.load(end, case="small", fx=1e4)
    >>> rod.load(end, case="large", fx=4e4)
    >>> result = da.Statics(solver="direct").run(rod.build(), {"length": 1.0})
    >>> (result["end.ux"] * 1e3).round(6)  # F L/(E A) [mm] of both load cases
    array([0.5, 2. ])
    """

    spoken = "linear statics"
    at_rest = True

    solver: str = "auto"

    def __post_init__(self) -> None:
        if self.solver not in SOLVERS:
            raise UnsupportedError(
                f"Statics(solver={self.solver!r}): solver must be one of {', '.join(SOLVERS)}"
            )

    def run(
        self, model: StructuralModel, parameters: Given = None, progress: Any = False
    ) -> StructuralResult:
        """Displacements and reactions of every load case.

        Raises
        ------
        SingularityError
            The structure can move without straining; names the nodes that do.
        """
        timing = Timing()
        model = model.linearized
        p = model.values(parameters)
        assembly, size = model.assembly, len(model.degrees)
        free, held = assembly.free, assembly.prescribed
        rest = np.zeros(size)
        stiffness = assembly.stiffness(rest, p)
        timing.lap("assembly")
        factor = self._solver(model, assembly.inner(stiffness), p)
        timing.lap("factorisation")
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
        timing.lap("solution")
        statistics = self._statistics(model, factor, timing)
        return StructuralResult(
            model, self, p, list(model.loads), u, forces, status, statistics, [record] * u.shape[1]
        )

    def _solver(self, model: StructuralModel, matrix: Any, p: np.ndarray) -> SparseSolver | None:
        blocks, free = model.assembly.blocks, model.assembly.free
        chosen = self.solver == ITERATIVE
        if self.solver == AUTO:
            chosen = better_iterative(free.size, blocks)
        if chosen:
            return multigrid_of(matrix, blocks, model.degrees, free, p)
        return factorised(model, matrix)

    @staticmethod
    def _statistics(
        model: StructuralModel, factor: SparseSolver | None, timing: Timing
    ) -> dict[str, Any]:
        found: dict[str, Any] = {
            "displacements": len(model.degrees),
            "free": int(model.assembly.free.size),
            "load cases": len(model.loads),
        }
        if factor is not None:
            found["solver"] = factor.name
        if isinstance(factor, Multigrid):
            found["iterations"] = factor.iterations
            found["residual of the solver"] = factor.residual
        found["build time [s]"] = round(model.build_time, 6)
        return found | timing.statistics

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
