"""Contacts of models with few speeds: arrays in place of sparse matrices, and stored gaps."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy

import dalembert as da
from dalembert import planar
from dalembert.analysis.nonsmooth.gaps import shape_velocities
from dalembert.analysis.nonsmooth.gaps.collision_gaps import CollisionGaps, gap_sources
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.hulls.hull_gaps import HullGaps
from dalembert.analysis.nonsmooth.gaps.joined_gaps import JoinedGaps
from dalembert.integrators.contact.approach import largest_moving, largest_nearby
from dalembert.integrators.contact.contacts import FrictionProblem, among
from dalembert.integrators.contact.delassus import Delassus
from dalembert.integrators.contact.semismooth_newton import semismooth_newton
from dalembert.integrators.contact.sweeps import swept

contact = planar.contact


def jack() -> da.System:
    """A pinned lever with a spring that strikes a block on a floor, and a free disc above it."""
    system = da.System("jack", gravity=(0, -9.81))
    lever = planar.Bar("lever", length=0.4, mass=1.0, position=(0, 0.3), angle=0.2)
    system.add(lever)
    system.add(planar.Revolute("pin", system.ground.point(-0.196, 0.26), lever.start))
    block = system.add(planar.Body("block", mass=2.0, inertia=0.02, position=(0.1, 0.1)))
    disc = system.add(planar.Body("disc", mass=0.5, inertia=1e-3, position=(-0.05, 0.45)))
    tip = contact.Circle(lever.end, 0.02)
    system.add(planar.Spring("spring", disc.center, block.center, stiffness=20.0, free_length=0.4))
    shapes = {
        "lever": [contact.Rectangle(lever, (0.4, 0.02)), tip],
        "block": [contact.Rectangle(block, (0.2, 0.2))],
        "others": [contact.Circle(disc, 0.05), contact.HalfPlane(system.ground.center)],
    }
    system.add(planar.Collisions("touch", shapes, friction=0.3, restitution=0.2))
    return system


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", [da.MoreauJean(), da.AnticipatedImpacts()])
def test_arrays_and_sparse_matrices_give_the_same_motion(scheme, monkeypatch):
    motions = []
    for limit in (100, 0):
        monkeypatch.setattr(shape_velocities, "DENSE", limit)
        model = jack().build()
        e, far = model.equations, np.ones((model.equations.speed_count, 1))
        gaps = gap_sources(model)[0].near(Configuration(0.0, model.start.y, model.nominal), far)
        assert isinstance(gaps.directions, np.ndarray) == (limit > 0)
        assert gaps.count > 3 and gaps.directions.shape == (2 * gaps.count, e.speed_count)
        motions.append(da.solve_nonsmooth(model, 0.2, step=2e-3, integrator=scheme))
    dense, sparse = motions
    assert dense.status.success and np.unique(dense.record.key).size >= 3
    assert np.array_equal(dense.record.key, sparse.record.key)
    assert dense.record.ends.y == pytest.approx(sparse.record.ends.y, abs=1e-9)
    assert dense.record.impulse == pytest.approx(sparse.record.impulse, abs=1e-9)


@pytest.mark.parametrize("groups", [(), (1,), (2,), (2, 2, 1)])
@pytest.mark.parametrize("minimum", [0.0, 0.2])
def test_operators_of_arrays_are_those_of_sparse_matrices(groups, minimum):
    """Products, diagonals, shifts, sweeps and Newton's method."""
    rng, width, count, n = np.random.default_rng(2), 1 + sum(groups), 7, 30
    part = rng.normal(size=(n, n))
    inertia, joints = part @ part.T + 5 * np.eye(n), np.zeros((0, n))
    directions = rng.normal(size=(count * width, n)) * (rng.random((count * width, n)) < 0.4)
    responses = directions @ np.linalg.inv(inertia)
    dense = Delassus(directions, responses, inertia, joints, np.zeros(count * width))
    parts = [scipy.sparse.csr_array(m) for m in (directions, responses, inertia, joints)]
    sparse = Delassus(*parts, np.zeros(count * width))
    assert dense.is_dense and not sparse.is_dense
    shift, some = rng.random(count * width), rng.normal(size=count * width)
    for one, other in ((dense, sparse), (dense.shifted(shift), sparse.shifted(shift))):
        assert one @ some == pytest.approx(other @ some)
        assert one.response(some) == pytest.approx(other.response(some))
        assert one.diagonal() == pytest.approx(other.diagonal())
        assert one.dense == pytest.approx(other.dense)
        for rows, matrix in zip(one.compressed, other.compressed, strict=True):
            again = scipy.sparse.csr_array((rows.data, rows.indices, rows.indptr), rows.shape)
            assert (again != matrix).nnz == 0
    velocity, friction = rng.normal(size=(count, width)), rng.random((count, len(groups)))
    law = {"friction": friction, "groups": groups, "minimum": minimum * rng.random(count)}
    start = np.zeros((count, width))
    solutions = []
    for operator in (dense.shifted(shift), sparse.shifted(shift)):
        problem = FrictionProblem(operator, velocity, **law)
        for _ in range(2):  # with arrays that remain from the first call
            impulses = swept(problem, start, 1e-13)
        assert problem.residual(impulses) < 1e-11
        solutions += [impulses, semismooth_newton(problem, start, 1e-13)]
    for solution in solutions[1:]:
        assert solution == pytest.approx(solutions[0], abs=1e-9)


def test_problems_with_other_velocities_share_the_rest():
    rng = np.random.default_rng(3)
    matrix = np.diag(rng.uniform(1, 2, 6))
    problem = FrictionProblem(matrix, rng.normal(size=(3, 2)), np.full((3, 1), 0.4), (1,))
    velocity, impulses = rng.normal(size=(3, 2)), rng.normal(size=(3, 2))
    other, fresh = problem.with_velocity(velocity), replace(problem, velocity=velocity)
    assert other.mobility is problem.mobility
    assert other.residual(impulses) == fresh.residual(impulses) != problem.residual(impulses)


def test_contacts_share_bodies_whose_directions_are_zero():
    """Normals along x and y of one body have no common direction that is not zero."""
    moved = np.array([[True, True, False], [True, True, False], [False, False, True]])
    change = np.array([1.0, 3.0, 2.0])
    rows = np.repeat(np.arange(3), [2, 2, 1]), np.array([0, 1, 0, 1, 2])
    stored = scipy.sparse.csr_array((np.array([1.0, 0, 0, 1, 1]), rows), shape=(3, 3))
    assert largest_moving(moved, change).tolist() == [3.0, 3.0, 2.0]
    assert largest_nearby(stored, change).tolist() == [3.0, 3.0, 2.0]


@pytest.mark.parametrize("size", [0, 5, 200])
def test_keys_are_among_others(size):
    rng = np.random.default_rng(4)
    keys, others = rng.integers(0, 300, 150), rng.integers(0, 300, size)
    assert np.array_equal(among(keys, others), np.isin(keys, others))


def test_listed_gaps_are_those_of_a_new_source():
    """The same keys at several positions, and other keys in between."""
    model = jack().build()
    e, p, far = model.equations, model.nominal, np.ones((model.equations.speed_count, 1))
    source, rng = gap_sources(model)[0], np.random.default_rng(5)
    keys = source.near(Configuration(0.0, model.start.y, p), far).key
    for k in range(4):
        y = e.manifold.go(model.start.y, 0.05 * rng.normal(size=e.speed_count))
        at, own = Configuration(0.0, y, p), keys if k != 2 else rng.permutation(keys)[:3]
        gaps = source.selected(at, own)
        new = gap_sources.__wrapped__(model)[0].selected(at, own)
        assert np.array_equal(gaps.key, own)
        assert gaps.distance == pytest.approx(new.distance, abs=1e-15)
        assert gaps.directions == pytest.approx(new.directions, abs=1e-15)


def test_positions_of_a_step_in_turns_are_evaluated_once(monkeypatch):
    model, counts = jack().build(), {"balls": 0, "hulls": 0}
    source = gap_sources.__wrapped__(model)[0]

    def counted(owner, name, kind):
        function = getattr(owner, name)

        def call(*arguments):
            counts[kind] += 1
            return function(*arguments)

        monkeypatch.setattr(owner, name, call)

    assert isinstance(source, JoinedGaps)
    counted(source.sources[0], "_within", "balls")
    counted(source.sources[1], "within", "hulls")
    places = [Configuration(0.0, model.start.y + shift, model.nominal) for shift in (0, 1e-3, 2e-3)]
    depths = [source.deepest(at) for at in places]
    for at, depth in zip(places, depths, strict=True):
        assert source.deepest(at) == depth
    assert counts == {"balls": 3, "hulls": 3}


def test_balls_of_one_body_have_no_gaps_of_their_own():
    """They touch other shapes, of which the search among hulls knows."""
    system = da.System("rollers", gravity=(0, -9.81))
    cart = system.add(planar.Body("cart", mass=1.0, inertia=0.1, position=(0, 0.2)))
    wheels = [contact.Circle(cart.point(x, 0), 0.1) for x in (-0.3, 0.3)]
    slab = contact.Rectangle(system.ground.point(0, 0), (2.0, 0.1))
    system.add(planar.Collisions("touch", [*wheels, slab]))
    model = system.build()
    assert [type(source) for source in gap_sources(model)] == [HullGaps]
    motion = da.solve_nonsmooth(model, 0.5, step=1e-3)
    assert motion.status.success
    assert motion["cart.y"].values[-1] == pytest.approx(0.15, abs=1e-6)


def test_points_of_gaps_lie_between_balls_and_on_walls():
    system = da.System("balls", gravity=(0, -9.81))
    places = [(0.0, 0.15), (0.3, 0.2), (0.1, 0.45)]
    bodies = [
        system.add(planar.Body(f"b{k}", mass=1.0, inertia=0.1, position=place))
        for k, place in enumerate(places)
    ]
    floor = contact.HalfPlane(system.ground.center)
    shapes = [*(contact.Circle(body, 0.1 + 0.01 * k) for k, body in enumerate(bodies)), floor]
    system.add(planar.Collisions("touch", shapes))
    model = system.build()
    source, at = gap_sources(model)[0], Configuration(0.0, model.start.y, model.nominal)
    assert isinstance(source, CollisionGaps)
    gaps = source.near(at, np.full((9, 1), 10.0))
    points, directions = source.points(at, gaps.key)
    assert gaps.count == 6
    for key, gap, point, normal in zip(
        gaps.key, gaps.distance, points, directions[:, :, 0], strict=True
    ):
        first, second = divmod(int(key), 4)
        other, radius = np.array(places[second]), 0.1 + 0.01 * second
        assert math.hypot(*normal) == pytest.approx(1)
        if first == 3:
            assert normal == pytest.approx([0, 1, 0])
            assert point[0] == pytest.approx(other[0]) and gap == pytest.approx(other[1] - radius)
        else:
            away = other - places[first]
            assert normal[:2] == pytest.approx(away / math.hypot(*away))
            middle = np.array(places[first]) + (0.1 + 0.01 * first + gap / 2) * normal[:2]
            assert point[:2] == pytest.approx(middle)
