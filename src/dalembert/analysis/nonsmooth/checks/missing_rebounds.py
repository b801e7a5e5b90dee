"""Warnings about rebounds with a wrong energy, as impacts fall within a step.

A body with the normal speed ``s`` and the gap ``g`` at the start of a step, accelerated by ``a``,
hits at ``√(s² + 2 a g)``, and rebounds with the share ``e²`` of this energy. A scheme returns
``e s`` while the gap is open, so that ``(1 − e²) a g`` remain. ``AnticipatedImpacts`` counts slow
contacts as resting, and ``MoreauJean`` returns ``e s``, which is nothing for a body that begins to
fall: it then stands in front of the gap. Impulses of Poisson's and the energetic law do not state
the speed after an impact: its share of the speed before it is that of the run, unless most of the
latter is due to forces in the step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.mobility import delassus
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.integrators.contact.approach import SLOW
from dalembert.integrators.contact.contacts import Contacts, among
from dalembert.results.nonsmooth_motion import ContactRecord

SHARE, ROUGH = 0.01, 0.03
"""Missing energy of a step, and error of the energy of its rebounds, relative to the energy in the
motion, that cause a warning [-]."""
ENOUGH = 10.0
"""Recommended approach speed, relative to the change of speed by forces in a step [-]."""
MOST = 200
"""Upper limit of the number of steps that are examined, those with the largest losses or
impulses."""
MEASURED = 0.5
"""Threshold of the speed at the start of a step with an impact, relative to that of the impact,
above which the share of it that returns is that of the run [-]."""
REBOUND = 0.5
"""Threshold of a speed that counts as the rebound, relative to the exact one [-]."""


@dataclass(frozen=True)
class Rebounds:
    """Rebounds in one step.

    Attributes
    ----------
    missing, error : energy of missing rebounds, and error of the energy of the others [J]
    step : its number
    owner, other : numbers of the elements with the largest parts of both
    speed, restitution, acceleration : of the contact with the largest missing energy: speed of the
        impact [m/s], ``e``, ``a`` [m/s²]
    """

    missing: float
    error: float
    step: int
    owner: int
    other: int
    speed: float
    restitution: float
    acceleration: float


def rebound_warnings(step: ContactStep, record: ContactRecord, moved: float) -> list[str]:
    """Warnings about a run in which impacts within a step have no rebound, or a wrong one.

    Parameters
    ----------
    moved : energy that took part in the motion [J]
    """
    size = np.bincount(record.step, record.impulse[:, 0], record.loss.size)
    chosen = np.flatnonzero(size)
    if step.scheme.anticipates:
        size, chosen = record.loss, np.flatnonzero(record.loss > SHARE * moved)
    chosen = chosen[np.argsort(-size[chosen])][:MOST]
    rebounds = [of for k in chosen if (of := _rebounds(step, record, int(k))) is not None]
    worst = max(rebounds, key=lambda of: of.missing, default=None)
    if worst is not None and worst.missing > SHARE * moved:
        return [_missing_text(record, worst, moved)]
    worst = max(rebounds, key=lambda of: of.error, default=None)
    if worst is not None and worst.error > ROUGH * moved:
        return [_error_text(record, worst, moved)]
    return []


def _missing_text(record: ContactRecord, worst: Rebounds, moved: float) -> str:
    k = worst.step
    shorter = worst.speed / (ENOUGH * worst.acceleration)
    return (
        f"{record.names[worst.owner]} closes a gap at {worst.speed:.3g} m/s within the step at "
        f"t = {record.t[k]:.9g} s, in which forces change speeds by "
        f"{worst.acceleration * (record.t[k + 1] - record.t[k]):.3g} m/s: the rebound by its "
        f"restitution of {worst.restitution:.3g} is missing, {worst.missing:.3g} J, where "
        f"{moved:.3g} J took part in the motion; use step={shorter:.1g} or shorter"
    )


def _error_text(record: ContactRecord, worst: Rebounds, moved: float) -> str:
    k = worst.step
    shorter = (record.t[k + 1] - record.t[k]) * ROUGH * moved / worst.error
    return (
        f"the energy after an impact of {record.names[worst.other]} at t = {record.t[k]:.9g} s "
        f"differs by {worst.error:.3g} J from that by its restitution, where {moved:.3g} J took "
        f"part in the motion, as the impact is applied before the gap is closed; use "
        f"step={shorter:.1g} or shorter"
    )


def _rebounds(step: ContactStep, record: ContactRecord, k: int) -> Rebounds | None:
    """Rebounds of the contacts that press in step ``k``, and not before or that close fast; None
    without any."""
    own, before = (record.key[record.step == number] for number in (k, k - 1))
    t, y, v = float(record.t[k]), record.ends.y[:, k], record.ends.v[:, k]
    h = float(record.t[k + 1]) - t
    start = step.begin(t, h, y, v, k == 0)
    contacts = step.rigid(step.starting(start, np.sort(own)))
    strikes = start.approach(contacts, step.rounding).impacting
    contacts = contacts.some(strikes | ~among(contacts.key, before))
    if not contacts.count:
        return None
    closing = -contacts.at_start(v)[:, 0]
    acceleration = (-contacts.at_end(start.free)[:, 0] - closing) / h
    fall = 2 * np.maximum(acceleration, 0.0) * np.maximum(contacts.distance, 0.0)
    speed = np.sqrt(np.maximum(closing, 0.0) ** 2 + fall)
    rebound = contacts.laws.restitution * speed
    after = contacts.at_end(record.ends.v[:, k + 1])[:, 0]
    rebounds = after >= REBOUND * rebound
    if step.scheme.anticipates:  # of which the impact may be in the next step
        next_v = record.ends.v[:, min(k + 2, record.t.size - 1)]
        rebounds |= contacts.at_end(next_v)[:, 0] >= REBOUND * rebound
        newton = contacts.laws.follows(ImpactLaw.NEWTON)
        rebounds |= ~newton & (speed > SLOW * float(np.abs(h * acceleration).max()))
    masses = effective_masses(contacts, start.motion.mobility)
    missing = np.where(rebounds, 0.0, masses * rebound**2 / 2)
    height, elastic = np.zeros(contacts.count), contacts.laws.restitution != 0
    if elastic.any():  # the height of others is dissipated by later impacts
        end = step.selected(step.at(t + h, record.ends.y[:, k + 1]), contacts.key[elastic])
        height[elastic] = np.maximum(acceleration[elastic], 0.0) * np.maximum(end.distance, 0.0)
    measured = closing > MEASURED * speed
    share = np.divide(after, closing, out=contacts.laws.restitution.copy(), where=measured)
    newton = contacts.laws.follows(ImpactLaw.NEWTON)
    exact = np.where(newton, rebound, share * speed)
    error = masses * np.abs(after**2 / 2 + height - exact**2 / 2)
    error = np.where(rebounds & (after > 0), error, 0.0)
    worst, other = int(np.argmax(missing)), int(np.argmax(error))
    of = speed[worst], contacts.laws.restitution[worst], max(acceleration[worst], 1e-300)
    owners = int(contacts.owner[worst]), int(contacts.owner[other])
    energies = float(missing.sum()), float(error.sum())
    return Rebounds(*energies, k, *owners, *(float(value) for value in of))


def effective_masses(contacts: Contacts, mobility) -> np.ndarray:
    """(n,) effective masses along the normals of the gaps [kg]."""
    diagonal = delassus(contacts.normals, mobility).diagonal()
    return np.divide(1.0, diagonal, out=np.zeros_like(diagonal), where=diagonal > 0)
