"""Bodies that stand exactly aligned with their support tip over their own edges.

Faces are level, and corners are on edges of the support to the last digit, so that many pairs of
features are equally near. Contacts beside the body would hold it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.elements.contact.shapes import Shape

contact = spatial.contact
G, MASS, INERTIA, FRICTION = 9.81, 1.0, 2e-3, 3.0

Maker = Callable[[spatial.Body], Shape]


def pyramid(body: spatial.Body) -> Shape:
    base = [(x, y, -0.05) for x in (-0.1, 0.1) for y in (-0.1, 0.1)]
    return contact.Polyhedron(body, [*base, (0, 0, 0.1)])


def prism(body: spatial.Body) -> Shape:
    angles = np.arange(6) * np.pi / 3
    rings = [(0.1 * np.cos(a), 0.1 * np.sin(a), z) for a in angles for z in (-0.05, 0.05)]
    return contact.Polyhedron(body, rings)


def box(x: float, y: float) -> Maker:
    return lambda body: contact.Box(body.center, (x, y, 0.1))


def bar(ground: spatial.Body) -> Shape:
    return contact.Box(ground.point(0, 0, -0.1), (0.1, 1.0, 0.2))


def rail(ground: spatial.Body) -> Shape:
    return contact.Capsule(ground.point(-0.5, 0, -0.1), ground.point(0.5, 0, -0.1), 0.1)


def drum(ground: spatial.Body) -> Shape:
    return contact.Cylinder(ground.point(0, 0, -0.2), ground.point(0, 0, 0), 0.3)


CASES = {  # shape, yaw, support, direction of the load, distance of the edge from the middle
    "box on a bar of its width": (box(0.1, 0.2), 0.0, bar, (0, -1), 0.1),
    "turned box on such a bar": (box(0.2, 0.1), np.pi / 2, bar, (0, -1), 0.1),
    "pyramid along its diagonal on a rail": (pyramid, np.pi / 4, rail, (-1, 0), 0.1 * np.sqrt(2)),
    "prism with two corners on a rail": (prism, 0.0, rail, (-1, 0), 0.1),
    "box on the end of a wide drum": (box(0.2, 0.1), 0.0, drum, (1, 0), 0.1),
}


@pytest.mark.few(2)
@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("integrator", [da.AnticipatedImpacts(), da.MoreauJean()])
@pytest.mark.parametrize("case", CASES)
def test_aligned_bodies_tip_over_their_edge(case, integrator, swapped):
    """Speed by the energy of the body and a load beyond the edge, twice as heavy."""
    make, yaw, support, (x, y), edge = CASES[case]
    system = da.System("tipping", gravity=(0.0, 0.0, -G))
    turned = da.rotation.axis_angle((0, 0, 1), yaw)
    place = {"position": (0, 0, 0.05), "rotation": turned}
    body = system.add(spatial.Body("b", mass=MASS, inertia=(INERTIA,) * 3, **place))
    beyond, c, s = edge + 0.2, np.cos(yaw), np.sin(yaw)
    load = body.point(beyond * (c * x + s * y), beyond * (c * y - s * x), 0.0)
    system.add(spatial.Force("load", load, (0.0, 0.0, -2 * MASS * G)))
    shapes = [make(body), support(system.ground)]
    shapes = shapes[::-1] if swapped else shapes
    system.add(spatial.Collisions("c", shapes, friction=FRICTION))
    motion = da.solve_nonsmooth(system.build(), 0.05, step=5e-4, integrator=integrator)
    assert motion.status.success
    height = 0.05
    angle = np.arcsin(float(motion["b.z"][-1]) / np.hypot(edge, height)) - np.arctan2(height, edge)
    work = MASS * G * (height * (1 - np.cos(angle)) - edge * np.sin(angle))
    work += 2 * MASS * G * (height * (1 - np.cos(angle)) + 0.2 * np.sin(angle))
    speed = np.sqrt(2 * work / (INERTIA + MASS * (edge**2 + height**2)))
    assert angle > 0.05
    assert np.linalg.norm(motion["b.angular_velocity"][-1]) == pytest.approx(speed, rel=0.01)


@pytest.mark.parametrize("integrator", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_corners_on_straight_sides_do_not_matter(integrator):
    """A box on a polygon with a corner in the middle of its top tips as on a rectangle."""

    def tipped(shape: Callable[[planar.Body], Shape]) -> float:
        system = da.System("tipping", gravity=(0.0, -G))
        place = {"position": (0, 0.05), "angle": 0.0}
        body = system.add(planar.Body("b", mass=MASS, inertia=INERTIA, **place))
        system.add(planar.Force("load", body.point(-0.3, 0), (0.0, -2 * MASS * G)))
        shapes = [planar.contact.Rectangle(body.center, (0.2, 0.1)), shape(system.ground)]
        system.add(planar.Collisions("c", shapes, friction=FRICTION))
        motion = da.solve_nonsmooth(system.build(), 0.05, step=1e-3, integrator=integrator)
        assert motion.status.success
        return float(motion["b.angular_velocity"][-1])

    ends = [(-0.3, -0.2), (0.3, -0.2), (0.3, 0.0), (0.0, 0.0), (-0.3, 0.0)]
    polygon = tipped(lambda ground: planar.contact.Polygon(ground, ends))
    middle = tipped(lambda ground: planar.contact.Rectangle(ground.point(0, -0.1), (0.6, 0.2)))
    assert polygon == pytest.approx(middle, rel=1e-12)
