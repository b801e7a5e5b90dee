"""Shapes without extent, and starts at which contacts have no direction, are errors that say so."""

import pytest

import dalembert as da
from dalembert import planar, spatial


def plane(corners) -> da.System:
    system = da.System("plane", gravity=(0.0, -9.81))
    body = system.add(planar.Body("body", mass=1.0, inertia=0.01, position=(0.0, 0.1)))
    shapes = [planar.contact.Polygon(body, corners), planar.contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("touch", shapes))
    return system


@pytest.mark.parametrize(
    ("corners", "message"),
    [
        ([(0, 0), (1, 0), (2, 0)], r"shapes\[0\].*enclose no area"),
        ([(0, 0), (1, 0), (1, 0), (0, 1)], r"shapes\[0\].*coincide"),
    ],
)
def test_polygons_have_an_area_and_distinct_corners(corners, message):
    with pytest.raises(da.ModelError, match=message):
        plane(corners).build()


def test_slender_polygons_are_accepted():
    plane([(0, 0), (1, 0), (1, 1e-6), (0, 1e-6)]).build()


def test_cylinders_have_a_length():
    system = da.System("space", gravity=(0.0, 0.0, -9.81))
    body = system.add(spatial.Body("body", mass=1.0, inertia=(0.01, 0.01, 0.01)))
    ends = body.point(0, 0, 0), body.point(0, 0, 0)
    shapes = [spatial.contact.Cylinder(*ends, 0.1), spatial.contact.HalfSpace(system.ground)]
    system.add(spatial.Collisions("touch", shapes))
    with pytest.raises(da.ModelError, match=r"shapes\[0\].*length is 0"):
        system.build()


def test_a_capsule_without_length_is_a_ball():
    """The penetration of a ball at rest, ``m g/k``."""
    system = da.System("ball", gravity=(0.0, -10.0))
    body = system.add(planar.Body("body", mass=1.0, inertia=0.01, position=(0.0, 0.0995)))
    ball = planar.contact.Capsule(body.center, body.center, 0.1)
    base = planar.contact.Circle(system.ground.point(0, -1), 1.0)
    law = planar.contact.KelvinVoigt(stiffness=1e4)
    system.add(planar.Contact("touch", ball, base, law=law))
    rest = da.solve_equilibrium(system.build())
    assert rest["touch.penetration"].item() == pytest.approx(1e-3, rel=1e-9)


@pytest.mark.parametrize("dimension", [2, 3])
def test_concentric_balls_are_an_error(dimension):
    space = planar if dimension == 2 else spatial
    system, shapes = da.System("nested"), []
    for name, radius in (("outer", 0.1), ("inner", 0.05)):
        body = space.Particle(name, mass=1.0, position=(0.0, 0.1, 0.0)[:dimension])
        ball = space.contact.Circle if dimension == 2 else space.contact.Sphere
        shapes.append(ball(system.add(body).center, radius))
    system.add(space.Collisions("touch", shapes))
    with pytest.raises(da.AnalysisError, match="touch: outer and inner have the same centre"):
        da.solve_nonsmooth(system.build(), 0.01, step=1e-3)


def test_a_disc_larger_than_its_bore_names_the_overlap():
    system = da.System("journal", gravity=(0.0, -9.81))
    body = system.add(planar.Body("body", mass=1.0, inertia=0.01, position=(0.01, 0.0)))
    bore = planar.contact.Bore(system.ground.point(0, 0), 0.05)
    system.add(planar.Collisions("touch", [planar.contact.Circle(body, 0.1), bore]))
    with pytest.raises(da.AnalysisError, match=r"touch: body and a fixed shape overlap by 0\.06 m"):
        da.solve_nonsmooth(system.build(), 0.01, step=1e-3)


def test_a_disc_in_the_middle_of_a_smaller_bore_names_both_radii():
    system = da.System("journal", gravity=(0.0, -9.81))
    body = system.add(planar.Body("body", mass=1.0, inertia=0.01, position=(0.0, 0.0)))
    bore = planar.contact.Bore(system.ground.point(0, 0), 0.05)
    system.add(planar.Collisions("touch", [planar.contact.Circle(body, 0.1), bore]))
    with pytest.raises(da.AnalysisError, match=r"touch: .*body.* 0\.1 m .*ground.* 0\.05 m"):
        da.solve_nonsmooth(system.build(), 0.01, step=1e-3)


def test_a_disc_passes_a_smaller_bore_of_a_group_that_it_does_not_touch():
    system, contact = da.System("journal", gravity=(0.0, -9.81)), planar.contact
    body = system.add(planar.Body("body", mass=1.0, inertia=0.01, position=(0.0, 0.0)))
    bore, floor = contact.Bore(system.ground.point(0, 0), 0.05), system.ground.point(0, -0.1)
    groups = {"disc": [contact.Circle(body, 0.1)], "bore": [bore]}
    groups |= {"floor": [contact.HalfPlane(floor)]}
    system.add(
        planar.Collisions("touch", groups, pairs=[contact.Pair(("disc", "bore"), touching=False)])
    )
    assert da.solve_nonsmooth(system.build(), 0.01, step=1e-3).status.success


@pytest.mark.parametrize(
    "wall",
    [
        lambda ground: planar.contact.HalfPlane(ground.point(0.5 * da.t, 0.0)),
        lambda ground: planar.contact.Circle(ground.point(0, -1 - 0.1 * da.t), 1.0),
    ],
)
def test_walls_move_with_bodies_only(wall):
    """A place in a body that depends on time has no velocity there: the gap ignored its motion."""
    system = da.System("belt", gravity=(0.0, -9.81))
    disc = system.add(planar.Body("disc", mass=1.0, inertia=0.01, position=(0.0, 0.1)))
    shapes = [planar.contact.Circle(disc, 0.1), wall(system.ground)]
    system.add(planar.Collisions("floor", shapes, friction=0.3))
    with pytest.raises(da.AnalysisError, match=r"floor.shapes\[1\].*ground.*driver"):
        da.solve_nonsmooth(system.build(), 0.01, step=1e-3)


def test_frames_turn_with_bodies_only():
    system = da.System("ramp", gravity=(0.0, 0.0, -9.81))
    ball = system.add(spatial.Particle("ball", mass=1.0, position=(0.0, 0.0, 0.1)))
    ramp = spatial.contact.HalfSpace(system.ground.frame(axis=(da.sin(da.t), 0.0, 1.0)))
    system.add(spatial.Collisions("ramp", [spatial.contact.Sphere(ball.center, 0.1), ramp]))
    with pytest.raises(da.AnalysisError, match=r"ramp.shapes\[1\].*depends on the time"):
        da.solve_nonsmooth(system.build(), 0.01, step=1e-3)
