"""Parameter identification from measured time series, ``min Σ ρ(r²)``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from dalembert.design.identification.experiment import Experiment, Measures, observe
from dalembert.design.identification.identification_result import IdentificationResult
from dalembert.design.identification.information import Information, inflation
from dalembert.design.identification.least_squares import Fit, LeastSquaresSolver
from dalembert.design.identification.misfit import Delays, Misfit, Unknowns, make_unknowns
from dalembert.design.methods.search_options import additional_starts
from dalembert.errors import AnalysisError
from dalembert.interrupts import defer_ctrl_c, interruptible
from dalembert.results.analysis import Analysis
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import check_arguments


@check_arguments
@interruptible
def identify(
    model: ParametricModel,
    data: Any,
    measures: Measures = None,
    vary: Sequence[str] = (),
    *,
    analysis: Analysis | None = None,
    time: str | None = None,
    noise: Mapping[str, float | str] | None = None,
    delays: Delays | None = None,
    loss: str = "linear",
    start: Mapping[str, float] | None = None,
    starts: int = 1,
    rng: int = 0,
    max_iterations: int = 100,
    tolerance: float = 1e-10,
    progress: bool | Callable[[int, float], None] = False,
) -> IdentificationResult:
    """Identify parameters of a model from measured time series.

    Least squares of the residuals over their noise, by SciPy's trust-region method with exact
    gradients of every sample. Missing samples (NaN) are ignored. Ctrl-C ends it with the best
    unknowns so far.

    Parameters
    ----------
    model : Model or StructuralModel
    data : DataFrame, mapping of columns, path of a .csv or .parquet file, an ``Experiment``, or a
        list of these
    measures : column → measure or formula; or columns with the names of measures; by default all
        columns except the time
    vary : names of the unknown parameters, within their bounds
    analysis : of the runs; by default dynamics from 0 to the last time
    time : name of the time column; by default ``time`` or ``t``
    noise : column → standard deviation, or the column that holds it; estimated by default
    delays : column → bounds of an unknown delay of its signal [s]
    loss : ``"linear"``, or robust ``"soft_l1"``, ``"huber"``, ``"cauchy"``, ``"arctan"``
    start : initial values; default nominal
    starts : number of searches for misfits with several minima, the first from ``start``, others
        from values between the bounds; the best is returned, ``minima`` lists all
    rng : seed of the starts
    progress : True to print each iteration, or a function of its number and cost
    max_iterations, tolerance : stopping criteria

    Raises
    ------
    AnalysisError
        Invalid data, or a run fails at the start.

    Examples
    --------
    >>> import numpy as np
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("rolling")
    >>> drag = system.parameter("drag", 0.1, "N s/m", bounds=(0, 10))
    >>> cart = system.add(planar.Particle("cart", mass=2.0, velocity=(3.0, 0)))
    >>> resistance = system.add(planar.Force("wind", cart.center, (-drag * cart.vx, 0)))
    >>> t = np.linspace(0, 2, 21)
    >>> data = {"time": t, "speed": 3 * np.exp(-0.4 * t)}  # synthetic measurement
    >>> result = da.identify(system.build(), data, {"speed": "cart.vx"}, ["drag"])
    >>> result.success, round(result.x["drag"], 6)  # c = 0.4 m
    (True, 0.8)
    """
    misfit = make_misfit(model, data, measures, vary, analysis, time, noise, delays, start)
    solver = LeastSquaresSolver(misfit, loss, tolerance, max_iterations, progress=progress)
    unknowns = misfit.unknowns
    first = unknowns.start
    check_start(misfit, first)
    bounds = unknowns.lower, unknowns.upper
    further_starts = additional_starts(starts, unknowns.labels, *bounds, rng)
    minima = solver.minima([first, *further_starts]) if further_starts else []
    fit, noise_levels, estimated = solver.fit_with_noise(minima[0][1] if minima else first)
    defer_ctrl_c()
    result = _make_identification(misfit, solver, fit, noise_levels, estimated)
    for cost, x in minima:
        result.minima.append((cost, dict(zip(unknowns.labels, map(float, x), strict=True))))
    return result


def make_misfit(
    model: ParametricModel,
    data: Any,
    measures: Measures,
    vary: Sequence[str],
    analysis: Analysis | None = None,
    time: str | None = None,
    noise: Mapping[str, float | str] | None = None,
    delays: Delays | None = None,
    start: Mapping[str, float] | None = None,
    regularised: bool = False,
) -> Misfit:
    """Misfit of a model to data; regularised problems may have fewer samples than unknowns.

    Raises
    ------
    AnalysisError
        Invalid data, or fewer samples than unknowns without regularisation.
    """
    tables = list(data) if isinstance(data, (list, tuple)) else [data]
    if not tables:
        raise AnalysisError("there is no data; give a table or an Experiment")
    experiments = [
        table if isinstance(table, Experiment) else Experiment(data=table) for table in tables
    ]
    varied = [vary] if isinstance(vary, str) else list(vary)
    deviations = dict(noise or {})
    observations = [
        observe(model, experiment, k, measures, time, deviations, analysis)
        for k, experiment in enumerate(experiments, start=1)
    ]
    names = [o.name for o in observations]
    repeated = next((n for n in names if names.count(n) > 1), None)
    if repeated:
        raise AnalysisError(f"two experiments are called {repeated!r}; name them")
    for column in deviations:
        if not any(column in o.columns for o in observations):
            raise AnalysisError(f"noise: the data has no column {column!r} in use")
    unknowns = make_unknowns(model, observations, varied, start or {}, delays or {})
    misfit = Misfit(model, observations, unknowns)
    if misfit.size < len(unknowns.labels) and not regularised:
        raise AnalysisError(
            f"{misfit.size} sample(s) for {len(unknowns.labels)} unknowns "
            f"({', '.join(unknowns.labels)}); measure more, or vary less"
        )
    return misfit


def check_start(misfit: Misfit, x: np.ndarray) -> None:
    """Check that runs succeed at the start and measures are finite at the times of the data.

    Raises
    ------
    AnalysisError
        A run fails or a measure is not finite.
    """
    try:
        predicted = misfit.predicted(x)
    except AnalysisError as error:
        raise AnalysisError(f"the run fails at the start: {error}") from None
    for observation, values, used in zip(misfit.observations, predicted, misfit.used, strict=True):
        if not np.all(np.isfinite(values[used])):
            raise AnalysisError(f"{observation.name}: a measure is not finite at the start")


def _make_identification(
    misfit: Misfit, solver: LeastSquaresSolver, fit: Fit, noise: dict[str, float], estimated: bool
) -> IdentificationResult:
    unknowns, x = misfit.unknowns, fit.x
    jacobian = misfit.jacobian(x)
    factor = 1.0
    if estimated or solver.loss != "linear":
        factor = inflation(misfit.residual(x), solver.loss, x.size)
    motions = misfit.motions(x)
    assert motions is not None
    return IdentificationResult(
        x=dict(zip(unknowns.labels, map(float, x), strict=True)),
        success=fit.success,
        message=fit.message,
        cost=fit.cost,
        noise=noise,
        noise_specified=not estimated,
        factor=factor,
        information=Information(unknowns.labels, jacobian, unknowns.sizes(x)),
        motions=motions,
        predicted=misfit.predicted(x),
        misfit=misfit,
        at_bounds=at_bounds(unknowns, x),
        runs=misfit.runs,
        failed_runs=len(misfit.failures),
        interrupted=solver.interrupted,
    )


def at_bounds(unknowns: Unknowns, x: np.ndarray) -> list[str]:
    """Unknowns at one of their bounds."""
    near = 1e-6 * unknowns.sizes(x)
    is_at_bound = (x - unknowns.lower <= near) | (unknowns.upper - x <= near)
    return [n for n, flag in zip(unknowns.labels, is_at_bound, strict=True) if flag]
