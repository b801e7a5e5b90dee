"""Bodies of contact forces: weights of stacks, one order of each pair, and places far away."""

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial

G = 10.0


@pytest.fixture(scope="module")
def stack() -> da.Motion:
    """Three boxes of unequal masses, the upper ones shifted, listed before the floor."""
    system, shapes = da.System("stack", gravity=(0.0, -G)), []
    for k in range(3):
        box = planar.Body(f"b{k}", mass=1.0 + k, inertia=0.01, position=(0.01 * k, 0.1 + 0.2 * k))
        shapes.insert(0, planar.contact.Rectangle(system.add(box), (0.3, 0.2)))
    shapes.append(planar.contact.HalfPlane(system.ground))
    system.add(planar.Collisions("stack", shapes, friction=0.5))
    return da.solve_nonsmooth(system.build(), 0.05, step=5e-3)


def test_every_box_carries_those_above(stack):
    contacts = stack.contact_forces(0.05)
    assert contacts.between("ground", "b0") == pytest.approx([0.0, 6 * G], abs=1e-5)
    assert contacts.between("b0", "b1") == pytest.approx([0.0, 5 * G], abs=1e-5)
    assert contacts.between("b2", "b1") == pytest.approx([0.0, -3 * G], abs=1e-5)
    assert (contacts.between("b0", "b2") == 0).all()


def test_corners_of_a_pair_have_one_order_of_bodies(stack):
    contacts = stack.contact_forces(0.05)
    pairs = {tuple(pair) for pair in contacts.bodies.tolist()}
    assert pairs == {("ground", "b0"), ("b1", "b0"), ("b2", "b1")}
    up = np.where((contacts.bodies[:, 0] == "ground"), 1.0, -1.0)
    assert (up * contacts.forces[:, 1] > 0).all()


def test_shapes_of_all_kinds_name_their_bodies():
    """A ball on a box on a floor in space, and a disc in a groove of a profile."""
    system = da.System("tower", gravity=(0.0, 0.0, -G))
    inertia = (0.01, 0.01, 0.01)
    box = system.add(spatial.Body("box", mass=2.0, inertia=inertia, position=(0, 0, 0.1)))
    ball = system.add(spatial.Body("ball", mass=1.0, inertia=inertia, position=(0, 0, 0.3)))
    shapes = [
        spatial.contact.Sphere(ball, 0.1),
        spatial.contact.HalfSpace(system.ground.frame()),
        spatial.contact.Box(box, (0.2, 0.2, 0.2)),
    ]
    system.add(spatial.Collisions("tower", shapes))
    contacts = da.solve_nonsmooth(system.build(), 0.02, step=5e-3).contact_forces(0.02)
    assert contacts.between("ground", "box")[2] == pytest.approx(3 * G, abs=1e-5)
    assert contacts.between("box", "ball")[2] == pytest.approx(G, abs=1e-5)

    system, u = da.System("groove", gravity=(0.0, -G)), da.curves.u
    disc = system.add(planar.Body("disc", mass=2.0, inertia=0.1, position=(0.0, 0.4225)))
    valley = da.FormulaCurve(-u, 4 * u**2, -0.5, 0.5, closed=False)
    shapes = [planar.contact.Circle(disc, 0.3), planar.contact.Profile(system.ground, valley)]
    system.add(planar.Collisions("sides", shapes))
    contacts = da.solve_nonsmooth(system.build(), 0.05, step=2e-3).contact_forces(0.05)
    assert contacts.bodies.tolist() == [["ground", "disc"], ["ground", "disc"]]
    assert contacts.between("ground", "disc") == pytest.approx([0.0, 2 * G], abs=1e-5)


def test_an_instant_is_a_number_within_the_run(stack):
    with pytest.raises(da.AnalysisError, match=r"nan; give a number from 0 to 0.05"):
        stack.contact_forces(float("nan"))
    with pytest.raises(da.AnalysisError, match=r"7 s; give a number from 0 to 0.05"):
        stack.contact_forces(7.0)


@pytest.mark.parametrize("place", [1e4, 1e6, 1e8])
def test_discs_far_from_the_origin_fall_as_others_do(place):
    """Their inertia is small beside the square of their distance, and not zero."""
    heights = []
    for x in (0.0, place):
        system = da.System("disc", gravity=(0, -9.81))
        disc = system.add(planar.Body("disc", mass=1.0, inertia=0.005, position=(x, 0.3)))
        shapes = [planar.contact.HalfPlane(system.ground), planar.contact.Circle(disc, 0.1)]
        system.add(planar.Collisions("floor", shapes, friction=0.3, restitution=0.5))
        motion = da.solve_nonsmooth(system.build(), 0.5, step=1e-3)
        assert motion.status.success
        heights.append(motion["disc.y"].values)
    np.testing.assert_allclose(heights[1], heights[0], rtol=0, atol=1e-9)
