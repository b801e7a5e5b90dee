"""Global sensitivity: Sobol' and Morris indices."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.studies.design_table import DesignTable, Ranges
from dalembert.design.studies.sweep_result import SweepResult
from dalembert.errors import AnalysisError
from dalembert.packages import optional_package
from dalembert.text.arguments import check_arguments

if TYPE_CHECKING:
    import xarray as xr

Run = Callable[[DesignTable], SweepResult]
"""Function that runs designs, such as ``lambda design: da.sweep(model, design, ...)``."""


@check_arguments
def sobol_indices(
    run: Run, ranges: Ranges, samples: int = 256, rng: int | None = None
) -> xr.Dataset:
    """Sobol' indices: shares of the variance of each response due to each parameter.

    ``first = Var(E[f|x])/Var(f)`` alone and ``total = 1 − Var(E[f|others])/Var(f)`` with all
    interactions, for uniform and independent parameters; each with the half width of its 95 %
    confidence interval by bootstrap. Requires ``samples·(k + 2)`` designs.
    Source: A. Saltelli et al. (2010), Computer Physics Communications 181, by SALib.

    Parameters
    ----------
    run : function that runs the designs
    ranges : parameter → lower and upper bound
    samples : a power of two
    rng : seed

    Raises
    ------
    AnalysisError
        A design fails; the estimates need all designs.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> model = da.Structure("sum")
    >>> a, b = model.parameter("a", 1.0), model.parameter("b", 1.0)
    >>> end = model.node("end", 0)
    >>> part = model.add(structures.GroundSpring("spring", end, stiffness_x=1.0))
    >>> built, response = model.build(), da.final("3*a + b")
    >>> def run(design):
    ...     return da.sweep(built, design, analysis=da.Statics(), responses=response)
    >>> shares = da.sobol_indices(run, {"a": (0, 1), "b": (0, 1)}, samples=32, rng=1)
    >>> shares["total"].values.round(1).ravel()  # 9 and 1 of 10
    array([0.9, 0.1])
    """
    optional_package("SALib", "a sensitivity index")
    from SALib.analyze import sobol as analysis
    from SALib.sample import sobol as sampling

    problem = _problem(ranges)
    values = sampling.sample(problem, samples, calc_second_order=False, seed=rng)

    def indices(response: np.ndarray) -> Mapping[str, np.ndarray]:
        result = analysis.analyze(problem, response, calc_second_order=False, seed=rng)
        return {
            "first": result["S1"],
            "first_error": result["S1_conf"],
            "total": result["ST"],
            "total_error": result["ST_conf"],
        }

    return _index_dataset(run, ranges, values, indices)


@check_arguments
def morris_indices(
    run: Run, ranges: Ranges, trajectories: int = 20, levels: int = 4, rng: int | None = None
) -> xr.Dataset:
    """Morris indices: elementary effects for screening with few runs.

    ``mean_absolute`` and ``mean`` of the change of a response over the range of a parameter, and
    its ``deviation``, which is large for nonlinear effects and interactions. Requires
    ``trajectories·(k + 1)`` designs.
    Source: M. D. Morris (1991), Technometrics 33; F. Campolongo et al. (2007), by SALib.

    Parameters
    ----------
    run : function that runs the designs
    ranges : parameter → lower and upper bound
    trajectories : number of trajectories, each with one step along every parameter
    levels : of the grid, an even number
    rng : seed

    Raises
    ------
    AnalysisError
        A design fails; the effects need all designs.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> model = da.Structure("sum")
    >>> a, b = model.parameter("a", 1.0), model.parameter("b", 1.0)
    >>> end = model.node("end", 0)
    >>> part = model.add(structures.GroundSpring("spring", end, stiffness_x=1.0))
    >>> built, response = model.build(), da.final("3*a + b")
    >>> def run(design):
    ...     return da.sweep(built, design, analysis=da.Statics(), responses=response)
    >>> effects = da.morris_indices(run, {"a": (0, 1), "b": (0, 1)}, trajectories=2, rng=1)
    >>> effects["mean"].values.round(6).ravel()
    array([3., 1.])
    """
    optional_package("SALib", "a sensitivity index")
    from SALib.analyze import morris as analysis
    from SALib.sample import morris as sampling

    problem = _problem(ranges)
    values = sampling.sample(problem, trajectories, num_levels=levels, seed=rng)

    def indices(response: np.ndarray) -> Mapping[str, np.ndarray]:
        result = analysis.analyze(problem, values, response, num_levels=levels, seed=rng)
        names = {"mean": "mu", "mean_absolute": "mu_star", "deviation": "sigma"}
        return {name: np.asarray(result[key]) for name, key in names.items()}

    return _index_dataset(run, ranges, values, indices)


def _problem(ranges: Ranges) -> dict[str, Any]:
    for name, (lower, upper) in ranges.items():
        if not lower < upper:
            raise AnalysisError(f"{name}: a range is (lower, upper), got ({lower}, {upper})")
    bounds = [[float(lower), float(upper)] for lower, upper in ranges.values()]
    return {"num_vars": len(ranges), "names": list(ranges), "bounds": bounds}


def _require_all(study: SweepResult) -> SweepResult:
    if study.failures:
        number, reason = next(iter(study.failures.items()))
        raise AnalysisError(
            f"{len(study.failures)} of {len(study.design)} designs fail, but the indices need "
            f"all designs; narrow the ranges (design {number}: {reason})"
        )
    return study


def _index_dataset(
    run: Run,
    ranges: Ranges,
    values: np.ndarray,
    indices: Callable[[np.ndarray], Mapping[str, np.ndarray]],
) -> xr.Dataset:
    """Indices of every response, response × parameter."""
    import xarray as xr

    study = _require_all(run(DesignTable(tuple(ranges), values)))
    rows = [indices(study.column(name)) for name in study.responses]
    coords = {"response": list(study.responses), "parameter": list(ranges)}
    dims = ("response", "parameter")
    return xr.Dataset(
        {key: (dims, np.array([row[key] for row in rows])) for key in rows[0]}, coords
    )
