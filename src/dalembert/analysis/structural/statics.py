"""Linear statics of structures: ``K_ff U_f = P_f − K_fp U_p`` (8.17), reactions by (8.18)."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.analysis.structural.linear_range import linear_doubts
from dalembert.analysis.structural.static_equations import (
    StaticEquations,
    StaticsRecord,
    factorised,
)
from dalembert.errors import UnsupportedError
from dalembert.options import options
from dalembert.results.result import Analysis, ParameterValues
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.result import StructuralResult
from dalembert.sparse.multigrid import Multigrid
from dalembert.sparse.solver import SparseSolver
from dalembert.structures.evaluation.iterative import better_iterative, multigrid_of
from dalembert.structures.model import StructuralModel
from dalembert.timing import Timing

AUTO, DIRECT, ITERATIVE = SOLVERS = ("auto", "direct", "iterative")


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
        self, model: StructuralModel, parameters: ParameterValues = None, progress: Any = False
    ) -> StructuralResult:
        """Displacements and reactions of every load case.

        Raises
        ------
        SingularityError
            The structure can move without straining; names the nodes that do.
        """
        timing, exact = Timing(), model
        model = model.linearized
        p = model.values(parameters)
        assembly, cases = model.assembly, list(model.loads)
        u = np.zeros((assembly.size, len(cases)))
        stiffness = assembly.stiffness(u[:, 0], p)
        timing.lap("assembly")
        factor = self._solver(model, assembly.inner(stiffness), p)
        timing.lap("factorisation")
        u[assembly.prescribed] = model.prescribed.values(p)[:, None]
        begin, free = assembly.internal_forces(u[:, 0], p), assembly.free
        forces, open_by = np.zeros_like(u), 0.0
        for k, equations in enumerate(StaticEquations(model, p, case) for case in cases):
            if factor is not None:
                u[free, k] = factor.solve(equations.left(u[:, k], 1.0, begin)[free])
            left = equations.left(u[:, k], 1.0)
            forces[:, k] = equations.supported(1.0, left)
            open_by = max(open_by, np.abs(left[free]).max(initial=0.0))
        residual = open_by / max(np.abs(forces).max(initial=0.0), 1e-300)
        status = Status(Outcome.COMPLETED, "linear statics", 0.0, float(residual))
        record = StaticsRecord(factor, stiffness)
        timing.lap("solution")
        statistics = self._statistics(model, factor, timing)
        records, warnings = [record] * len(cases), self._doubts(exact, p, cases, u, factor)
        return StructuralResult(
            model, self, p, cases, u, forces, status, statistics, records, warnings
        )

    @staticmethod
    def _doubts(
        model: StructuralModel,
        p: np.ndarray,
        cases: list[str],
        u: np.ndarray,
        factor: SparseSolver | None,
    ) -> list[str]:
        """Displacements that are too large for linear statics."""
        free = model.assembly.free

        def solved(forces: np.ndarray) -> np.ndarray:
            found = np.zeros_like(forces)
            if factor is not None:
                found[free] = factor.solve(forces[free])
            return found

        names = [f"load case {case!r}" if case else "the load" for case in cases]
        return linear_doubts(model, p, names, u, solved, "use nonlinear=True")

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
