"""The verb of structural statics, linear or not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dalembert.analysis.structural.nonlinear_statics import NonlinearStatics
from dalembert.analysis.structural.statics import Statics
from dalembert.errors import AnalysisError
from dalembert.results.structural.result import StructuralResult
from dalembert.structures.model import StructuralModel


def solve_statics(
    model: StructuralModel,
    *,
    parameters: Mapping[str, float] | None = None,
    nonlinear: bool = False,
    **options: Any,
) -> StructuralResult:
    """Statics of a structure, ``K U = P`` partitioned by (8.14).

    Parameters
    ----------
    model : StructuralModel
    parameters : new values of parameters, without rebuilding
    nonlinear : for large displacements
    **options : fields of ``NonlinearStatics``: steps, tolerance, max_iterations

    Raises
    ------
    AnalysisError
        Wrong options; ``SingularityError`` where the structure is a mechanism.
    """
    try:
        analysis: Statics | NonlinearStatics
        analysis = NonlinearStatics(**options) if nonlinear else Statics(**options)
    except TypeError as error:
        raise AnalysisError(f"solve_statics: {error}") from None
    return analysis.run(model, parameters)
