"""From what shall be done to the linkages that do it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from dalembert.analysis.progress import Reported, progress_reporter
from dalembert.design.synthesis.four_bar import FourBar
from dalembert.design.synthesis.linkage import Linkage
from dalembert.design.synthesis.problem import Polish
from dalembert.design.synthesis.starts import starts_of
from dalembert.design.synthesis.synthesis import Solution, Synthesis
from dalembert.design.synthesis.target import Target
from dalembert.errors import AnalysisError
from dalembert.interrupts import interruptible, searching
from dalembert.options import random_generator
from dalembert.text.spelling import spelled
from dalembert.text.wording import unknown

CANDIDATES = 6
"""Starts of open paths that are compared, for each that is polished."""


@spelled
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
) -> Synthesis:
    """Linkages for a path, a motion or a function: least squares from many starts.

    Starts come from an atlas of curves where there are points, else at random; they are polished
    with exact derivatives by IPOPT. Every solution is checked by solving its loop anew. Ctrl-C ends
    it with the solutions found until then.

    Parameters
    ----------
    target : ``Target.path``, ``Target.motion`` or ``Target.function``
    linkage : ``FourBar`` or ``SliderCrank``
    bounds : dimension → (lower, upper) in the unit of the target
    crank_turns : the crank turns all the way (Grashof), so that branch and circuit stay
    transmission : least transmission angle [rad], over the turn or, without, at the entries
    order : free timing passes the entries in their order
    starts : how many linkages are polished
    progress : True for a bar, or a function of the fraction done
    rng : seed of the starts

    Raises
    ------
    AnalysisError
        Bounds of no dimension, or no start leads to a linkage within the limits.

    Examples
    --------
    >>> import dalembert as da
    >>> points = [(20, 20 + 5 * k) for k in range(5)]  # straight up
    >>> found = da.synthesize(da.Target.path(points), starts=4)
    >>> found.best.error < 1e-8, found.best.linkage.crank_turns
    (True, True)
    """
    if not isinstance(target, Target):
        raise AnalysisError(f"give a target such as da.Target.path(points); got {target!r:.60}")
    if not isinstance(linkage, type):
        raise AnalysisError(
            "synthesize knows FourBar and SliderCrank; for a model of your own take "
            "da.synthesize_mechanism(target, model, point=...)"
        )
    size, at = _frame(target)
    scaled = _scaled(target, size, at)
    ends = _bounds(linkage, target, bounds, size, at)
    polish = Polish(linkage, scaled, ends, crank_turns, transmission, order)
    generator = random_generator(rng)
    many = CANDIDATES * starts if _is_open_path(target) else starts
    chosen = starts_of(linkage, scaled, ends, crank_turns, many, generator)
    found: list[Solution] = []
    free = target.crank_angles is None and target.outputs is None
    done = 0
    with progress_reporter(progress, f"{linkage.__name__}s") as report:
        try:
            with searching():
                chosen = polish.selected(chosen, starts)
                for start in chosen:
                    made = polish(start)
                    if made is not None:
                        bar = made[0].scaled(size, at)
                        _keep(found, _solution(target, bar, made[1], crank_turns), free)
                    done += 1
                    report(done / len(chosen))
        except KeyboardInterrupt:
            if not found:
                raise
    if not found:
        raise AnalysisError(
            f"none of {len(chosen)} starts leads to a {linkage.__name__} within the limits; "
            "give more starts, wider bounds, a smaller transmission angle, or crank_turns=False"
        )
    found.sort(key=lambda solution: solution.error)
    return Synthesis(target, found, done, interrupted=done < len(chosen))


def _is_open_path(target: Target) -> bool:
    """Whether entries have neither timing nor angles, so that starts tell little of their ends."""
    free = target.crank_angles is None and target.coupler_angles is None
    return free and target.points is not None and not target.closed


def _frame(target: Target) -> tuple[float, complex]:
    """Size and middle of the target, in which the problem is near one."""
    if target.points is not None:
        z = target.complex_points
        size = float(np.sqrt(np.mean(abs(z - z.mean()) ** 2))) * 2
        if size == 0:
            raise AnalysisError("all points of the target are one; give points apart")
        return size, complex(z.mean())
    return 1.0, 0j


def _scaled(target: Target, size: float, at: complex) -> Target:
    if target.points is None:
        return target
    return replace(target, points=(target.points - [at.real, at.imag]) / size)


def _bounds(
    kind: type[Linkage],
    target: Target,
    given: Mapping[str, tuple[float, float]] | None,
    size: float,
    at: complex,
) -> dict[str, tuple[float, float]]:
    """In the frame of the target; what a function does not depend on is held."""
    usual = dict.fromkeys(kind.names(), (-20.0, 20.0))
    usual |= dict.fromkeys(kind.lengths, (0.02, 20.0))
    usual["angle"] = (-4 * np.pi, 4 * np.pi)
    if target.points is None:
        held = {"x": 0.0, "y": 0.0, "u": 0.0, "v": 0.0, "angle": 0.0}
        held |= {"ground": 1.0} if "ground" in kind.lengths else {}
        usual |= {name: (value, value) for name, value in held.items()}
    moved = {"x": at.real, "y": at.imag}
    for name, (lower, upper) in (given or {}).items():
        if name not in usual:
            raise AnalysisError(unknown("dimension", name, list(usual)))
        if not lower <= upper:
            raise AnalysisError(f"bounds of {name}: {lower} is above {upper}")
        by = 1.0 if name == "angle" else size
        shift = moved.get(name, 0.0)
        usual[name] = ((lower - shift) / by, (upper - shift) / by)
    return usual


def _solution(
    target: Target, linkage: Linkage, theta: np.ndarray, crank_turns: bool
) -> Solution | None:
    """The errors of a linkage, its loop solved anew; None where it does not do what it claims."""
    phi, output = linkage.loop(linkage.numbers, linkage.branch, theta)
    if not np.all(np.isfinite(phi)) or (crank_turns and not linkage.crank_turns):
        return None
    error, distances = 0.0, np.zeros(len(target))
    if target.points is not None:
        distances = np.linalg.norm(linkage.path(theta) - target.points, axis=1)
        error += float(distances @ distances)
    if target.coupler_angles is not None:
        off = _from_mean(phi - target.coupler_angles, True)
        error += float(off @ off)
    if target.outputs is not None:
        off = _from_mean(output - target.outputs, linkage.output_is_angle)
        distances = abs(off)
        error += float(off @ off)
    return Solution(linkage, theta, error, distances)


def _from_mean(values: np.ndarray, angles: bool) -> np.ndarray:
    values = np.unwrap(values) if angles else values
    return values - values.mean()


def _keep(found: list[Solution], made: Solution | None, free: bool) -> None:
    """Take a solution unless the same linkage is there already."""
    if made is None:
        return
    for k, other in enumerate(found):
        if _same(made, other, free):
            found[k] = min(made, other, key=lambda solution: solution.error)
            return
    found.append(made)


def _same(one: Solution, other: Solution, free: bool) -> bool:
    """Whether the joints are at the same places at the first entry, whatever the angles count.

    Where crank angles are free, crank and follower may have changed their names.
    """
    a, b = (s.linkage.joints(float(s.crank_angles[0])) for s in (one, other))
    near = 1e-4 * np.ptp(np.abs(a - a[0])) + 1e-9
    if np.all(abs(a - b) < near):
        return True
    swaps = free and isinstance(one.linkage, FourBar)
    return bool(swaps and np.all(abs(a - b[[2, 3, 0, 1, 4]]) < near))
