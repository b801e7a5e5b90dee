"""Warning about successive impacts that a step applies as one.

All contacts of a step have their impulses together. Where an impact drives a body over a gap onto
the next one within the same step, Newton's law counts that gap as closed before: three elastic
balls in a row leave with (−1/3, 2/3, 2/3) of the speed instead of (0, 0, 1). Gaps that are closed
but for the rounding of their input are those of bodies that touch. The correction of a position
may close a gap, too, before the impact that would have to close it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.analysis.nonsmooth.checks.missing_rebounds import effective_masses
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.starts.touching_shapes import bodies_of
from dalembert.results.nonsmooth_motion import ContactRecord

SHARE = 0.05
"""Energy of the rebound of a gap that counts as closed, relative to that in the motion, that causes
a warning [-]."""
MOST = 50
"""Upper limit of the number of steps that are examined, those with the largest impulses."""


@dataclass(frozen=True)
class JoinedImpact:
    """A gap that an impact in the same step closes.

    Attributes
    ----------
    t : start of the step [s]
    names : its bodies and element
    gap, speed : at the start of the step [m], and with which the impact closes it, by the impulse
        [m/s]
    energy : of the rebound of an impact by itself [J]
    """

    t: float
    names: str
    gap: float
    speed: float
    energy: float


def simultaneous_impact_warnings(
    step: ContactStep, record: ContactRecord, moved: float
) -> list[str]:
    """Warning about a run in which a step joins impacts that follow each other.

    Parameters
    ----------
    moved : energy that took part in the motion [J]
    """
    count, scales = record.loss.size, step.model.scales
    largest = np.zeros(count)
    np.maximum.at(largest, record.step, record.impulse[:, 0])
    angular = np.array(step.model.guesses.speed_units) == "rad"
    lengths = np.where(angular, scales.size, scales.length / scales.displacements)
    speeds = np.abs(record.ends.v[:, :-1]) * lengths[:, None]
    limit = 4 * largest * speeds.max(axis=0, initial=0.0)  # of the energy of one
    several = np.bincount(record.step, minlength=count) > 1
    chosen = np.flatnonzero(several & (limit > SHARE * moved))
    chosen = chosen[np.argsort(-largest[chosen])][:MOST]
    joined = (_joined(step, record, int(k)) for k in chosen)
    impacts = [impact for impact in joined if impact is not None]
    worst = max(impacts, key=lambda of: of.energy, default=None)
    if worst is None or not worst.energy > SHARE * moved:
        return []
    return [
        f"an impact closes the gap of {worst.gap:.3g} m of {worst.names} within the step at "
        f"t = {worst.t:.9g} s, and both count as one, as if these bodies touched: separate impacts "
        f"may lead to another motion; use step={worst.gap / (2 * worst.speed):.1g} or shorter, or "
        "separate_impacts=True"
    ]


def _joined(step: ContactStep, record: ContactRecord, k: int) -> JoinedImpact | None:
    """The open gap in step ``k`` that an impact closes, with the largest energy; None without."""
    t, own = float(record.t[k]), np.flatnonzero(record.step == k)
    h, own = float(record.t[k + 1]) - t, own[np.argsort(record.key[own])]
    start = step.begin(t, h, record.ends.y[:, k], record.ends.v[:, k], k == 0)
    contacts = step.rigid(step.starting(start, record.key[own]))
    strikes = start.approach(contacts, step.rounding).impacting
    distance = np.maximum(contacts.distance, _uncorrected(step, record, k, contacts.key))
    open_gaps = distance > step.rounded_overlap
    closed = np.flatnonzero(open_gaps & ~strikes & (contacts.laws.restitution > 0))
    if not closed.size or not strikes.any():
        return None
    gaps = contacts.some(closed)
    impulses = record.impulse[own[np.isin(record.key[own], gaps.key)], 0]
    masses = effective_masses(gaps, start.motion.mobility)
    reached = gaps.at_end(record.ends.v[:, k + 1])[:, 0]
    speeds = np.divide(impulses, masses, out=np.zeros_like(masses), where=masses > 0) - reached
    fastest = -2 * float(contacts.at_start(start.v)[strikes, 0].min())  # of a light body
    speeds = np.clip(speeds, 0.0, fastest)  # impulses to further bodies are part of them
    energies = masses * (gaps.laws.restitution * speeds) ** 2 / 2
    worst = int(np.argmax(energies))
    if not energies[worst] > 0:
        return None
    names = f"{bodies_of(step.model, gaps, worst)} of {record.names[gaps.owner[worst]]}"
    return JoinedImpact(
        t, names, float(distance[closed][worst]), float(speeds[worst]), float(energies[worst])
    )


def _uncorrected(step: ContactStep, record: ContactRecord, k: int, keys: np.ndarray) -> np.ndarray:
    """(n,) gaps at the start of step ``k`` before the correction of the position there, which may
    close them."""
    if k == 0 or step.scheme.anticipates:
        return np.zeros(keys.size)
    y, (before, after) = record.ends.y[:, k - 1], record.ends.v[:, k - 1 : k + 1].T
    t, h = float(record.t[k]), float(record.t[k] - record.t[k - 1])
    motion = h * (before + step.scheme.theta * (after - before))
    end = step.model.equations.manifold.go(y, motion)
    return step.selected(step.at(t, end), keys).distance
