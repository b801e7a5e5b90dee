"""Warning about contacts that are interrupted for single steps.

Bodies that press on each other with ``MoreauJean`` may stand at a small gap. Where the features
that touch change, as from one side of a tooth to the next, this gap may be open in one step, in
which forces change the speeds by ``h a``; the next step restores them. Positions hardly differ, so
that their error estimate does not show it.
"""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.gaps.model_gaps import APART
from dalembert.results.nonsmooth_motion import ContactRecord

SHARE = 0.05
"""Change of a speed, relative to the largest value of this speed, that causes a warning [-]."""
ALIKE = 1e-6
"""Relative difference of the lengths of steps that are alike [-]."""


def interruption_warnings(step: ContactStep, record: ContactRecord) -> list[str]:
    """Warning about a run whose speeds change in steps without contact between two with one."""
    v, owners = record.ends.v, np.array(step.model.guesses.owners)
    largest, worst, count = np.abs(v).max(axis=1), (SHARE, 0, 0), 0
    for bodies, k in interruptions(step, record):
        first, second = v[:, k + 1] - v[:, k], v[:, k + 2] - v[:, k + 1]
        restored = (first * second < 0) & np.isin(owners, bodies) & (largest > 0)
        changes = np.where(restored, np.minimum(np.abs(first), np.abs(second)), 0.0)
        shares = np.divide(changes, largest, out=np.zeros_like(changes), where=restored)
        coordinate = int(np.argmax(shares))
        count += bool(shares[coordinate] > SHARE)
        worst = max(worst, (float(shares[coordinate]), coordinate, k))
    if not count:
        return []
    share, coordinate, k = worst
    name, h = step.model.guesses.speed_names[coordinate], record.t[k + 1] - record.t[k]
    steps = "a single step" if count == 1 else f"{count} single steps"
    return [
        f"bodies that press on each other do not touch in {steps}, in which forces change speeds "
        f"by up to {100 * share:.2g} % of their largest value, that of {name} at t = "
        f"{record.t[k]:.6g} s: speeds and contact forces vary by this; use steps below "
        f"{SHARE * h / share:.1g} s, or integrator=AnticipatedImpacts()"
    ]


def interruptions(step: ContactStep, record: ContactRecord) -> list[tuple[list[str], int]]:
    """Two bodies that press on each other in two steps before and in one after a step, and its
    number, in which nothing presses on them."""
    pressed = record.impulse[:, 0] > 0
    names = np.full((record.key.size, 2), "", dtype=object)
    for number, source in enumerate(step.sources):
        own = (record.key // APART == number) & pressed
        names[own] = source.bodies(record.key[own] % APART)
    steps: dict[tuple[str, str], set[int]] = {}
    touched: dict[str, set[int]] = {}
    for (i, j), k in zip(names[pressed], record.step[pressed].tolist(), strict=True):
        steps.setdefault((min(i, j), max(i, j)), set()).add(k)
        for body in (i, j):
            touched.setdefault(body, set()).add(k)
    h = np.diff(record.t)
    interrupted = []
    for bodies, own in steps.items():
        moving = [body for body in bodies if body not in ("", "ground")]
        for k in sorted(k + 1 for k in own if {k - 1, k + 2} <= own and k + 1 not in own):
            alike = np.ptp(h[k - 1 : k + 2]) < ALIKE * h[k]
            if alike and not any(k in touched[body] for body in moving):
                interrupted.append((moving, k))
    return interrupted
