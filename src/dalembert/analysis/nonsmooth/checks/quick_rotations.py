"""Warning about shapes that overlap within steps in which bodies turn far.

Gaps are conditions at the ends of a step. Points of a body that turns by an angle ``φ`` in it leave
their chord by ``r φ²/8``, and a bar that turns by more than about 1 rad may pass another body.
"""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.between_steps import between
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.results.nonsmooth_motion import ContactRecord

TURN = 0.5
"""Rotation of a body in a step above which overlaps within it are searched for [rad]."""
APART, SAMPLES = 0.05, 64
"""Rotation between the positions within a step at which shapes are compared [rad], and upper limit
of their number."""
MOST = 20
"""Upper limit of the steps that are searched, those with the largest rotations."""
DEEP = 1e-3
"""Overlap within a step that causes a warning, by the size of the bodies [-]."""


def rotation_warnings(step: ContactStep, record: ContactRecord) -> list[str]:
    """Warning about a run in which shapes overlap within steps by rotations of their bodies."""
    groups = step.model.coordinates
    angular = np.array([unit == "rad" for group in groups for unit in group.speed_units])
    if not angular.any() or record.t.size < 2:
        return []
    h, speeds = np.diff(record.t), (record.ends.v[:, 1:] + record.ends.v[:, :-1]) / 2
    turns = h * np.abs(speeds[angular]).max(axis=0)
    quick = np.argsort(-turns)[: min(MOST, np.count_nonzero(turns > TURN))]
    depths = np.array([_overlap(step, record, k, turns[k]) for k in quick])
    if not depths.size or not depths.max() > DEEP * step.length:
        return []
    worst = quick[np.argmax(depths)]
    shorter = TURN * h[worst] / turns.max()
    return [
        f"shapes overlap by {depths.max():.3g} m within the step at t = {record.t[worst]:.9g} s, "
        f"in which a body turns by {turns[worst]:.2g} rad: contacts act at the ends of steps only, "
        f"and bodies that turn far may pass each other; use step={shorter:.1g} or shorter"
    ]


def _overlap(step: ContactStep, record: ContactRecord, k: int, turn: float) -> float:
    """The deepest overlap of rigid contacts within a step, beyond those at its ends [m]."""
    ends, t, deepest = record.ends, record.t, 0.0
    for s in np.linspace(0, 1, min(SAMPLES, int(turn / APART) + 2))[1:-1]:
        y = between(step.model, ends.y[:, k], ends.y[:, k + 1], float(s))
        deepest = max(deepest, -step.deepest(step.at(t[k] + s * (t[k + 1] - t[k]), y)))
    return deepest - float(record.penetration[k : k + 2].max())
