"""Warning about bodies that ``AnticipatedImpacts`` slows down before impacts that do not occur.

The scheme leaves room for an impact in the next step, by gaps and directions of this one. Where
directions turn far in a step, a gap may open again by itself beforehand.
"""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.integrators.contact.contacts import Contacts
from dalembert.results.nonsmooth_motion import ContactRecord

SHARE = 0.05
"""Energy dissipated before them, relative to that in the motion, that causes a warning [-]."""
MOST = 200
"""Upper limit of the number of steps that are examined, those with the largest losses."""
AHEAD = 10
"""Number of the following steps in which the impact may occur."""


def early_impact_warnings(step: ContactStep, record: ContactRecord, moved: float) -> list[str]:
    """Warning about a run in which contacts dissipate energy and open without an impact.

    Parameters
    ----------
    moved : energy that took part in the motion [J]
    """
    chosen = np.flatnonzero(record.loss > SHARE * moved)
    chosen = chosen[np.argsort(-record.loss[chosen])][:MOST]
    losses = np.array([_loss_of_openings(step, record, int(k)) for k in chosen])
    if not losses.sum() > SHARE * moved:
        return []
    worst = int(np.argmax(losses))
    k = chosen[worst]
    names = {record.names[owner] for owner in record.owner[record.step == k]}
    return [
        f"{' and '.join(sorted(names))} dissipate {losses.sum():.3g} J, where {moved:.3g} J took "
        f"part in the motion, before gaps that open again without an impact, most of it at "
        f"t = {record.t[k]:.9g} s: their directions turn far in a step; use "
        f"step={(record.t[k + 1] - record.t[k]) / 10:.1g} or shorter"
    ]


def _loss_of_openings(step: ContactStep, record: ContactRecord, k: int) -> float:
    """Energy dissipated in a step by the contacts that still close at its end, and open in the
    following ones before they press [J]."""
    own, loss = record.step == k, 0.0
    for key, impulse in zip(record.key[own], record.impulse[own, 0], strict=True):
        before, after = (_speed(step, record, j, key) for j in (k, k + 1))
        if before < 0 and after < 0 and _opens(step, record, k + 1, key):
            loss -= impulse * (before + after) / 2
    return min(loss, float(record.loss[k]))


def _opens(step: ContactStep, record: ContactRecord, start: int, key: int) -> bool:
    """Whether the directions of a gap turn so that it opens after a number of steps, before its
    shapes press again, though its bodies move on."""
    pair, first = step.pairs(np.array([key])), _gap(step, record, start, key)
    for j in range(start, min(start + AHEAD, record.loss.size)):
        if np.isin(pair, step.pairs(record.key[record.step == j])).any():
            return False
        if _speed(step, record, j + 1, key) > 0:
            return bool(first.speeds(record.ends.v[:, j + 1])[0, 0] < 0)
    return False


def _speed(step: ContactStep, record: ContactRecord, j: int, key: int) -> float:
    """Normal speed of a gap after a number of steps [m/s]."""
    return float(_gap(step, record, j, key).speeds(record.ends.v[:, j])[0, 0])


def _gap(step: ContactStep, record: ContactRecord, j: int, key: int) -> Contacts:
    """A gap after a number of steps."""
    at = step.at(float(record.t[j]), record.ends.y[:, j])
    return step.selected(at, np.array([key]))
