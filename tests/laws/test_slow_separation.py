"""Law: steps of AnticipatedImpacts are continuous where resting contacts begin to separate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.integrators.contact.approach import CLOSING, Approach
from dalembert.integrators.contact.contact_laws import ContactLaws
from dalembert.integrators.contact.contacts import Contacts
from dalembert.integrators.contact.offset_slopes import anticipated_slopes

RADIUS, STEP = 0.05, 1e-3
SCENES = range(8)


def row_of_discs(seed: int) -> da.Model:
    """A disc on a wall, one that falls on it, and a faster one that strikes the latter."""
    rng = np.random.default_rng(seed)
    slow = rng.uniform(0.5, 2)
    fast, gap = slow + rng.uniform(0.1, 1), rng.uniform(0, 3e-3)
    places = RADIUS + np.array([0.0, 2 * RADIUS + gap, 4 * RADIUS + gap + rng.uniform(0, 2e-3)])
    system = da.System("row of discs", gravity=(-9.81, 0))
    share = system.parameter("share", 1.0)
    shapes = []
    for name, place, speed in zip("abc", places, (0.0, slow, fast), strict=True):
        mass = rng.uniform(0.5, 2)
        motion = {"position": (place, 0), "angle": 0.0, "velocity": (-speed * share, 0)}
        body = system.add(planar.Body(name, mass=mass, inertia=1e-3, **motion))
        shapes.append(planar.contact.Circle(body, RADIUS))
    shapes.append(planar.contact.HalfPlane(system.ground.center, (1, 0)))
    system.add(planar.Collisions("contacts", shapes, restitution=0.0))
    return system.build()


@pytest.mark.parametrize("seed", SCENES)
def test_rounding_does_not_change_the_motion_after_an_impact(seed: int) -> None:
    """Discs that stop with a gap between them are pressed in the next step: their relative speed
    is zero but for rounding, whose sign has no effect."""
    model = row_of_discs(seed)
    speeds = [
        da.solve_nonsmooth(model, 0.012, step=STEP, parameters={"share": share}).record.ends.v
        for share in 1 + 1e-15 * np.array([0, -4, -2, -1, 1, 2, 4])
    ]
    assert np.abs(np.array(speeds) - speeds[0]).max() <= 1e-9


def approach_of(seed: int, count: int = 400) -> Approach:
    """Contacts with gaps and speeds of a step's change of speed, which rest or separate."""
    rng = np.random.default_rng(seed)
    forced = 9.81 * STEP
    laws = np.zeros((5, count))
    laws[0] = rng.choice([0.0, 0.3, 0.8, 1.0], count)
    gap = forced * STEP * rng.uniform(0, 6, count)
    zero = np.zeros((count, 2))
    own = ContactLaws.of(laws, (1,))
    numbers = np.arange(count)
    contacts = Contacts(gap, np.zeros((2 * count, 1)), zero, own, (1,), numbers, 0 * numbers)
    before = zero.copy()
    before[:, 0] = rng.uniform(-1.3, 0.8, count) * CLOSING * gap / STEP
    free = before + np.array([rng.uniform(-forced, 0, count), np.zeros(count)]).T
    free[0, 0] = before[0, 0] - forced
    return Approach(contacts, before, free, STEP, STEP * rng.choice([1, 3, 8]))


def shifted(
    approach: Approach, gap: float = 0.0, speed: float = 0.0, restitution: float = 0.0
) -> Approach:
    """The approach with other gaps, speeds before the step, or restitution."""
    laws = approach.contacts.laws
    laws = replace(laws, restitution=laws.restitution + restitution)
    contacts = replace(approach.contacts, distance=approach.contacts.distance + gap, laws=laws)
    change = np.array([speed, 0.0])
    return replace(
        approach, contacts=contacts, before=approach.before + change, free=approach.free + change
    )


@pytest.mark.parametrize("seed", range(6))
def test_derivatives_of_least_speeds_are_those_of_differences(seed: int) -> None:
    """Offsets of contacts that rest, approach slowly, and separate."""
    approach = approach_of(seed)
    offsets = np.zeros_like(approach.before)
    offsets[:, 0] = -approach.least.bounce
    slopes = anticipated_slopes(approach, offsets, CLOSING, 1e-13)
    apart = approach.contacts.distance > 1e-8
    kinks = np.zeros(apart.size, dtype=bool)
    cases = ("gap", 1e-11, 1 / STEP), ("speed", 1e-8, 1.0), ("restitution", 1e-7, 9.81 * STEP)
    for name, change, scale in cases:
        ahead, here, behind = (
            -shifted(approach, **{name: share * change}).least.bounce for share in (1, 0, -1)
        )
        difference, half = (ahead - behind) / (2 * change), (ahead - here) / change
        kinks |= np.abs(half - difference) > 1e-4 * scale
        error = np.abs(getattr(slopes, name) - difference)
        smooth = apart & ~kinks
        assert smooth.sum() > 150
        assert error[smooth].max() <= 1e-4 * scale, name
    closing = -approach.before[:, 0] * STEP / approach.contacts.distance
    assert ((closing > 0) & (closing < CLOSING) & apart & ~kinks).sum() > 80
