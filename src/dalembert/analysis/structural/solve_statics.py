"""The verb of structural statics, linear or not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Unpack, overload

from dalembert.analysis.batch.solve import run_analysis
from dalembert.analysis.keywords import StaticsKeywords
from dalembert.analysis.requirements import need_structure
from dalembert.analysis.structural.nonlinear_statics import NonlinearStatics
from dalembert.analysis.structural.statics import Statics
from dalembert.analysis.times import analysis_of
from dalembert.results.batch.batch import Batch
from dalembert.results.structural.result import StructuralResult
from dalembert.structures.model import StructuralModel
from dalembert.text.spelling import spelled

if TYPE_CHECKING:
    from dalembert.results.batch.designs import ManyDesigns


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
    model: StructuralModel,
    *,
    parameters: ManyDesigns,
    nonlinear: bool = False,
    workers: int | None = None,
    **options: Unpack[StaticsKeywords],
) -> Batch: ...


@spelled
def solve_statics(
    model: StructuralModel,
    *,
    parameters: Any = None,
    nonlinear: bool = False,
    workers: int | None = None,
    **options: Unpack[StaticsKeywords],
) -> StructuralResult | Batch:
    """Statics of a structure, ``K U = P`` partitioned by (8.14).

    Parameters
    ----------
    model : StructuralModel
    parameters : new values of parameters, without rebuilding; arrays of them, a table or a list
        of dicts for a batch
    nonlinear : for large displacements
    workers : of a batch; by default one for each core
    **options : fields of ``Statics``: solver; of ``NonlinearStatics``: steps, tolerance,
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
    chosen = NonlinearStatics if nonlinear else Statics
    made = analysis_of(chosen, "solve_statics", model, parameters, **options)
    need_structure(model, "solve_statics", "take solve_equilibrium")
    return run_analysis(made, model, parameters, workers=workers)  # type: ignore[no-any-return]
