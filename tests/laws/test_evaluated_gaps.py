"""Gaps and impacts of many steps that are evaluated together are those of each step."""

from __future__ import annotations

import functools

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.sensitivity.nonsmooth.contact_steps import ContactSteps
from dalembert.sensitivity.nonsmooth.near_impacts import impacts_one_by_one
from dalembert.sensitivity.nonsmooth.source_slopes import StepState
from dalembert.sensitivity.nonsmooth.stacked_approach import impacts_of_free_bodies


def discs(friction: float) -> da.System:
    """Discs that fall on each other between walls."""
    system, shape = da.System("discs", gravity=(0.0, -9.81)), planar.contact
    radius, shapes = system.parameter("radius", 0.1, "m"), []
    for k in range(7):
        place = 0.22 * (k % 3) + 0.01 * k, 0.12 + 0.23 * (k // 3)
        start = {"position": place, "velocity": (0.3 * (-1) ** k, 0.0)}
        body = planar.Body(f"disc{k}", mass=1.0 + 0.1 * k, inertia=0.005, **start)
        shapes.append(shape.Circle(system.add(body), radius))
    for x, normal in ((0.0, (0.0, 1.0)), (-0.12, (1.0, 0.0)), (0.62, (-1.0, 0.0))):
        shapes.append(shape.HalfPlane(system.ground.point(x, 0.0), normal))
    system.add(planar.Collisions("all", shapes, friction=friction, restitution=0.4))
    return system


def boxes() -> da.System:
    """Two boxes and a ball that fall on a floor."""
    system, shape = da.System("boxes", gravity=(0.0, 0.0, -9.81)), spatial.contact
    size, shapes = system.parameter("size", 0.2, "m"), [shape.HalfSpace(system.ground.frame())]
    for k in range(3):
        start = {"position": (0.03 * k, 0.0, 0.11 + 0.21 * k), "rotation": np.eye(3)}
        body = spatial.Body(f"body{k}", mass=1.0, inertia=(0.01, 0.01, 0.01), **start)
        own = system.add(body)
        shapes.append(
            shape.Sphere(own, size / 2) if k == 2 else shape.Box(own.center, (size, size, size))
        )
    system.add(spatial.Collisions("all", shapes, friction=0.3, restitution=0.2))
    return system


SCENES = {
    "discs": functools.partial(discs, 0.3),
    "smooth discs": functools.partial(discs, 0.0),
    "boxes": boxes,
}


@pytest.fixture(params=SCENES)
def steps(request) -> ContactSteps:
    scheme = da.MoreauJean(theta=0.5)
    model = SCENES[request.param]().build()
    return ContactSteps(da.solve_nonsmooth(model, 0.2, step=2e-3, integrator=scheme))


@pytest.mark.few(1)
def test_gaps_without_derivatives(steps):
    """Distances, velocities, laws and directions are those with derivatives."""
    maps, contacts, t = steps.maps, steps.contacts, steps.record.t
    assert contacts.owner.size > 50
    y, v = np.split(steps.x, [steps.size])
    lead = maps.lead(np.diff(t)[None])
    state = StepState(t[None, :-1], y[:, :-1], maps.p, v[:, :-1], v[:, 1:], lead=lead)
    active, owner = contacts.all, contacts.owner
    whole = maps.gaps(state, active.keys, active.impulses, owner=owner, kept=active.kept)
    values = maps.values(state, active.keys, owner, active.kept)
    np.testing.assert_allclose(values.directions.toarray(), whole.directions.toarray(), atol=1e-14)
    for name in ("distance", "before", "after", "laws"):
        own, other = getattr(values.values, name), getattr(whole.values, name)
        np.testing.assert_allclose(own, other, atol=1e-13)


@pytest.mark.few(1)
def test_impacts_of_free_bodies(steps):
    """The same groups of gaps close at the same instants as in single steps."""
    contacts = steps.contacts
    numbers = np.unique(contacts.owner[contacts.follows < 0])
    run = steps.maps, steps.record, contacts, numbers
    single, together = list(impacts_one_by_one(*run)), list(impacts_of_free_bodies(*run))
    assert [k for k, _ in together] == [k for k, _ in single] and len(single) > 5
    for (_, own), (_, other) in zip(together, single, strict=True):
        np.testing.assert_array_equal(own.keys, other.keys)
        np.testing.assert_array_equal(own.speeds, other.speeds)
        np.testing.assert_allclose(own.instants, other.instants, rtol=1e-12)
        assert (own.rebounds, own.drives) == (other.rebounds, other.drives)
