"""Starts that overlap by rounded published numbers run as those that touch; others end."""

from __future__ import annotations

import re

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.errors import AnalysisError

kit, solid = planar.contact, spatial.contact
R = 0.1
INSIDE = 1e-6


def ball(kind: str, inside: float, speed: float = 0.0) -> da.System:
    """A ball of 0.1 m on the floor, ``inside`` deep, whose height is the parameter h."""
    space = kind.partition(" ")[0]
    there, up = (0.5,) if space == "planar" else (0.5, 0.0), (0.0, -9.81)
    system = da.System(kind, gravity=up if space == "planar" else (0.0, *up))
    h = system.parameter("h", R - inside, "m")
    go = (0.0,) * len(there)
    if space == "planar":
        body = planar.Body("b", mass=1.0, inertia=0.01, position=(*there, h), velocity=(*go, speed))
        shapes = kit.HalfPlane(system.ground.center), kit.Circle(body.center, R)
    else:
        place = (*there, h)
        body = spatial.Sphere("b", radius=R, mass=1.0, position=place, velocity=(*go, speed))
        shapes = solid.HalfSpace(system.ground.frame()), solid.Sphere(body.center, R)
    system.add(body)
    module = planar if space == "planar" else spatial
    if kind.endswith("gap"):
        height = body.y if space == "planar" else body.z
        system.add(module.UnilateralConstraint("floor", height - R, restitution=0.5))
    else:
        law = kit.Restitution(0.5) if kind.endswith("rigid") else kit.Hertz(stiffness=1e7)
        system.add(module.Contact("floor", *shapes, law=law))
    return system


RIGID = ["planar gap", "spatial gap", "planar rigid", "spatial rigid"]


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", RIGID)
@pytest.mark.parametrize("speed", [0.0, -1.0, 1.0, -1e-5])
def test_a_rounded_start_is_the_touching_one(kind: str, speed: float) -> None:
    """Same motion as of the ball that touches; the height is no more a freedom of the start."""
    exact, rounded = (
        da.solve_dynamics(ball(kind, inside, speed).build(), 0.3, step=0.01)
        for inside in (0.0, INSIDE)
    )
    assert exact.status.success and rounded.status.success and not rounded.warnings
    name = "b.y" if kind.startswith("planar") else "b.z"
    np.testing.assert_allclose(rounded[name].values, exact[name].values, atol=1e-9)
    assert len(rounded.impacts) == len(exact.impacts)
    removed = rounded.statistics["initial overlaps removed"]
    assert removed.startswith("floor by 1e-06 m") and removed not in exact.statistics.values()
    for method in ("direct", "adjoint"):
        slope = da.sensitivity(rounded, da.final(name), method=method).item()
        assert slope == pytest.approx(0.0, abs=1e-9)


def test_beyond_the_tolerance_and_prescribed_starts_are_refused() -> None:
    with pytest.raises(da.AnalysisError, match=r"floor: its gap is -0\.001 m at the start.*apart"):
        da.solve_dynamics(ball("planar rigid", 1e-3).build(), 0.1, step=0.01)
    system = ball("planar gap", INSIDE)
    system.initial(system.elements["b"].y, R - INSIDE)
    with pytest.raises(da.AnalysisError, match="floor: its gap is -1e-06 m at the start"):
        da.solve_dynamics(system.build(), 0.1, step=0.01)


@pytest.mark.parametrize("kind", ["planar soft", "spatial soft"])
def test_compliant_contact_presses_by_the_overlap(kind: str) -> None:
    motion = da.solve_dynamics(ball(kind, INSIDE).build(), 0.01, integrator=da.DormandPrince())
    assert motion.status.success
    assert motion["floor.force"].values[0] == pytest.approx(1e7 * INSIDE**1.5, rel=1e-6)


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", ["planar rigid", "spatial gap", "planar collisions"])
def test_nonsmooth_contact_takes_a_rounded_start(kind: str) -> None:
    speed = -1.0 if kind.endswith("collisions") else 0.0  # else its weight is all that does work
    system = ball(kind, INSIDE, speed)
    if kind.endswith("collisions"):
        del system.elements["floor"]
        balls, walls = (
            [planar.contact.Circle(system.elements["b"], R)],
            [planar.contact.HalfPlane(system.ground.center, (0.0, 1.0))],
        )
        system.add(planar.Collisions("floor", [*balls, *walls], restitution=0.5))
    motion = da.solve_nonsmooth(system.build(), 0.1, step=1e-3)
    name = "b.z" if kind.startswith("spatial") else "b.y"
    assert motion.status.success
    assert motion[name].values.min() > R - 2 * INSIDE
    assert motion[name].values.max() < R + (2 * INSIDE if speed == 0 else 0.05)


@pytest.mark.parametrize("depth", [1e-6, 1e-5])
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_a_stack_at_rest_takes_a_rounded_start(scheme, depth: float) -> None:
    """The work that removes the overlaps is no error of the energy, though nothing else moves."""
    system, shapes = da.System("stack", gravity=(0.0, -9.81)), []
    for k in range(3):
        place = (0.0, 0.1 + (0.2 - depth) * k)
        box = system.add(planar.Body(f"box{k}", mass=1.0, inertia=0.01, position=place))
        shapes.append(planar.contact.Rectangle(box, (0.3, 0.2)))
    floor = planar.contact.HalfPlane(system.ground.center)
    system.add(planar.Collisions("contacts", [*shapes, floor], friction=0.5))
    motion = da.solve_nonsmooth(system.build(), 0.1, step=2e-3, integrator=scheme)
    assert motion.status.success and not motion.warnings
    assert motion["box2.y"].values[-1] == pytest.approx(0.5, abs=1e-7)
    assert not (motion.data["penetration"].values[1:] > 1e-9).any()


@pytest.mark.product
@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("gap", [0.0, 1e-9, 1e-5])
def test_an_impact_at_the_start_bounces_by_its_restitution(restitution: float, gap: float) -> None:
    """Before the first step there is none that could slow down what touches already."""
    system = da.System("start", gravity=(0.0, -9.81))
    body = system.add(planar.Particle("b", mass=1.0, position=(0.5, R + gap), velocity=(0.0, -1.0)))
    walls = [planar.contact.HalfPlane(system.ground.center, (0.0, 1.0))]
    system.add(
        planar.Collisions(
            "floor", [planar.contact.Circle(body, R), *walls], restitution=restitution
        )
    )
    motion = da.solve_nonsmooth(system.build(), 0.01, step=1e-4)
    assert motion.status.success
    assert motion["b.vy"].values[1] == pytest.approx(restitution, abs=1e-3)
    assert motion["b.y"].values.min() > R - 1e-9


def test_the_removal_of_rounded_overlaps_among_shapes_is_recorded() -> None:
    system = da.System("disc", gravity=(0.0, -9.81))
    disc = system.add(planar.Body("disc", mass=1.0, inertia=0.005, position=(0.0, R - INSIDE)))
    system.add(planar.Collisions("c", [kit.Circle(disc, R), kit.HalfPlane(system.ground)]))
    run = da.solve_nonsmooth(system.build(), 0.1, step=1e-2)
    assert run.statistics["initial overlaps removed"] == "up to 1e-06 m"
    assert run["disc.y"].values[-1] == pytest.approx(R, abs=1e-12)


CROSSED = {
    "two ellipses": ("ellipse", "ellipse", (0.2, 0.1, 1.4)),
    "a plus": ("beam", "outline", (0.0, 0.0, np.pi / 2)),
}


@pytest.mark.parametrize("case", CROSSED.values(), ids=list(CROSSED))
def test_shapes_that_cross_at_the_start_are_refused(case):
    """No local minimum of the distance of two crossing boundaries is negative."""
    system, (first, second, (x, y, angle)) = da.System("crossed"), case
    still = system.add(planar.Body("still", mass=1.0, inertia=1.0))
    place = {"position": (x, y), "angle": angle}
    moved = system.add(planar.Body("moved", mass=1.0, inertia=1.0, **place))
    u = da.curves.u
    curve = da.FormulaCurve(da.cos(u), 0.3 * da.sin(u), 0, 2 * np.pi, closed=True)
    plate = [(-1, -0.1), (1, -0.1), (1, 0.1), (-1, 0.1)]
    shapes = {
        "ellipse": lambda body: kit.Profile(body, curve),
        "outline": lambda body: kit.Outline(body, plate),
        "beam": lambda body: kit.Rectangle(body, (2.0, 0.2)),
    }
    both = [shapes[first](moved), shapes[second](still)]
    system.add(planar.Collisions("touch", both))
    with pytest.raises(AnalysisError, match=r"overlap by .* at the start"):
        da.solve_nonsmooth(system.build(), 0.01, step=1e-3)


def solids_at(first: str, second: str, turn: float, place: tuple[float, ...]) -> da.Model:
    """Two solids: the first at the origin, the second at a place and turned about x."""
    system = da.System("pierced", gravity=(0.0, 0.0, 0.0))
    start = {"position": place, "rotation": da.rotation.axis_angle((1.0, 0.0, 0.0), turn)}
    still = system.add(spatial.Body("still", mass=1.0, inertia=(1.0, 1.0, 1.0)))
    moved = system.add(spatial.Body("moved", mass=1.0, inertia=(1.0, 1.0, 1.0), **start))
    corners = [(1.0, 1.0, -0.5), (-1.0, 1.0, -0.5), (0.0, -1.0, -0.5), (0.0, 0.0, 1.0)]
    ridge = np.zeros((17, 17))
    ridge[8] = 2.0

    def ends(body: spatial.Body, half: float) -> tuple:
        return body.point(0, 0, -half), body.point(0, 0, half)

    kinds = {
        "coin": lambda body: solid.Cylinder(*ends(body, 0.05), 0.6),
        "drum": lambda body: solid.Cylinder(*ends(body, 1.0), 0.6),
        "capsule": lambda body: solid.Capsule(*ends(body, 1.0), 0.3),
        "box": lambda body: solid.Box(body.point(0, 0, 0), (1.0, 0.7, 0.4)),
        "polyhedron": lambda body: solid.Polyhedron(body, corners),
        "ridge": lambda _: solid.HeightField(system.ground.frame(), (8.0, 8.0), ridge),
    }
    system.add(spatial.Collisions("touch", [kinds[first](still), kinds[second](moved)]))
    return system.build()


PIERCED = {
    "a coin by a box": ("box", "coin", 0.7, (0.0, 0.2, 0.1), 0.379),
    "a coin by a capsule": ("coin", "capsule", 0.3, (0.2, 0.1, 0.1), 0.664),
    "a coin by a polyhedron": ("coin", "polyhedron", 0.3, (0.2, 0.6, 0.6), 0.227),
    "a ridge by a drum": ("ridge", "drum", 0.7, (0.2, 0.1, 1.0), 0.55),
    "a ridge by a coin": ("ridge", "coin", 0.0, (0.0, 0.1, 1.0), 0.255),
}
"""Shapes, turn about x and place of the second one, and the depth of the overlap: least width along
100,000 directions; of the ridge, distance from the surface."""


@pytest.mark.parametrize("case", PIERCED.values(), ids=list(PIERCED))
def test_solids_that_pierce_each_other_at_the_start_are_refused(case):
    """The features of cylinders may all be apart where a body pierces them deeply."""
    *scene, depth = case
    with pytest.raises(AnalysisError, match=r"moved overlap by .* or more at the start") as error:
        da.solve_nonsmooth(solids_at(*scene), 2e-3, step=1e-3)
    stated = float(re.search(r"by (\S+) m", str(error.value))[1])
    assert stated == pytest.approx(depth, rel=0.05)
