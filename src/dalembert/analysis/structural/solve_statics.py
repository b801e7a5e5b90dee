"""The verb of structural statics, linear or not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dalembert.analysis.served import need_structure
from dalembert.analysis.structural.nonlinear_statics import NonlinearStatics
from dalembert.analysis.structural.statics import Statics
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
    **options : fields of ``Statics``: solver; of ``NonlinearStatics``: steps, tolerance,
        max_iterations

    Raises
    ------
    AnalysisError
        Wrong options; ``SingularityError`` where the structure is a mechanism.
    """
    need_structure(model, "solve_statics", "take solve_equilibrium")
    chosen = NonlinearStatics if nonlinear else Statics
    return chosen.of("solve_statics", **options).run(model, parameters)
