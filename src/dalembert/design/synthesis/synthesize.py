"""Dimensional synthesis of single-loop linkages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from dalembert.analysis.progress import Reported, part_of, progress_reporter
from dalembert.design.synthesis.atlas import Start
from dalembert.design.synthesis.four_bar import FourBar
from dalembert.design.synthesis.linkage import Linkage
from dalembert.design.synthesis.linkage_fit import LinkageFit
from dalembert.design.synthesis.starts import check_starts, no_convergence, starts_of
from dalembert.design.synthesis.synthesis_result import Solution, SynthesisResult
from dalembert.design.synthesis.target import Target
from dalembert.errors import AnalysisError
from dalembert.interrupts import interruptible, searching
from dalembert.options import random_generator
from dalembert.text.arguments import check_arguments
from dalembert.text.wording import unknown

CANDIDATES = 6
"""Number of compared starts per optimised start, for open paths."""
ATLAS_WORK = 1500
"""Work of the search in the atlas, relative to the optimisation of one start."""


@check_arguments
@interruptible
def synthesize(
    target: Target,
    linkage: type[Linkage] = FourBar,
    *,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    crank_turns: bool = True,
    transmission: float = 0.0,
    order: bool = True,
    starts: int = 24,
    rng: int | None = 0,
    progress: Reported = False,
) -> SynthesisResult:
    """Linkages for a path, a motion or a function: least squares from many starts.

    Starts for points are taken from an atlas of coupler curves, or are random; they are optimised
    by Ipopt with exact derivatives. Every solution is verified by solving its loop. Ctrl-C returns
    the solutions computed so far.

    Parameters
    ----------
    target : ``Target.path``, ``Target.motion`` or ``Target.function``
    linkage : ``FourBar`` or ``SliderCrank``
    bounds : dimension → (lower, upper) in the unit of the target
    crank_turns : the crank rotates fully (Grashof), so that branch and circuit do not change
    transmission : minimum transmission angle [rad], over a revolution, or at the entries without
        ``crank_turns``
    order : for free timing, the entries are passed in their order
    starts : number of optimised starts
    progress : True for a bar, or a function of the fraction done
    rng : seed of the starts

    Raises
    ------
    AnalysisError
        A bound is not that of a dimension, or no start converges to a linkage within the limits.

    Examples
    --------
    >>> import dalembert as da
    >>> points = [(20, 20 + 5 * k) for k in range(5)]  # straight up
    >>> result = da.synthesize(da.Target.path(points), starts=4)
    >>> result.best.error < 1e-8, result.best.linkage.crank_turns
    (True, True)
    """
    if not isinstance(target, Target):
        raise AnalysisError(f"give a target such as da.Target.path(points); got {target!r:.60}")
    if not isinstance(linkage, type):
        raise AnalysisError(
            "synthesize supports FourBar and SliderCrank; for another model use "
            "da.synthesize_mechanism(target, model, point=...)"
        )
    check_starts(starts)
    size, at = _frame(target)
    scaled = _scaled(target, size, at)
    ends = _bounds(linkage, target, bounds, size, at)
    fit = LinkageFit(linkage, scaled, ends, crank_turns, transmission, order)
    generator = random_generator(rng)
    count = CANDIDATES * starts if _is_open_path(target) else starts
    solutions: list[Solution] = []
    free = target.crank_angles is None and target.outputs is None
    done, compared, selected = 0, list[Start](), list[Start]()
    atlas = ATLAS_WORK if target.points is not None and free and not target.closed else 0
    work = np.cumsum([atlas, count if count > starts else 0, starts])
    begin, end = (float(part / work[2]) for part in work[:2])  # of the comparison of starts
    with progress_reporter(progress, f"{linkage.__name__}s") as report:
        try:
            with searching():
                searched = part_of(report, 0.0, begin)
                compared = starts_of(linkage, scaled, ends, crank_turns, count, generator, searched)
                selected = fit.select(compared, starts, part_of(report, begin, end))
                optimised = part_of(report, end, 1.0)
                for start in selected:
                    fitted = fit(start)
                    if fitted is not None:
                        bar = fitted[0].scaled(size, at)
                        _add_distinct(
                            solutions, _solution(target, bar, fitted[1], crank_turns), free
                        )
                    done += 1
                    optimised(done / len(selected))
        except KeyboardInterrupt:
            if not solutions:
                raise
    if not solutions:
        raise AnalysisError(
            f"{no_convergence(len(selected) or len(compared))} to a {linkage.__name__} within the "
            "limits; give more starts, wider bounds, a smaller transmission angle, or "
            "crank_turns=False"
        )
    solutions.sort(key=lambda solution: solution.error)
    return SynthesisResult(
        target, solutions, done, interrupted=done < len(selected), planned=len(selected)
    )


def _is_open_path(target: Target) -> bool:
    """Whether entries have neither timing nor angles; errors of starts are not indicative then."""
    free = target.crank_angles is None and target.coupler_angles is None
    return free and target.points is not None and not target.closed


def _frame(target: Target) -> tuple[float, complex]:
    """Size and centre of the target, for scaling."""
    if target.points is not None:
        z = target.complex_points
        size = float(np.sqrt(np.mean(abs(z - z.mean()) ** 2))) * 2
        if size == 0:
            raise AnalysisError("all points of the target are equal; give points apart")
        return size, complex(z.mean())
    return 1.0, 0j


def _scaled(target: Target, size: float, at: complex) -> Target:
    if target.points is None:
        return target
    return replace(target, points=(target.points - [at.real, at.imag]) / size)


def _bounds(
    kind: type[Linkage],
    target: Target,
    bounds: Mapping[str, tuple[float, float]] | None,
    size: float,
    at: complex,
) -> dict[str, tuple[float, float]]:
    """Bounds in the frame of the target; dimensions without influence on a function are fixed."""
    result = dict.fromkeys(kind.names(), (-20.0, 20.0))
    result |= dict.fromkeys(kind.lengths, (0.02, 20.0))
    result["angle"] = (-4 * np.pi, 4 * np.pi)
    if target.points is None:
        fixed = {"x": 0.0, "y": 0.0, "u": 0.0, "v": 0.0, "angle": 0.0}
        fixed |= {"ground": 1.0} if "ground" in kind.lengths else {}
        result |= {name: (value, value) for name, value in fixed.items()}
    shifts = {"x": at.real, "y": at.imag}
    for name, (lower, upper) in (bounds or {}).items():
        if name not in result:
            raise AnalysisError(unknown("dimension", name, list(result)))
        if not lower <= upper:
            raise AnalysisError(f"bounds of {name}: {lower} is above {upper}")
        scale = 1.0 if name == "angle" else size
        shift = shifts.get(name, 0.0)
        result[name] = ((lower - shift) / scale, (upper - shift) / scale)
    return result


def _solution(
    target: Target, linkage: Linkage, theta: np.ndarray, crank_turns: bool
) -> Solution | None:
    """The errors of a linkage from the solution of its loop; None if it is not valid."""
    phi, output = linkage.loop(linkage.numbers, linkage.branch, theta)
    if not np.all(np.isfinite(phi)) or (crank_turns and not linkage.crank_turns):
        return None
    error, distances = 0.0, np.zeros(len(target))
    if target.points is not None:
        distances = np.linalg.norm(linkage.path(theta) - target.points, axis=1)
        error += float(distances @ distances)
    if target.coupler_angles is not None:
        deviation = _from_mean(phi - target.coupler_angles, True)
        error += float(deviation @ deviation)
    if target.outputs is not None:
        deviation = _from_mean(output - target.outputs, linkage.output_is_angle)
        distances = abs(deviation)
        error += float(deviation @ deviation)
    return Solution(linkage, theta, error, distances)


def _from_mean(values: np.ndarray, angles: bool) -> np.ndarray:
    values = np.unwrap(values) if angles else values
    return values - values.mean()


def _add_distinct(solutions: list[Solution], new: Solution | None, free: bool) -> None:
    """Add a solution; of equal linkages, only the best one is stored."""
    if new is None:
        return
    for k, other in enumerate(solutions):
        if _same(new, other, free):
            solutions[k] = min(new, other, key=lambda solution: solution.error)
            return
    solutions.append(new)


def _same(solution: Solution, other: Solution, free: bool) -> bool:
    """Whether the joints have the same positions at the first entry, independent of the angles.

    If crank angles are free, crank and follower may be exchanged.
    """
    a, b = (s.linkage.joints(float(s.crank_angles[0])) for s in (solution, other))
    tolerance = 1e-4 * np.ptp(np.abs(a - a[0])) + 1e-9
    if np.all(abs(a - b) < tolerance):
        return True
    swaps = free and isinstance(solution.linkage, FourBar)
    return bool(swaps and np.all(abs(a - b[[2, 3, 0, 1, 4]]) < tolerance))
