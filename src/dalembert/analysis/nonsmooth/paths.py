"""Gaps along the path of a step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.mean_gaps import mean_gaps
from dalembert.analysis.nonsmooth.step_state import StepResult, StepStart
from dalembert.integrators.contact.contacts import Contacts

LINEAR = 1e-9
"""Deviation of a gap from its linear part, relative to its penetration, that counts as zero [-]."""


def path_means(step: ContactStep, start: StepStart, contacts: Contacts, v: np.ndarray) -> Contacts:
    """Some gaps with directions that are means over the path with the speeds ``v`` at its end.

    By the midpoint rule ``u⁺ + u⁻ = W̄ (v⁺ + v) + 2 w̄``, where ``u⁻`` is the velocity at the start
    as with directions in the middle; for gaps that close by an impact it is ``W̄ v + w̄``.
    """
    begin = step.at(start.t, start.y)
    first, mean = mean_gaps(
        lambda t, y: step.following(step.at(t, y), contacts.key, begin),
        step.model.equations.manifold,
        (start.t, start.h),
        start.y,
        start.h * (step.scheme.theta * v + (1 - step.scheme.theta) * start.v),
    )
    kept = contacts.kept_mask
    if step.scheme.theta != 0.5:
        return replace(mean, kept=kept)
    turning = np.where(kept[:, None], 0.0, mean.speeds(start.v) - first.speeds(start.v))
    return replace(mean, turning=turning, kept=kept)


def bent_gaps(step: ContactStep, start: StepStart, result: StepResult) -> np.ndarray:
    """Sorted keys of the pressing compliant contacts whose gaps at the end differ from their linear
    parts."""
    contacts = result.contacts
    acting = step.force_laws.compliant(contacts) & (result.impulses.impulses[:, 0] > 0)
    pressing = contacts.some(acting)
    theta, ends_of = step.scheme.theta, (pressing.at_start(start.v), pressing.at_end(result.v))
    change = start.h * ((1 - theta) * ends_of[0] + theta * ends_of[1])[:, 0]
    end = step.at(start.t + start.h, result.y)
    ends = step.selected(end, pressing.key).distance
    deviation = np.abs(ends - pressing.distance - change)
    depth = -np.minimum(pressing.distance, ends)
    bent = deviation > np.maximum(LINEAR * depth, step.rounding)
    return np.asarray(np.sort(pressing.key[bent]))
