"""Second derivatives: products of the Hessian of a response with a direction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from dalembert.analysis.times import follow_parameters
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.responses.base import Response
from dalembert.responses.evaluation import as_responses
from dalembert.responses.smooth_extreme import SmoothExtreme
from dalembert.results.result import Result
from dalembert.sensitivity.gradient import (
    chosen_columns,
    refuse_unfinished,
    refuse_unknown_values,
)
from dalembert.sensitivity.registry import engine_of
from dalembert.text.arguments import check_arguments

if TYPE_CHECKING:
    import xarray as xr


@check_arguments
def hessian_product(
    result: Result,
    response: Response,
    direction: Mapping[str, float] | Sequence[float] | np.ndarray,
    wrt: Sequence[str] | None = None,
) -> xr.DataArray:
    """``H d``: the change of the gradient of a response along a direction ``d`` of the parameters.

    Forward-over-adjoint differentiation: the exact derivative of the adjoint gradient. With the
    change ``ẋ`` of the result along ``d`` from one direct solution, the adjoint equations are
    differentiated along ``(ẋ, d)``. The cost does not grow with the number of parameters.

    Parameters
    ----------
    result : result of an analysis with gradients
    response : the response
    direction : parameter → component, others zero; or all components in the order of ``wrt``
    wrt : names of parameters, for the rows and for a ``direction`` without names; default all

    Raises
    ------
    AnalysisError
        Unknown parameter, a direction of a wrong length, a run that failed, no derivative there.
    UnsupportedError
        Second derivatives of this analysis, integrator or response are not available.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> spring = da.Structure("spring")
    >>> k, load = spring.parameter("k", 10.0), spring.parameter("load", 5.0)
    >>> end = spring.node("end", 0)
    >>> part = spring.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> spring.load(end, fx=load)
    >>> result = da.solve_statics(spring.build())
    >>> row = da.hessian_product(result, da.final("end.ux"), {"k": 1.0})
    >>> row.values.round(6)  # 2 F/k³, -1/k²
    array([ 0.01, -0.01])
    """
    import xarray as xr

    columns = chosen_columns(result, wrt)
    full = _full_direction(result, direction, columns)
    refuse_unfinished(result)
    (response,) = as_responses([response])
    refuse_unknown_values(result, [response])
    if result.parameters.size > len(result.model.parameters):
        raise UnsupportedError(
            "second derivatives are not available if structures of flexible bodies depend on "
            "parameters; use differences of gradients"
        )
    if follow_parameters(result.analysis):
        raise UnsupportedError(
            "second derivatives are available at fixed times only, but times of this run are "
            "formulas of parameters; give numbers"
        )
    engine = engine_of(result, [response])
    if any(sample.final_event for sample in engine.samples):
        raise UnsupportedError(
            f"{response.label} is evaluated at an event; second derivatives are available "
            "at fixed times only"
        )
    for sample, (_, term) in zip(engine.samples, response.terms, strict=True):
        if term.has_adaptive_times(result) and not isinstance(sample.response, SmoothExtreme):
            raise UnsupportedError(
                f"{term.label} is evaluated at the instant of an extreme, which moves with the "
                "parameters; second derivatives are available at fixed times only; use smooth="
            )
    parameters = list(result.model.parameters.values())
    product = engine.hessian_product(full)[0, columns]
    if not np.all(np.isfinite(product)):
        raise AnalysisError(
            f"second derivatives of {response.label} are not finite: the measure has none at "
            "some state of the run, as a root has none at zero; use another measure or instant"
        )
    return xr.DataArray(
        product,
        {
            "parameter": [parameters[i].name for i in columns],
            "parameter_unit": ("parameter", [parameters[i].unit for i in columns]),
        },
        ("parameter",),
        "hessian_product",
        {"response": response.label, "model": result.model.name},
    )


def _full_direction(result: Result, direction, columns: list[int]) -> np.ndarray:
    """(np,) direction with components for all parameters."""
    full = np.zeros(result.parameters.size)
    if isinstance(direction, Mapping):
        components = np.array(list(direction.values()), dtype=float)
        columns = chosen_columns(result, list(direction))
    else:
        components = np.asarray(direction, dtype=float)
    if components.shape != (len(columns),):
        raise AnalysisError(
            f"the direction has {components.size} component(s), but there are {len(columns)} "
            "parameters"
        )
    if not np.all(np.isfinite(components)):
        raise AnalysisError(
            f"the direction has a component {components[~np.isfinite(components)][0]}"
        )
    full[columns] = components
    return full
