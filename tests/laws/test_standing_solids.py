"""Spatial boxes stand and slide; solids of all shapes neither overlap nor gain energy."""

from itertools import pairwise

import numpy as np
import pytest

import dalembert as da
from dalembert import spatial
from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration

G = 9.81
contact = spatial.contact


def stack(count: int, turn: float = 0.0, angle: float = 0.0, friction: float = 0.5) -> da.Model:
    """Boxes on top of each other, each turned about the vertical, with inclined gravity."""
    gravity = (G * np.sin(angle), 0.0, -G * np.cos(angle))
    system = da.System("stack", gravity=gravity)
    shapes, size = [contact.HalfSpace(system.ground.frame())], (0.3, 0.2, 0.2)
    for k in range(count):
        turned = da.rotation.axis_angle((0, 0, 1), turn * k)
        place = (0.0, 0.0, 0.1 + 0.2 * k)
        box = spatial.Box(f"b{k}", size=size, mass=1.0, position=place, rotation=turned)
        shapes.append(contact.Box(system.add(box).center, size))
    system.add(spatial.Collisions("stack", shapes, friction=friction))
    return system.build()


@pytest.mark.parametrize(("count", "turn"), [(1, 0.0), (3, 0.0), (3, 0.4)])
def test_boxes_stand(count, turn):
    """Turned boxes touch at corners and where edges cross."""
    motion = da.solve_nonsmooth(stack(count, turn), 0.2, step=2e-3)
    assert motion.status.success
    assert np.ptp(motion.trajectory.y, axis=1).max() < 1e-10
    carried = motion.impulse("stack").values[-1]
    assert carried == pytest.approx(G * 2e-3 * count * (count + 1) / 2, rel=1e-7)


def test_each_pair_of_edges_is_one_gap():
    """Edges that cross over a face may have the farthest common normal, too."""
    system, count = da.System("crossing"), 4
    shapes = []
    for k, size in enumerate([(0.3, 0.2, 0.2), (0.2, 0.2, 0.2), (0.2, 0.1, 0.3), (0.1, 0.1, 0.1)]):
        body = system.add(spatial.Box(f"b{k}", size=size, mass=1.0, position=(k, 0, 0)))
        shapes.append(contact.Box(body.center, size))
    system.add(spatial.Collisions("touch", shapes))
    model, rng = system.build(), np.random.default_rng(0)
    (source,) = gap_sources(model)
    travels = np.full((model.equations.speed_count, 1), 1e-2)
    for trial in range(200):
        y = np.zeros((count, 7))
        y[:, :2], turned = rng.normal(scale=0.15, size=(count, 2)), rng.uniform(0, np.pi, count)
        y[:, 2] = rng.integers(-2, 3, count) / 10
        y[:, 3], y[:, 6] = np.cos(turned), np.sin(turned)
        y[:, 3:] += rng.normal(scale=1e-4 if trial % 2 else 1.0, size=(count, 4))
        y[:, 3:] /= np.linalg.norm(y[:, 3:], axis=1, keepdims=True)
        configuration = Configuration(0.0, y.ravel(), model.nominal)
        keys = source.near(configuration, travels).key
        assert np.unique(keys).size == keys.size
        places = source.points(configuration, keys)[0]
        i, j = np.triu_indices(keys.size, 1)
        assert (np.linalg.norm(places[i] - places[j], axis=1) > 1e-9).all()


def test_faces_touch_at_the_corners_of_their_common_part():
    """Two equal squares turned by 45° share an octagon."""
    system = da.System("octagon", gravity=(0.0, 0.0, -G))
    shapes = []
    for k in range(2):
        turned = da.rotation.axis_angle((0, 0, 1), k * np.pi / 4)
        box = spatial.Box(
            f"b{k}", size=(0.2, 0.2, 0.2), mass=1.0, position=(0, 0, 0.2 * k), rotation=turned
        )
        shapes.append(contact.Box(system.add(box).center, (0.2, 0.2, 0.2)))
    system.add(spatial.Weld("fixed", system.ground, shapes[0].carrier))
    system.add(spatial.Collisions("touch", shapes))
    model = system.build()
    (source,) = gap_sources(model)
    travels = np.full((model.equations.speed_count, 1), 1e-3)
    gaps = source.near(Configuration(0.0, model.start.y, model.nominal), travels)
    assert gaps.count == 8 and abs(gaps.distance).max() < 1e-12
    places = source.points(Configuration(0.0, model.start.y, model.nominal), gaps.key)[0]
    corners = places[np.argsort(np.arctan2(places[:, 1], places[:, 0]))]
    assert np.linalg.norm(corners[:, :2], axis=1) == pytest.approx(0.1 / np.cos(np.pi / 8))
    sides = [np.linalg.norm(b - a) for a, b in pairwise(corners)]
    assert sides == pytest.approx(7 * [0.2 * np.tan(np.pi / 8)])


@pytest.mark.parametrize("friction", [0.3, 0.6])
def test_box_slides_above_the_angle_of_friction(friction):
    angle = np.pi / 6
    motion = da.solve_nonsmooth(stack(1, 0.0, angle, friction), 0.3, step=2e-3)
    expected = max(0.0, np.sin(angle) - friction * np.cos(angle)) * G * 0.3**2 / 2
    assert motion.values("b0.x")[-1] == pytest.approx(expected, abs=1e-10)


def mixture() -> da.Model:
    """Boxes, capsules and balls that fall between walls."""
    rng, system = np.random.default_rng(3), da.System("mixture", gravity=(0.0, 0.0, -G))
    shapes = [contact.HalfSpace(system.ground.frame())]
    for axis in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)):
        place = tuple(-0.3 * component for component in axis)
        shapes.append(contact.HalfSpace(system.ground.frame(place, axis=axis)))
    for k in range(8):
        body = spatial.Body(
            f"b{k}",
            mass=1.0,
            inertia=(3e-3,) * 3,
            position=(-0.12 + 0.24 * (k % 2), -0.12 + 0.24 * (k // 2 % 2), 0.15 + 0.25 * (k // 4)),
            rotation=da.rotation.axis_angle(tuple(rng.normal(size=3)), 1.0 + k),
            velocity=tuple(rng.normal(size=3)),
            angular_velocity=tuple(3 * rng.normal(size=3)),
        )
        system.add(body)
        kinds = [
            contact.Box(body.center, (0.16, 0.12, 0.1)),
            contact.Capsule(body.point(-0.05, 0, 0), body.point(0.05, 0, 0), 0.05),
            contact.Sphere(body.center, 0.07),
            contact.Box(body.center, (0.1, 0.1, 0.1)),
        ]
        shapes.append(kinds[k % 4])
    system.add(spatial.Collisions("all", shapes, restitution=0.3, friction=0.3))
    return system.build()


def test_solids_neither_overlap_nor_gain_energy():
    motion = da.solve_nonsmooth(mixture(), 0.4, step=2e-3)
    assert motion.status.success
    assert motion.data["penetration"].max() < 1e-9
    energy = motion.data["energy"].values
    assert motion.statistics["maximum energy gained in contacts [J]"] <= 1e-12 * energy[0]
    assert np.diff(energy).max() <= 1e-10 * energy[0]
    assert energy[-1] < 0.5 * energy[0]
