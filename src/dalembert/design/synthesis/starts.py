"""Starts of a synthesis: exact linkages of a few poses, closed forms of functions, the atlas."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from dalembert.design.synthesis.atlas import Start, atlas_of
from dalembert.design.synthesis.function_starts import function_starts
from dalembert.design.synthesis.linkage import Linkage
from dalembert.design.synthesis.pose_linkages import PoseLinkage, pose_linkages
from dalembert.design.synthesis.target import Target
from dalembert.errors import AnalysisError

POSES = 5
"""Most poses that a linkage takes exactly."""


def starts_of(
    kind: type[Linkage],
    target: Target,
    bounds: Mapping[str, tuple[float, float]],
    crank_turns: bool,
    count: int,
    rng: np.random.Generator,
) -> list[Start]:
    """Linkages from which a synthesis is polished.

    Functions start from closed forms, motions through up to five poses from Burmester dyads, points
    from the atlas.
    """
    if target.points is None:
        exact = function_starts(kind, target, bounds, crank_turns, -(-3 * count // 4))
        return exact + _random_starts(kind, target, count - len(exact), rng)
    exact = _pose_starts(kind, target, crank_turns, -(-count // 2))
    return exact + atlas_of(kind).nearest(target, count - len(exact))


def _pose_starts(kind: type[Linkage], target: Target, crank_turns: bool, count: int) -> list[Start]:
    """Linkages through a few poses with free timing."""
    timed = target.crank_angles is not None
    if timed or target.coupler_angles is None or target.points is None or len(target) > POSES:
        return []
    try:
        found = pose_linkages(target.points, target.coupler_angles).linkages
    except AnalysisError:  # two poses are one
        return []
    of_kind = [one for one in found if isinstance(one.linkage, kind)]
    of_kind.sort(key=lambda one: (len(one.defects), crank_turns and not one.linkage.crank_turns))
    return [_start(one) for one in of_kind[:count]]


def _start(one: PoseLinkage) -> Start:
    """The sense in which the crank takes the shorter way through its angles."""
    senses = {s: float(np.sum(np.diff(s * one.crank_angles) % (2 * np.pi))) for s in (1, -1)}
    sense = min(senses, key=lambda s: senses[s])
    steps = sense * (np.diff(sense * one.crank_angles) % (2 * np.pi))
    theta = one.crank_angles[0] + np.concatenate([[0.0], np.cumsum(steps)])
    return Start(one.linkage, theta, sense, one.residual)


def _random_starts(
    kind: type[Linkage], target: Target, count: int, rng: np.random.Generator
) -> list[Start]:
    q, branch = kind.drawn(rng, count), rng.choice([-1, 1], count)
    given = np.zeros(len(target)) if target.crank_angles is None else target.crank_angles
    begins = rng.uniform(0, 2 * np.pi, count)
    return [
        Start(
            kind(**{n: float(v[k]) for n, v in q.items()}, branch=int(branch[k])),
            given + begins[k],
            1,
            np.inf,
        )
        for k in range(count)
    ]
