"""Reliability: how probable it is that random parameters break a limit state."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dalembert.analysis.progress import Reported, progress_reporter
from dalembert.design.methods.search_options import check_starts, check_stop
from dalembert.design.reliability.design_points import design_points
from dalembert.design.reliability.distribution import Distribution
from dalembert.design.reliability.first_order import Search
from dalembert.design.reliability.limit_state import limit_states
from dalembert.design.reliability.nataf import Correlation, Nataf
from dalembert.design.reliability.reliable import SAMPLINGS, Reliability
from dalembert.design.reliability.validity import curvature_warnings, layer_warnings
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.interrupts import interruptible, searching
from dalembert.options import is_whole, random_generator
from dalembert.results.result import Analysis
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.spelling import spelled
from dalembert.text.wording import unknown

SYSTEMS = ("series", "parallel")
FORMULA_STARTS, MODEL_STARTS = 10, 3


@spelled
@interruptible
def reliability(
    model: ParametricModel | None,
    limit_state: Any,
    random: Mapping[str, Distribution],
    *,
    analysis: Analysis | None = None,
    correlation: Correlation = None,
    system: str = "series",
    method: str = "sqp",
    starts: int | None = None,
    tolerance: float = 1e-8,
    max_iterations: int = 100,
    samples: int = 0,
    sampling: str = "importance-sampling",
    rng: Any = 0,
    progress: Reported = False,
) -> Reliability:
    """Probability of failure by the first-order method, and what else the result can compute.

    Ctrl-C ends it with the design points found until then.

    Parameters
    ----------
    model : Model or StructuralModel; None where the limit states are formulas of what is random
    limit_state : a response, safe above zero; a ``Limit``, safe inside; a formula; or a list
    random : name of a parameter → distribution
    analysis : how the responses are computed
    correlation : pair of names → linear correlation, or the whole matrix
    system : ``"series"``, one limit that breaks is failure; ``"parallel"``, all must break
    method : ``"sqp"``, ``"improved-hlrf"`` or ``"hlrf"``
    starts : searches for each limit state, to find further design points; by default 10 of formulas
        and 3 of models
    tolerance : on residual and distance of the design point
    samples : of an estimate beside, ``result.sampled``; none by default
    sampling : ``"importance-sampling"``, ``"monte-carlo"``, ``"subset-simulation"`` or
        ``"openturns-subset"``
    rng : seed or generator of the starts, and of the samples
    progress : True for a bar, or a function of the fraction done
    max_iterations : of the search for a design point

    Raises
    ------
    ModelError
        Unknown parameters, or correlations that cannot be.
    AnalysisError
        A limit state that cannot be evaluated at the median, or does not change.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> rod = da.Structure("rod")
    >>> load, area = rod.parameter("load", 1e5, "N"), rod.parameter("area", 1e-3, "m^2")
    >>> top, end = rod.node("top", 0), rod.node("end", 2)
    >>> part = rod.add(structures.Truss("rod", top, end, area=area, modulus=2e11))
    >>> rod.support(top)
    >>> rod.load(end, fx=load)
    >>> strong = da.Limit(da.final("rod.stress"), upper=2e8)
    >>> random = {"load": da.Lognormal(1e5, 1e4), "area": da.Lognormal(1e-3, 5e-5)}
    >>> found = da.reliability(rod.build(), strong, random, analysis=da.Statics())
    >>> found.success, round(found.beta, 3)  # ln(σ A/F) is normal: a closed form
    (True, 6.246)
    """
    if system not in SYSTEMS:
        raise UnsupportedError(f"unknown system {system!r}; known: {', '.join(SYSTEMS)}")
    if sampling not in SAMPLINGS:
        raise UnsupportedError(unknown("sampling", sampling, SAMPLINGS))
    if not random:
        raise AnalysisError("nothing is random; give random={'name': da.Normal(mean, std)}")
    for name, distribution in random.items():
        if not isinstance(distribution, Distribution):
            raise AnalysisError(
                f"random[{name!r}] is {distribution!r}; give a distribution as da.Normal(mean, std)"
            )
        if model is not None and name in model.parameters:
            distribution.check_units(model.parameters[name].unit, name)
    nataf = Nataf(dict(random), correlation)
    limits = limit_states(model, limit_state, list(random), analysis)
    generator = random_generator(rng)
    if starts is None:
        starts = FORMULA_STARTS if model is None else MODEL_STARTS
    check_stop(max_iterations, tolerance)
    if not is_whole(samples) or samples < 0:
        raise AnalysisError(f"samples = {samples!r:.60}: give a whole number of 0 or more")
    searches = [
        Search(limits, nataf, row, method, tolerance, max_iterations)
        for row in range(len(limits.labels))
    ]
    found = Reliability([], system, searches, nataf)
    with progress_reporter(progress, "reliability") as report:
        try:
            with searching():
                for k, search in enumerate(searches):
                    searched = design_points(search, check_starts(starts), generator)
                    found.points += searched.points
                    found.warnings += [searched.warning] if searched.warning else []
                    report((k + 1) / (len(searches) + bool(samples)))
                found.warnings += curvature_warnings(found)
                found.warnings += layer_warnings(found)
                if samples:
                    found.sampled = found.sample(sampling, samples, generator)
        except KeyboardInterrupt:
            if not found.points:
                raise
            found.interrupted = True
    return found
