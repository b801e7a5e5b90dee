"""Warning about impacts that fall within a step, so that bodies do not rebound.

A body with the normal speed ``s`` and the gap ``g`` at the start of a step, accelerated by ``a``,
hits at ``√(s² + 2 a g)``, and rebounds with the share ``e²`` of this energy. ``AnticipatedImpacts``
counts contacts with ``s ≤ 2 a h`` as resting, and ``MoreauJean`` returns ``e s``, which is nothing
for a body that begins to fall: it then stands in front of the gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.mobility import delassus
from dalembert.integrators.contact.approach import SLOW
from dalembert.integrators.contact.contacts import Contacts
from dalembert.results.nonsmooth_motion import ContactRecord

SHARE = 0.01
"""Missing energy of a step, relative to the energy in the motion, that causes a warning [-]."""
ENOUGH = 10.0
"""Recommended approach speed, relative to the change of speed by forces in a step [-]."""
MOST = 200
"""Upper limit of the number of steps that are examined, those with the largest losses or
impulses."""
REBOUND = 0.5
"""Threshold of a speed that counts as the rebound, relative to the exact one [-]."""


@dataclass(frozen=True)
class MissingRebound:
    """Rebounds missing in one step.

    Attributes
    ----------
    energy : of all contacts [J]
    step : its number
    owner : number of the element with the largest part
    speed, restitution, acceleration : of its contact: speed of the impact [m/s], ``e``, ``a``
        [m/s²]
    """

    energy: float
    step: int
    owner: int
    speed: float
    restitution: float
    acceleration: float


def rebound_warnings(step: ContactStep, record: ContactRecord, moved: float) -> list[str]:
    """Warning about a run in which impacts within a step have no rebound.

    Parameters
    ----------
    moved : energy that took part in the motion [J]
    """
    size = np.bincount(record.step, record.impulse[:, 0], record.loss.size)
    chosen = np.flatnonzero(size)
    if step.scheme.anticipates:
        size, chosen = record.loss, np.flatnonzero(record.loss > SHARE * moved)
    chosen = chosen[np.argsort(-size[chosen])][:MOST]
    losses = [missing for k in chosen if (missing := _missing(step, record, int(k))) is not None]
    worst = max(losses, key=lambda missing: missing.energy, default=None)
    if worst is None or not worst.energy > SHARE * moved:
        return []
    k = worst.step
    shorter = worst.speed / (ENOUGH * worst.acceleration)
    return [
        f"{record.names[worst.owner]} closes a gap at {worst.speed:.3g} m/s within the step at "
        f"t = {record.t[k]:.9g} s, in which forces change speeds by "
        f"{worst.acceleration * (record.t[k + 1] - record.t[k]):.3g} m/s: the rebound by its "
        f"restitution of {worst.restitution:.3g} is missing, {worst.energy:.3g} J, where "
        f"{moved:.3g} J took part in the motion; use step={shorter:.1g} or shorter"
    ]


def _missing(step: ContactStep, record: ContactRecord, k: int) -> MissingRebound | None:
    """Rebounds missing in step ``k``; None without any."""
    own, before = (record.key[record.step == number] for number in (k, k - 1))
    keys = np.sort(own[~np.isin(own, before)])
    t, y, v = float(record.t[k]), record.ends.y[:, k], record.ends.v[:, k]
    h = float(record.t[k + 1]) - t
    if not keys.size:
        return None
    contacts = step.rigid(step.selected(step.at(t, y), keys))
    contacts = contacts.some(contacts.laws.restitution > 0)
    if not contacts.count:
        return None
    motion = step.smooth.step(t, y, v, step.p, h, step.scheme.theta).free
    free, mobility = motion.speeds, motion.mobility
    start = -contacts.speeds(v)[:, 0]
    acceleration = (-contacts.speeds(free)[:, 0] - start) / h
    fall = 2 * np.maximum(acceleration, 0.0) * np.maximum(contacts.distance, 0.0)
    speed = np.sqrt(np.maximum(start, 0.0) ** 2 + fall)
    forced = float(np.abs(h * acceleration).max())
    rebound = contacts.laws.restitution * speed
    rebounds = contacts.speeds(record.ends.v[:, k + 1])[:, 0] >= REBOUND * rebound
    if step.scheme.anticipates:  # of which the impact may be in the next step
        rebounds |= start > SLOW * forced
    energy = np.where(rebounds, 0.0, _masses(contacts, mobility) * rebound**2 / 2)
    worst = int(np.argmax(energy))
    of = speed[worst], contacts.laws.restitution[worst], max(acceleration[worst], 1e-300)
    owner = int(contacts.owner[worst])
    return MissingRebound(float(energy.sum()), k, owner, *(float(value) for value in of))


def _masses(contacts: Contacts, mobility) -> np.ndarray:
    """(n,) effective masses along the normals of the gaps [kg]."""
    width = contacts.drift.shape[1]
    normals = contacts.directions[np.arange(contacts.count) * width]
    diagonal = delassus(normals, mobility).diagonal()
    return np.divide(1.0, diagonal, out=np.zeros_like(diagonal), where=diagonal > 0)
