"""Statics of structures: ``K_ff U_f = P_f − K_fp U_p`` (8.17), reactions by (8.18)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Unpack, overload

import numpy as np

from dalembert.analysis.batch.solve import run_analysis
from dalembert.analysis.equilibrium.equilibrium import Equilibrium
from dalembert.analysis.equilibrium.linear_range import linear_range_warnings
from dalembert.analysis.equilibrium.static_equations import (
    StaticEquations,
    StaticsRecord,
    free_factors,
)
from dalembert.analysis.keywords import StaticsKeywords
from dalembert.analysis.times import analysis_of
from dalembert.errors import UnsupportedError
from dalembert.model.assembled.evaluation.stiffness_solvers import (
    better_iterative,
    multigrid_of,
)
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.graph.model import Model
from dalembert.options import options
from dalembert.results.analysis import Analysis, ParameterValues
from dalembert.results.batch.batch import Batch
from dalembert.results.live import LiveFunctions
from dalembert.results.motion import Motion
from dalembert.results.sources import Row
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.result import StructuralResult
from dalembert.sparse.multigrid import Multigrid
from dalembert.sparse.solver import SparseSolver
from dalembert.text.arguments import check_arguments
from dalembert.timing import Timing

if TYPE_CHECKING:
    from dalembert.results.batch.designs import ManyDesigns

AUTO, DIRECT, ITERATIVE = SOLVERS = ("auto", "direct", "iterative")


@options
class Statics(Analysis[StructuralModel, StructuralResult]):
    """Linear statics as a strategy object; all load cases share one factorisation.

    Parameters
    ----------
    solver : ``"direct"`` factorises the stiffness; ``"iterative"`` uses conjugate gradients with
        algebraic multigrid, which needs less memory; ``"auto"`` the latter where factors do not fit

    Raises
    ------
    UnsupportedError
        Unknown solver.

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

    display_name = "linear statics"
    kinds = ("structure",)
    instead = "use solve_equilibrium"
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
            The structure can move without strain; names the nodes.
        """
        self.for_model(model)
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
        strain, free = assembly.internal_forces(u[:, 0], p), assembly.free
        forces, imbalance = np.zeros_like(u), 0.0
        for k, equations in enumerate(StaticEquations(model, p, case) for case in cases):
            if factor is not None:
                u[free, k] = factor.solve(equations.unbalanced(u[:, k], 1.0, strain)[free])
            unbalanced = equations.unbalanced(u[:, k], 1.0)
            forces[:, k] = equations.with_reactions(1.0, unbalanced)
            imbalance = max(imbalance, np.abs(unbalanced[free]).max(initial=0.0))
        residual = imbalance / max(np.abs(forces).max(initial=0.0), 1e-300)
        status = Status(Outcome.COMPLETED, "linear statics", 0.0, float(residual))
        record = StaticsRecord(factor, stiffness)
        timing.lap("solution")
        statistics = self._statistics(model, factor, timing)
        names = [f"load case {case!r}" if case else "the load" for case in cases]
        warnings = linear_range_warnings(exact, p, names, u, factor)
        records = [record] * len(cases)
        return StructuralResult(
            model, self, p, cases, u, forces, status, statistics, records, warnings
        )

    def live_obstacle(self, result: StructuralResult) -> str:
        from dalembert.analysis.live.structure_module import statics_obstacle

        return statics_obstacle(result)

    def live_functions(
        self, result: StructuralResult, rows: Sequence[Row], times: np.ndarray
    ) -> LiveFunctions:
        from dalembert.analysis.live.structure_module import statics_functions

        return statics_functions(result, rows, times)

    def _solver(self, model: StructuralModel, matrix: Any, p: np.ndarray) -> SparseSolver | None:
        blocks, free = model.assembly.blocks, model.assembly.free
        iterative = self.solver == ITERATIVE
        if self.solver == AUTO:
            iterative = better_iterative(free.size, blocks)
        if iterative:
            return multigrid_of(matrix, blocks, model.degrees, free, p)
        return free_factors(model, matrix)

    @staticmethod
    def _statistics(
        model: StructuralModel, factor: SparseSolver | None, timing: Timing
    ) -> dict[str, Any]:
        statistics: dict[str, Any] = {
            "displacements": len(model.degrees),
            "free": int(model.assembly.free.size),
            "load cases": len(model.loads),
        }
        if factor is not None:
            statistics["solver"] = factor.name
        if isinstance(factor, Multigrid):
            statistics["iterations"] = factor.iterations
            statistics["solver residual"] = factor.residual
        statistics["build time [s]"] = round(model.build_time, 6)
        return statistics | timing.statistics


@overload
def solve_statics(
    model: StructuralModel,
    *,
    parameters: Mapping[str, float] | None = None,
    nonlinear: bool = False,
    **options: Unpack[StaticsKeywords],
) -> StructuralResult: ...


@overload
def solve_statics(
    model: Model,
    *,
    parameters: Mapping[str, float] | None = None,
    **options: Unpack[StaticsKeywords],
) -> Motion: ...


@overload
def solve_statics(
    model: Model | StructuralModel,
    *,
    parameters: ManyDesigns,
    nonlinear: bool = False,
    workers: int | None = None,
    **options: Unpack[StaticsKeywords],
) -> Batch: ...


@check_arguments
def solve_statics(
    model: Model | StructuralModel,
    *,
    parameters: Any = None,
    nonlinear: bool = False,
    workers: int | None = None,
    **options: Unpack[StaticsKeywords],
) -> StructuralResult | Motion | Batch:
    """Statics of a structure, ``K U = P`` partitioned by (8.14).

    At large displacements, and for mechanisms, it is ``solve_equilibrium``.

    Parameters
    ----------
    model : Model or StructuralModel
    parameters : new values of parameters, without rebuilding; arrays of them, a table or a list
        of dicts for a batch
    nonlinear : for large displacements
    workers : of a batch; by default one for each core
    **options : fields of ``Statics``: solver; of ``Equilibrium``: steps, tolerance,
        max_iterations

    Raises
    ------
    AnalysisError
        Wrong options; ``SingularityError`` where the structure is a mechanism.

    Examples
    --------
    >>> import dalembert as da
    >>> bar = da.Structure("bar")
    >>> a, b = bar.node("a", 0), bar.node("b", "500 mm")
    >>> rod = bar.add(da.structures.Truss("rod", a, b, area="4 cm^2", modulus="210 GPa"))
    >>> bar.support(a)
    >>> bar.load(b, fx="84 kN")
    >>> result = da.solve_statics(bar.build())
    >>> round(result["b.ux"], 9), round(result["rod.stress"])
    (0.0005, 210000000)
    """
    kind: type[Analysis] = Equilibrium if nonlinear or isinstance(model, Model) else Statics
    analysis = analysis_of(kind, "solve_statics", model, parameters, **options)
    return run_analysis(analysis, model, parameters, workers=workers)  # type: ignore[no-any-return]
