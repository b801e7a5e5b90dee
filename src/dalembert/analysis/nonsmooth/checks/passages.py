"""Shapes that move through each other within a step of ``MoreauJean``.

The scheme evaluates gaps at the start of a step: one that closes in its second half remains closed,
and impacts change the motion of half a step. A body that moves farther than another one is thick is
then beyond it at the end, or is pushed out on its far side. Candidates are gaps whose linear parts
close in the step and whose normal points to the other side at its end; their shapes are followed
through it, where the distance of convex shapes has one minimum.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dalembert.analysis.nonsmooth.between_steps import between
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.model_gaps import APART
from dalembert.analysis.nonsmooth.starts.touching_shapes import bodies_of
from dalembert.analysis.nonsmooth.step_state import StepResult, StepStart
from dalembert.integrators.contact.contacts import Contacts

SAMPLES, ITERATIONS = 8, 24
"""Positions within a step at which shapes are compared at first, and of the search for the closest
one and for the ends of an overlap."""
MOST = 100
"""Upper limit of the passages that are searched for in a run."""
SHALLOW = 1e-5
"""Overlap of corners that graze each other, which is no passage, by the size of the bodies [-]."""
GOLDEN = (5**0.5 - 1) / 2
"""Ratio of the golden section [-]."""


@dataclass(frozen=True)
class Passage:
    """Two shapes that overlap within a step.

    Attributes
    ----------
    t : start of the step [s]
    names : element and bodies
    depth : largest overlap within the step [m]
    duration : of the overlap [s]
    """

    t: float
    names: str
    depth: float
    duration: float


def closing_gaps(start: StepStart, near: Contacts, result: StepResult, rounding: float) -> Contacts:
    """Gaps that the motion of a step closes by their linear parts, beyond rounding."""
    closes = -start.h / 2 * (near.at_start(start.v) + near.at_end(result.v))[:, 0]
    return near.some((closes > rounding) & (closes - near.distance > rounding))


def find_passage(
    step: ContactStep, t: float, h: float, y: np.ndarray, result: StepResult
) -> Passage | None:
    """Shapes that move through each other in a step from ``t``, ``y``; None without any."""
    if result.closing is None or not (gaps := step.rigid(result.closing)).count:
        return None
    end, travel = result.y, step.model.equations.manifold.lead(y, result.y)[:, None]
    after = step.near(step.at(t + h, end), travel)
    pairs, pairs_after = step.pairs(gaps.key), step.pairs(after.key)
    rows, nearest = _nearest(pairs, pairs_after, after.distance)
    before = _normals(step, step.at(t, y), gaps.key[rows])
    beyond = _normals(step, step.at(t + h, end), after.key[nearest])
    for row in rows[(before * beyond).sum(axis=1) < 0]:

        def gap(s: float, pair: int = pairs[row]) -> float:
            at = step.at(t + s * h, between(step.model, y, end, s))
            near = step.near(at, travel)
            return float(near.distance[step.pairs(near.key) == pair].min(initial=np.inf))

        deepest = lowest(gap)
        depth = -gap(deepest)
        if depth > SHALLOW * step.length:
            entry, leaving = (crossing(gap, deepest, limit) for limit in (0.0, 1.0))
            names = f"{bodies_of(step.model, gaps, row)} of {step.names[gaps.owner[row]]}"
            return Passage(t, names, depth, h * (leaving - entry))
    return None


def _nearest(
    pairs: np.ndarray, pairs_after: np.ndarray, distance: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Gaps of some pairs of shapes, and the nearest gaps of the same ones at the end of a step.

    Parameters
    ----------
    pairs, pairs_after : (n,), (m,) numbers of the pairs of both
    distance : (m,) gaps at the end
    """
    order = np.lexsort((distance, pairs_after))
    present, first = np.unique(pairs_after[order], return_index=True)
    if not present.size:
        return np.zeros(0, dtype=int), order
    place = np.minimum(np.searchsorted(present, pairs), present.size - 1)
    rows = np.flatnonzero(present[place] == pairs)
    return rows, order[first[place[rows]]]


def _normals(step: ContactStep, at: Configuration, keys: np.ndarray) -> np.ndarray:
    """(n, 3) normals of gaps, from the body whose name comes first; zero without a place."""
    normals, numbers = np.zeros((keys.size, 3)), keys // APART
    for number in np.unique(numbers):
        rows, source = np.flatnonzero(numbers == number), step.sources[number]
        own = keys[rows] % APART
        bodies = source.bodies(own)
        signs = np.where(bodies[:, 0] > bodies[:, 1], -1.0, 1.0)
        normals[rows] = signs[:, None] * source.points(at, own)[1][:, :, 0]
    return normals


def lowest(gap: Callable[[float], float]) -> float:
    """The share of a step at which a gap is smallest."""
    shares = np.linspace(0, 1, SAMPLES + 1)
    k = int(np.argmin([gap(s) for s in shares]))
    low, high = shares[max(k - 1, 0)], shares[min(k + 1, SAMPLES)]
    for _ in range(ITERATIONS):
        first, second = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        low, high = (low, second) if gap(first) < gap(second) else (first, high)
    return float(low + high) / 2


def crossing(gap: Callable[[float], float], inside: float, outside: float) -> float:
    """The share at which a gap is zero between one at which it is negative and another one."""
    if gap(outside) < 0:
        return outside
    for _ in range(ITERATIONS):
        middle = (inside + outside) / 2
        inside, outside = (middle, outside) if gap(middle) < 0 else (inside, middle)
    return inside


def passage_warnings(passages: list[Passage]) -> list[str]:
    """Warning about a run in which shapes move through each other."""
    if not passages:
        return []
    worst = max(passages, key=lambda passage: passage.depth)
    shortest = min(passage.duration for passage in passages)
    number = len(passages)
    more = "" if number == 1 else f", and in {number - 1}{' or more' * (number >= MOST)} others"
    return [
        f"{worst.names} move through each other within the step at t = {worst.t:.9g} s{more}, by "
        f"{worst.depth:.3g} m for {worst.duration:.2g} s: MoreauJean evaluates gaps at the ends of "
        f"steps only; use step={shortest / 3:.1g} or shorter, or integrator=AnticipatedImpacts()"
    ]
