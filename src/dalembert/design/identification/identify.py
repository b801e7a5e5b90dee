"""Identification: parameters that explain measurements, ``min Σ ρ(r²)``, and how sure they are."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from dalembert.design.identification.experiment import Experiment, Measures, observe
from dalembert.design.identification.identified import Identification
from dalembert.design.identification.information import Information, inflation
from dalembert.design.identification.least_squares import Fit, LeastSquares
from dalembert.design.identification.misfit import Misfit
from dalembert.design.identification.unknowns import Delays, Unknowns, unknowns_of
from dalembert.design.methods.spread import check_starts, refuse_infinite_bounds, sobol_designs
from dalembert.errors import AnalysisError
from dalembert.interrupts import defer_ctrl_c, interruptible
from dalembert.results.result import Analysis
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.spelling import spelled


@spelled
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
) -> Identification:
    """Parameters with which a model explains measured time series.

    Least squares of the residuals over their noise, by SciPy's trust region with exact gradients of
    every sample. Missing samples (NaN) are left out. Ctrl-C ends it with the best unknowns so far.

    Parameters
    ----------
    model : Model or StructuralModel
    data : DataFrame, mapping of columns, path of a .csv or .parquet file, an ``Experiment``, or a
        list of these
    measures : column → measure or formula; or columns that are named as measures are; by default
        all columns beside the time
    vary : names of the unknown parameters; their bounds are kept
    analysis : how the runs are made; by default dynamics from 0 to the last time
    time : column of the times; by default ``time`` or ``t``
    noise : column → standard deviation, or the column that holds it; estimated where not given
    delays : column → bounds of an unknown time by which it lags behind [s]
    loss : ``"linear"``, or against outliers ``"soft_l1"``, ``"huber"``, ``"cauchy"``, ``"arctan"``
    start : initial values; default the nominal ones
    starts : searches, the first from ``start`` and others from values between the bounds, where
        residuals may have several valleys; the best counts and ``minima`` tells each that was found
    rng : seed of the starts
    progress : True prints each iteration, or a function of its number and cost
    max_iterations, tolerance : at which the search ends

    Raises
    ------
    AnalysisError
        Data that cannot be used, or a run that fails at the start.

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
    >>> data = {"time": t, "speed": 3 * np.exp(-0.4 * t)}  # as if measured
    >>> found = da.identify(system.build(), data, {"speed": "cart.vx"}, ["drag"])
    >>> found.success, round(found.x["drag"], 6)  # c = 0.4 m
    (True, 0.8)
    """
    misfit = prepared(model, data, measures, vary, analysis, time, noise, delays, start)
    solver = LeastSquares(misfit, loss, tolerance, max_iterations, progress=progress)
    first = misfit.unknowns.start
    refuse_bad_start(misfit, first)
    begins = other_starts(misfit.unknowns, starts, rng)
    minima = solver.minima([first, *begins]) if begins else []
    fit, levels, estimated = solver.with_noise(minima[0][1] if minima else first)
    defer_ctrl_c()
    found = _identified(misfit, solver, fit, levels, estimated)
    labels = misfit.unknowns.labels
    for cost, x in minima:
        found.minima.append((cost, dict(zip(labels, map(float, x), strict=True))))
    return found


def other_starts(unknowns: Unknowns, starts: int, rng: int) -> list[np.ndarray]:
    """Values of the unknowns between their bounds, beside the first start.

    Raises
    ------
    AnalysisError
        An unknown without two finite bounds, or starts that are no number.
    """
    if check_starts(starts) == 1:
        return []
    refuse_infinite_bounds("starts", unknowns.labels, unknowns.lower, unknowns.upper)
    return list(sobol_designs(starts - 1, unknowns.lower, unknowns.upper, rng))


def prepared(
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
    """The misfit of a model to data; with a regularisation there may be few of them.

    Raises
    ------
    AnalysisError
        Data that cannot be used, or fewer samples than unknowns.
    """
    given = list(data) if isinstance(data, (list, tuple)) else [data]
    if not given:
        raise AnalysisError("there is no data; give a table or an Experiment")
    experiments = [d if isinstance(d, Experiment) else Experiment(data=d) for d in given]
    listed = [vary] if isinstance(vary, str) else list(vary)
    deviations = dict(noise or {})
    observations = [
        observe(model, e, k, measures, time, deviations, analysis)
        for k, e in enumerate(experiments, start=1)
    ]
    names = [o.name for o in observations]
    twice = next((n for n in names if names.count(n) > 1), None)
    if twice:
        raise AnalysisError(f"two experiments are called {twice!r}; name them")
    for column in deviations:
        if not any(column in o.columns for o in observations):
            raise AnalysisError(f"noise: the data has no column {column!r} that is used")
    unknowns = unknowns_of(model, observations, listed, start or {}, delays or {})
    misfit = Misfit(model, observations, unknowns)
    if misfit.size < len(unknowns.labels) and not regularised:
        raise AnalysisError(
            f"{misfit.size} sample(s) for {len(unknowns.labels)} unknowns "
            f"({', '.join(unknowns.labels)}); measure more, or vary less"
        )
    return misfit


def refuse_bad_start(misfit: Misfit, x: np.ndarray) -> None:
    """The runs go through at the start, and are measurable at the times of the data.

    Raises
    ------
    AnalysisError
        With the reason.
    """
    try:
        found = misfit.predicted(x)
    except AnalysisError as error:
        raise AnalysisError(f"the model cannot be run at the start: {error}") from None
    for o, values, used in zip(misfit.observations, found, misfit.used, strict=True):
        if not np.all(np.isfinite(values[used])):
            raise AnalysisError(f"{o.name}: a measure is not finite at the start")


def _identified(
    misfit: Misfit, solver: LeastSquares, fit: Fit, noise: dict[str, float], estimated: bool
) -> Identification:
    unknowns, x = misfit.unknowns, fit.x
    jacobian = misfit.jacobian(x)
    factor = 1.0
    if estimated or solver.loss != "linear":
        factor = inflation(misfit.residual(x), solver.loss, x.size)
    motions = misfit.motions(x)
    assert motions is not None
    return Identification(
        x=dict(zip(unknowns.labels, map(float, x), strict=True)),
        success=fit.success,
        message=fit.message,
        cost=fit.cost,
        noise=noise,
        noise_given=not estimated,
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
    """Unknowns that are at one of their bounds."""
    near = 1e-6 * unknowns.sizes(x)
    ended = (x - unknowns.lower <= near) | (unknowns.upper - x <= near)
    return [n for n, at in zip(unknowns.labels, ended, strict=True) if at]
