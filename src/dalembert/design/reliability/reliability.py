"""Reliability analysis: probability that random parameters violate a limit state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from dalembert.analysis.progress import Reported, progress_reporter
from dalembert.design.methods.search_options import check_starts, check_stop
from dalembert.design.reliability.design_points import design_points
from dalembert.design.reliability.distribution import Distribution
from dalembert.design.reliability.first_order import DesignPoint, Search
from dalembert.design.reliability.limit_state import LimitState, limit_states
from dalembert.design.reliability.nataf import Correlation, Nataf
from dalembert.design.reliability.reliability_result import SAMPLINGS, ReliabilityResult
from dalembert.design.reliability.second_order import second_order
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.interrupts import interruptible, searching
from dalembert.options import RandomSource, is_whole, random_generator
from dalembert.results.analysis import Analysis
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import check_arguments
from dalembert.text.wording import unknown

SYSTEMS = ("series", "parallel")
FORMULA_STARTS, MODEL_STARTS = 10, 3
"""Default numbers of searches for each limit state."""
MAX_CURVATURE_EFFECT = 0.2
"""Threshold for a warning: relative difference of first- and second-order probabilities."""
LAYER_DEPTHS = (0.03, 0.1, 0.3, 1.0, 1.6)
"""Distances behind a design point at which the limit state is checked, as fractions of the depth
``1/max(β, 1)`` that contains most of the probability."""


@check_arguments
@interruptible
def reliability(
    model: ParametricModel | None,
    limit_state: LimitState | Sequence[LimitState],
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
    rng: RandomSource = 0,
    progress: Reported = False,
) -> ReliabilityResult:
    """Probability of failure by the first-order method; further methods are in the result.

    Ctrl-C returns the design points computed so far.

    Parameters
    ----------
    model : Model or StructuralModel; None if limit states are formulas of random parameters
    limit_state : a response, safe above zero; a ``Limit``, safe inside; a formula; or a list
    random : name of a parameter → distribution
    analysis : computes the responses
    correlation : pair of names → linear correlation, or the full matrix
    system : ``"series"``, failure of any limit state; ``"parallel"``, failure of all
    method : ``"sqp"``, ``"improved-hlrf"`` or ``"hlrf"``
    starts : number of searches for each limit state, for multiple design points; by default 10 for
        formulas and 3 for models
    tolerance : of residual and distance of the design point
    samples : number of samples of an additional estimate, ``result.sampled``; none by default
    sampling : ``"importance-sampling"``, ``"monte-carlo"``, ``"subset-simulation"`` or
        ``"openturns-subset"``
    rng : seed or generator of the starts, and of the samples
    progress : True for a bar, or a function of the fraction done
    max_iterations : upper limit of iterations of the search for a design point

    Raises
    ------
    ModelError
        A parameter is unknown, or the correlations are inconsistent.
    AnalysisError
        A limit state cannot be evaluated at the median, or is constant.

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
    >>> result = da.reliability(rod.build(), strong, random, analysis=da.Statics())
    >>> result.success, round(result.beta, 3)  # ln(σ A/F) is normal: closed form
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
    result = ReliabilityResult([], system, searches, nataf)
    with progress_reporter(progress, "reliability") as report:
        try:
            with searching():
                for k, search in enumerate(searches):
                    outcome = design_points(search, check_starts(starts), generator)
                    result.points += outcome.points
                    result.warnings += [outcome.warning] if outcome.warning else []
                    report((k + 1) / (len(searches) + bool(samples)))
                result.warnings += curvature_warnings(result)
                result.warnings += layer_warnings(result)
                if samples:
                    result.sampled = result.sample(sampling, samples, generator)
        except KeyboardInterrupt:
            if not result.points:
                raise
            result.interrupted = True
    return result


def _is_significant(result: ReliabilityResult, point: DesignPoint) -> bool:
    """Whether the probability of a point is a significant part of the total."""
    fraction = point.probability / max(result.probability, 1e-300)
    return result.system != "series" or fraction >= MAX_CURVATURE_EFFECT / 2


def curvature_warnings(result: ReliabilityResult) -> list[str]:
    """Warnings for points with different first- and second-order probabilities."""
    warnings = []
    for point in result.points:
        if point.curvatures is None or not _is_significant(result, point):
            continue
        plane, second = point.probability, second_order(result.searches[point.row], point)
        breitung, tvedt = second.breitung, second.tvedt
        if all(abs(p - plane) <= MAX_CURVATURE_EFFECT * max(p, plane) for p in (breitung, tvedt)):
            continue
        comparison = (
            "the surface curves around the median there, so that there is no second-order estimate"
            if not (breitung <= 1 and 0 <= tvedt <= 1)
            else f"to second order {breitung:.3g} (Breitung) or {tvedt:.3g} (Tvedt)"
        )
        warnings.append(
            f"{point.limit}: the surface is curved at β = {point.beta:.4g}: the probability is "
            f"{plane:.3g} to first order, {comparison}; compare importance_sampling"
        )
    return list(dict.fromkeys(warnings))


def layer_warnings(result: ReliabilityResult) -> list[str]:
    """Warnings for points with a thin failure region behind the limit state."""
    from scipy.special import ndtr

    warnings = []
    for point in result.points:
        if not (point.converged and point.beta > 0 and _is_significant(result, point)):
            continue
        search, depth = result.searches[point.row], 1 / max(point.beta, 1.0)
        behind = [point.beta + share * depth for share in LAYER_DEPTHS]
        values = [search.value(beta * point.alpha) for beta in behind]
        end = next((b for b, g in zip(behind, values, strict=True) if g > 0), None)
        if end is not None:
            layer = float(ndtr(-point.beta) - ndtr(-end))
            warnings.append(
                f"{point.limit}: is safe again at β = {end:.4g} behind the design point at β = "
                f"{point.beta:.4g}: first order is {point.probability:.3g}, that layer at most "
                f"{layer:.3g}; compare importance_sampling"
            )
    return list(dict.fromkeys(warnings))
