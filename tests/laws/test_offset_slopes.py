"""Derivatives of the velocity offsets of contacts against differences of the offsets."""

from dataclasses import replace

import numpy as np
import pytest

import dalembert as da
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.integrators.contact.approach import CLOSING, Approach
from dalembert.integrators.contact.contact_laws import ContactLaws
from dalembert.integrators.contact.contacts import Contacts

H, COUNT, STEP, G = 1e-3, 400, 1e-6, 9.81
"""Step [s], number of contacts, relative difference [-], gravity [m/s²]."""


def approaches(seed: int) -> Approach:
    """Contacts without friction that rest, approach, separate or turn past each other, each with
    bodies of its own."""
    rng = np.random.default_rng(seed)
    gap = np.where(rng.random(COUNT) < 0.3, 0.0, 10.0 ** rng.uniform(-9, -3, COUNT))
    before = rng.choice([-1.0, 1.0], COUNT) * 10.0 ** rng.uniform(-6, 1, COUNT)
    change = -rng.uniform(0.0, 0.02, COUNT)
    turning = np.where(rng.random(COUNT) < 0.5, 0.0, 10.0 ** rng.uniform(-6, -1, COUNT))
    zero, none = np.zeros(COUNT), np.zeros((COUNT, 0))
    newton = np.full(COUNT, ImpactLaw.NEWTON.number)
    restitution = np.where(
        rng.random(COUNT) < 0.3, rng.choice([0.0, 1.0], COUNT), rng.random(COUNT)
    )
    laws = ContactLaws(restitution, zero, newton, zero, none, zero.astype(int))
    places = np.eye(COUNT), zero[:, None], laws, (), np.arange(COUNT), np.zeros(COUNT, dtype=int)
    contacts = Contacts(gap, *places, turning=turning[:, None])
    speeds = before[:, None], (before + change + turning)[:, None]
    return Approach(contacts, *speeds, H, H * rng.choice([1, 3, 8]))


def moved(approach: Approach, gap: float, speed: float) -> Approach:
    """Gaps and speeds at the start with relative changes; forces change the speeds alike."""
    more = speed * np.abs(approach.before)
    contacts = replace(approach.contacts, distance=approach.contacts.distance * (1 + gap))
    return replace(
        approach, contacts=contacts, before=approach.before + more, free=approach.free + more
    )


def terms(approach: Approach, offsets: np.ndarray) -> np.ndarray:
    """(n,) size of the terms of offsets, whose differences these are [m/s]."""
    sizes = np.abs(offsets) + np.abs(approach.before[:, 0])
    return np.asarray(sizes + approach.contacts.distance / H / 16)


@pytest.mark.parametrize("seed", range(5))
def test_offsets_of_the_first_conditions_have_derivatives(seed: int) -> None:
    """All branches occur; contacts at which the branch changes with the difference are left out."""
    scheme, approach = da.AnticipatedImpacts(), approaches(seed)
    slopes = scheme.slopes(approach, scheme.first(approach), 1e-12)
    gap, speed = approach.contacts.distance, np.abs(approach.before[:, 0])
    passing = (scheme.first(approach)[:, 0] > approach.before[:, 0]) & (approach.before[:, 0] > 0)
    assert passing.any()
    for name, size, change in (("gap", gap, (STEP, 0.0)), ("speed", speed, (0.0, STEP))):
        first, second, double = (
            scheme.first(moved(approach, *(k * part for part in change)))[:, 0] for k in (-1, 1, 2)
        )
        start = scheme.first(approach)[:, 0]
        linear = np.abs(double - 2 * second + start) <= 1e-9 * (np.abs(start) + size * STEP)
        linear &= (size > 0) & (np.abs(start - first - (second - start)) <= 1e-6 * STEP * speed)
        assert linear.sum() > COUNT / 2
        expected = (second - first)[linear] / (2 * STEP * size[linear])
        rounding = 1e-14 * terms(approach, start)[linear] / (STEP * size[linear])
        error = np.abs(getattr(slopes, name)[linear] - expected)
        assert (error <= 1e-8 * np.abs(expected) + rounding).all()


def pressed(approach: Approach) -> np.ndarray:
    """(n,) normal offsets of contacts that press, whose first conditions permit any approach."""
    apart = np.full((COUNT, 1), 1e3)
    changed = da.AnticipatedImpacts().again(approach, apart, np.ones_like(apart), -apart)
    assert changed is not None
    return changed[:, 0]


@pytest.mark.parametrize("seed", range(3))
def test_offsets_of_pressed_contacts_have_derivatives(seed: int) -> None:
    """Among them those that part, and reverse by the share ``e`` of their speed."""
    approach = replace(approaches(seed), rounding=0.0)
    start, before = pressed(approach), approach.before[:, 0]
    slopes = da.AnticipatedImpacts().slopes(approach, start[:, None], 1e-12)
    gap, speed, e = approach.contacts.distance, np.abs(before), approach.contacts.laws.restitution

    def with_restitution(change: float) -> Approach:
        laws = replace(approach.contacts.laws, restitution=e * (1 + change))
        return replace(approach, contacts=replace(approach.contacts, laws=laws))

    ways = {
        "gap": (gap, lambda k: moved(approach, k, 0.0)),
        "speed": (speed, lambda k: moved(approach, 0.0, k)),
        "restitution": (e, with_restitution),
    }
    parting = (before > 0) & (start > 0)
    slow = (before < 0) & (-before * H < CLOSING * gap)
    for name, (size, way) in ways.items():
        first, second, double = (pressed(way(k * STEP)) for k in (-1, 1, 2))
        linear = np.abs(double - 2 * second + start) <= 1e-9 * (np.abs(start) + size * STEP)
        linear &= (size > 0) & (np.abs(start - first - (second - start)) <= 1e-6 * STEP * speed)
        assert (linear & parting).sum() > 20 and (linear & slow).sum() > 10
        expected = (second - first)[linear] / (2 * STEP * size[linear])
        rounding = 1e-14 * terms(approach, start)[linear] / (STEP * size[linear])
        error = np.abs(getattr(slopes, name)[linear] - expected)
        assert (error <= 1e-8 * np.abs(expected) + rounding).all()


@pytest.mark.parametrize("before", [-1e-12, 0.0, 1e-12])
def test_offsets_of_an_overlap_by_rounding_converge(before: float) -> None:
    """A body at rest whose gap is closed by rounding: the impulse that opens it does some work."""
    approach = approaches(0)
    contacts = replace(approach.contacts, distance=np.full(COUNT, -2e-13))
    speeds = np.full((2, COUNT, 1), before) - [[[0.0]], [[G * H]]]
    approach = Approach(contacts, *speeds, H, H)
    scheme, rounds, last = da.AnticipatedImpacts(), 0, None
    offsets = scheme.first(approach)
    while not np.array_equal(offsets, last):
        last, rounds = offsets, rounds + 1
        after = np.maximum(approach.free, -offsets)
        offsets = scheme.again(approach, offsets, after - approach.free, after)
        assert rounds < 4
    assert contacts.distance + H * (-last[:, 0] + before) / 2 == pytest.approx(0.0, abs=1e-20)
