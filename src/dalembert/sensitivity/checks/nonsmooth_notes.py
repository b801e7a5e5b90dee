"""Notes on gradients of runs with rigid contacts in fixed steps."""

from __future__ import annotations

import numpy as np

from dalembert.errors import SingularityError, UnsupportedError
from dalembert.results.nonsmooth_motion import NonsmoothMotion
from dalembert.sensitivity.nonsmooth.contact_changes import ContactChanges
from dalembert.sensitivity.nonsmooth.contact_steps import ContactSteps, contact_steps
from dalembert.sensitivity.nonsmooth.moving_impacts import step_tangent
from dalembert.sensitivity.nonsmooth.near_impacts import NEAR

CHAOTIC = 1e9
"""Threshold of the growth of changes of a state for a note, in SI units."""


def nonsmooth_notes(motion: NonsmoothMotion) -> list[str]:
    """Notes on contacts whose state changes at nearby parameters."""
    try:
        steps = contact_steps(motion)
    except UnsupportedError:  # of a law of impact that has only differences
        return []
    changes = [_changes(steps, k) for k in range(steps.count)]
    impacts = sum(change.impacts for change in changes)
    first = {
        name: [
            f"t = {t:.6g} s"
            for t, change in zip(steps.record.t, changes, strict=False)
            if getattr(change, name)
        ]
        for name in ("simultaneous", "successive", "grazing", "changing", "redundant", "inelastic")
    }
    notes = []
    if impacts:
        notes.append(
            f"{impacts} impact{'s move' if impacts > 1 else ' moves'} in time with the parameters: "
            "the gradient includes this to the order of the step; the run has impacts at the ends "
            "of steps, so that its differences jump and do not confirm the gradient"
        )
    if breaks := sum(change.breaks for change in changes):
        notes.append(
            f"contacts with static friction break away at {breaks} "
            f"instant{'s' if breaks > 1 else ''}, which move with the parameters: the gradient "
            "includes this to the order of the step, and differences of the run do not confirm it"
        )
    if first["simultaneous"]:
        notes.append(
            f"gaps on the same bodies close in one instant at {first['simultaneous'][0]}: "
            "parameters that separate them make successive impacts, so the derivative is that of a "
            "simultaneous impact"
        )
    if first["successive"]:
        count = sum(change.successive for change in changes)
        notes.append(
            f"{count} impacts come one after the other on connected bodies within a step, first at "
            f"{first['successive'][0]}, and remain closed: the derivative leaves them at the time "
            "of the step; shorter steps separate them"
        )
    near = steps.times_between
    if impacts and near.size and near.min() < NEAR:
        k = int(np.argmin(near))
        notes.append(
            f"impacts on the same bodies follow each other within {near[k]:.2g} steps at "
            f"t = {steps.record.t[k]:.6g} s, and their instants have errors of a step: the "
            "derivative after them is uncertain; give solve_nonsmooth separate_impacts=True, or "
            "take shorter steps"
        )
    if first["grazing"]:
        notes.append(
            f"an impact is close to the threshold of resting contact at {first['grazing'][0]}: "
            "with other parameters it is no impact, so the derivative is one-sided"
        )
    if first["changing"]:
        notes.append(
            f"a contact is about to slip or to stick at {first['changing'][0]}: with other "
            "parameters it does so in another step, so derivatives change there"
        )
    if first["redundant"]:
        notes.append(
            f"contacts are redundant in {len(first['redundant'])} steps, first at "
            f"{first['redundant'][0]}: which of them opens or slips after a change may depend on "
            "its direction, and derivatives are one-sided then; gradients are those of speeds that "
            "satisfy all of them on average"
        )
    if first["inelastic"]:
        notes.append(
            f"an impact by the energetic law has no restitution at {first['inelastic'][0]}: its "
            "derivative by the restitution is missing, as zero; give a small one, such as 1e-6"
        )
    if steps.growth > CHAOTIC:
        notes.append(
            f"changes of the state grow by {steps.growth:.0e} on the way: the motion depends "
            "chaotically on its parameters, as that of many colliding bodies does, and its "
            "gradient holds for tiny changes only; shorten the run, or take a mean over runs"
        )
    return notes


def _changes(steps: ContactSteps, k: int) -> ContactChanges:
    """Changes of contact states in a step, also where it has no derivative."""
    try:
        if k not in steps.changes:
            step_tangent(steps, k)
        return steps.changes[k]
    except (SingularityError, UnsupportedError):  # which gradients refuse
        return ContactChanges()
