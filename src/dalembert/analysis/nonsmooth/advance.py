"""One time step with contacts: those that act, and repetitions where gaps are closed at its end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.analysis.nonsmooth.checks.missing_impacts import returning_gaps
from dalembert.analysis.nonsmooth.checks.passages import closing_gaps
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.paths import bent_gaps, path_means
from dalembert.analysis.nonsmooth.step_state import LastImpulses, StepResult, StepStart
from dalembert.integrators.contact.contacts import Contacts, among
from dalembert.integrators.contact.schemes import ROUNDING

AHEAD = 2.0
"""Search distance for gaps in motions of a step; those beyond it are added where they close."""
REPETITIONS = 12
"""Upper limit of the solutions of a step that open gaps at its end."""
PATHS = 4
"""Upper limit of the repetitions with means over the path for compliant contacts."""
SETTLED = 0.5
"""Ratio of penetrations of consecutive repetitions above which these reduce it no further [-]."""
STALLS = 2
"""Number of successive repetitions with the same contacts that do not reduce the penetration by
``SETTLED``, after which these end."""
SMALL = 100.0
"""Penetration by inexact impulses that remains, relative to the one that counts as rounding [-]."""
NOISE = 1e-2
"""Change of the penetration of bodies at rest, relative to the one that counts as rounding [-]."""
UNSOLVED = 1e-2
"""Distance that the residual of impulses closes in a step, relative to a penetration, below which
these belong to the solution without the penetration [-]."""
SUPPLIED = 1e-2
"""Upper limit of the energy that added contacts supply, relative to the work of opening the gaps
which they keep open [-]."""
INEXACT = 10.0
"""Upper limit of errors of relative velocities by the tolerance of the impulses [-]."""


def advance(
    step: ContactStep, t: float, h: float, y: np.ndarray, v: np.ndarray, before: LastImpulses | None
) -> StepResult:
    """A step of length ``h``; impulses of the step ``before`` are the starting point.

    Where the gap of a compliant contact is not linear, its force acts along the mean of its
    direction over the path, so that its work is the change of its elastic energy.
    """
    start = step.begin(t, h, y, v, before is None)
    near = step.near(step.at(t, y), AHEAD * h * np.column_stack([v, start.free]))
    facing = _facing(step, start, near, before)
    contacts = step.in_middle(start, facing)
    result = _advanced(step, start, contacts, before)
    for _ in range(PATHS if step.force_laws.elements else 0):
        if not result.impulses.accepted or not np.isfinite(result.y).all():
            break
        bent = bent_gaps(step, start, result)
        if not bent.size:
            break
        bent = np.union1d(bent, result.curved)  # all with means over the path of one solution
        curved = among(contacts.key, bent)
        means = path_means(step, start, contacts.some(curved), result.v)
        contacts = Contacts.joined([contacts.some(~curved), means])
        last, result = result, _advanced(step, start, contacts, result.last)
        if not result.curved.size:
            result = replace(result, curved=bent, path=last)
    result = replace(result, returning=returning_gaps(start, near, result, step.rounding))
    if step.scheme.anticipates:
        return result
    if facing is not near:  # bodies may pass through corners that leave their sides
        contacts = step.in_middle(start, near)
    return replace(result, closing=closing_gaps(start, contacts, result, step.rounding))


def _facing(
    step: ContactStep, start: StepStart, near: Contacts, before: LastImpulses | None
) -> Contacts:
    """The gaps without those of corners that leave a side before they would touch it.

    Teeth move past each other closely: the linear part of the gap over a side closes although the
    corner is past the end of the side then. Gaps that pressed in the step ``before`` remain, and
    those that are closed at the end of the step follow.
    """
    if not near.count:
        return near
    end = step.model.equations.manifold.go(start.y, start.h * start.v)
    leaving = step.leaving(step.at(start.t, start.y), step.at(start.t + start.h, end), near.key)
    if before is not None:
        leaving &= ~among(near.key, before.pressing[0])
    return near.some(~leaving) if leaving.any() else near


def _advanced(
    step: ContactStep, start: StepStart, contacts: Contacts, before: LastImpulses | None
) -> StepResult:
    """A step with some contacts, and with those that have to open or to close with them."""
    if step.scheme.anticipates:
        return _opened(step, start, contacts, before)
    approach = start.approach(contacts, step.rounding)
    some = contacts.some(step.scheme.acting(approach) | step.force_laws.compliant(contacts))
    lifts = approach.forced > step.solver.newton_tolerance * approach.fastest  # against forces
    if step.scheme.projection and lifts:
        return _closed(step, start, some, contacts, approach.resting, before)
    return step.solved(step.struck(start, some), some, before)


def _closed(
    step: ContactStep,
    start: StepStart,
    contacts: Contacts,
    near: Contacts,
    resting: np.ndarray,
    before: LastImpulses | None,
) -> StepResult:
    """Solution in which the gaps that a correction would open have their impact, too.

    Together with them act the ``resting`` ones of the ``near`` gaps: on curved surfaces these open
    by ``O(h²)`` in each step, and without them bodies would fall into each other in every second
    step. Gaps that open without them do not act, such as the backs of teeth, which would jam.
    Features that are closed at the end but not near at the start, such as edges that are
    almost parallel and cross beyond their ends, follow only if gaps remain closed without them.
    """
    result = step.solved(step.struck(start, contacts), contacts, before)
    end = start.t + start.h
    for _ in range(REPETITIONS):
        at_end = step.at(end, result.y)
        if not np.isfinite(result.y).all() or step.deepest(at_end) >= -step.rounding:
            break
        opens = start.h * (near.at_start(start.v) + near.at_end(result.v))[:, 0] / 2
        held = resting & (opens <= step.rounding)
        keys = np.union1d(step.closed(at_end).key, near.key[held])
        keys = keys[~among(keys, contacts.key)]
        if not keys.size:
            break
        added = near.some(among(near.key, keys))
        if not added.count:
            added = step.starting(start, keys)
        joined = start.approach(Contacts.joined([contacts, added]), step.rounding)
        if joined.is_impact:
            added = added.some(joined.slow[contacts.count :])
        if not added.count:
            break
        contacts = Contacts.joined([contacts, added])
        again = step.solved(step.struck(start, contacts), contacts, result.last, result.v)
        if not again.impulses.accepted:
            short = again.impulses.residual * start.h < UNSOLVED * -step.deepest(at_end)
            return again if short else result
        if again.loss < min(result.loss, -_allowed_work(start, again, -step.deepest(at_end))):
            break
        result = again
    return result


def _opened(
    step: ContactStep, start: StepStart, contacts: Contacts, before: LastImpulses | None
) -> StepResult:
    """Solution whose gaps are open at the end of the step.

    Gaps that are closed there though their linear parts are open are replaced by their means
    over the path, and gaps that were beyond reach or of other features are added.
    """
    end, depth = start.t + start.h, np.inf
    compliant = step.force_laws.compliant(contacts)
    inexact = inexact_depth(step, start.h, start.approach(contacts, step.rounding).fastest)
    overlaps = compliant | (contacts.distance < -inexact)
    deepest = -float(contacts.distance[~compliant].min(initial=0.0))
    inexact = max(inexact, lasting_depth(deepest, step.rounding))
    distance = np.where(compliant, contacts.distance, np.maximum(contacts.distance, 0.0))
    contacts = replace(contacts, distance=distance)
    strikes = contacts.key[step.scheme.striking(start.approach(contacts, step.rounding))]
    whole, start = start, step.struck(start, contacts.some(among(contacts.key, strikes)))
    result, curved = step.solved(start, contacts, before), np.zeros_like(overlaps)
    stalls = 0
    for _ in range(REPETITIONS):
        if not np.isfinite(result.y).all():
            break
        late = start.late(result, step.rounding)
        if late.size:
            strikes = np.append(strikes, late)
            start = step.struck(whole, contacts.some(among(contacts.key, strikes)))
            result = _solved_on_path(step, start, contacts, curved, result)
            continue
        at_end = step.at(end, result.y)
        last, depth = depth, -step.deepest(at_end)
        if is_settled(depth, last, step.rounding, inexact):
            break
        added = _added(step, start, at_end, contacts)
        if start.begins and depth >= last and not added.count:
            break  # an impact, which has no earlier step to prepare for it
        contacts = Contacts.joined([contacts, added])
        none = np.zeros(added.count, dtype=bool)
        overlaps, repeated = np.append(overlaps, none), np.append(curved, none)
        curved = repeated | (step.selected(at_end, contacts.key).distance < -step.rounding)
        curved &= ~overlaps
        unchanged = not added.count and np.array_equal(curved, repeated)
        stalls = stalls + 1 if unchanged and depth > SETTLED * last else 0
        if stalls == STALLS or (unchanged and not curved.any()):
            break
        again = _solved_on_path(step, start, contacts, curved, result)
        if not again.impulses.accepted:
            break
        result = again
    return result


def _allowed_work(start: StepStart, result: StepResult, depth: float) -> float:
    """Work of contacts that may result from rounding and from the residual of their impulses, or is
    little beside that of a correction of the penetration ``depth``, without these contacts [J].

    Friction that stops a slip within the step supplies energy, also where it is that of inexact
    impulses at rest, or by the turn of a body that tips over its corner.
    """
    push = result.impulses.impulses
    exchanged = float(push.ravel() @ (result.contacts.directions @ (result.v - start.free)))
    error = max(result.impulses.residual, SUPPLIED * depth / start.h)
    return ROUNDING * exchanged + error * float(np.abs(push).sum())


def inexact_depth(step: ContactStep, h: float, fastest: float) -> float:
    """Penetration at the end of a step by impulses within the tolerance, whose relative velocities
    are up to ``fastest`` [m]."""
    return max(step.rounding, INEXACT * step.solver.newton_tolerance * h * fastest)


def lasting_depth(depth: float, rounding: float) -> float:
    """Penetration that a step may leave which starts with a small one: bodies at rest keep that of
    the inexact impulses by which they came to rest [m]."""
    return min(depth + NOISE * rounding, SMALL * rounding) if depth > rounding else 0.0


def is_settled(depth: float, last: float, rounding: float, inexact: float) -> bool:
    """Whether a penetration after one of ``last`` is that of inexact impulses and either small or
    not reduced by another repetition.

    A rolling body would slip if the conditions of its contacts changed between those of the start
    and their means over the path from step to step.
    """
    return (
        depth <= rounding
        or (depth <= inexact and depth <= SMALL * rounding)
        or (SETTLED * last < depth <= inexact)
    )


def _added(step: ContactStep, start: StepStart, end: Configuration, contacts: Contacts) -> Contacts:
    """Gaps in addition to ``contacts`` of shapes that overlap at the end.

    Features may change within the step. The gaps that are closed at its start are replaced by
    those that separate the shapes there, or, without any, count if forces can open them.
    """
    keys = step.closed(end).key
    keys = keys[~among(keys, contacts.key)]
    if not keys.size:
        return contacts.some(np.zeros(contacts.count, dtype=bool))
    gaps = step.starting(start, keys)
    closed = gaps.distance < -step.rounding
    separating = step.separating(step.at(start.t, start.y), end, gaps.key[closed])
    if not separating.size:
        approach = start.approach(Contacts.joined([contacts, gaps]), step.rounding)
        closed &= gaps.distance < -start.h * approach.forced / 2
    joined = Contacts.joined([gaps.some(~closed), step.starting(start, separating)])
    return joined.some(~among(joined.key, contacts.key))


def _solved_on_path(
    step: ContactStep, start: StepStart, contacts: Contacts, curved: np.ndarray, last: StepResult
) -> StepResult:
    """Solution with means over the path of the last one for curved gaps."""
    own = contacts.some(curved)
    path = Contacts.joined([contacts.some(~curved), path_means(step, start, own, last.v)])
    return replace(step.solved(start, path, last.last, last.v), curved=np.sort(own.key), path=last)
