"""Many contacts: sparse operators against dense ones, near pairs against all, piles, energy."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
import scipy
from rigid_contacts import other_warnings

import dalembert as da
from dalembert import planar
from dalembert.analysis.nonsmooth.gaps.bounding_balls import near_balls
from dalembert.analysis.nonsmooth.gaps.neighbours import Neighbours
from dalembert.analysis.nonsmooth.mobility import Coupling, Mobility
from dalembert.integrators.contact import compiled_newton
from dalembert.integrators.contact.block_ordering import BlockOrderings
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import DENSE, Delassus
from dalembert.integrators.contact.places import Counts
from dalembert.integrators.contact.semismooth_newton import semismooth_newton
from dalembert.integrators.contact.solution_settings import SOLUTION_COUNTS
from dalembert.integrators.contact.sweeps import swept

G = 9.81
JOINED = 5
"""Speeds of a chain of bodies in the random inertia."""


def random_mobility(rng: np.random.Generator, blocks: int, joints: bool) -> Mobility:
    """Free bodies of three speeds, and a few bodies coupled by their matrix or by a joint."""
    n = 3 * blocks + JOINED
    matrix = np.zeros((n, n))
    for k in range(blocks):
        part = rng.normal(size=(3, 3))
        matrix[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = part @ part.T + 3 * np.eye(3)
    part = rng.normal(size=(JOINED, JOINED))
    matrix[-JOINED:, -JOINED:] = part @ part.T + 5 * np.eye(JOINED)
    constraint = np.zeros((1 if joints else 0, n))
    constraint[:, -2:] = 1.0, -2.0
    patterns = ca.DM(matrix).sparsity(), ca.sparsify(ca.DM(constraint)).sparsity()
    coupling = Coupling.of(ca.sparsify(ca.DM(matrix)).sparsity(), patterns[1])
    return Mobility(scipy.sparse.csr_array(matrix), scipy.sparse.csr_array(constraint), coupling)


def random_directions(rng: np.random.Generator, rows: int, speeds: int) -> scipy.sparse.csr_array:
    return scipy.sparse.csr_array(
        scipy.sparse.random_array((rows, speeds), density=6 / speeds, rng=rng, format="csr")
    )


def pair_directions(
    rng: np.random.Generator, count: int, width: int, bodies: int
) -> scipy.sparse.csr_array:
    """Rows of contacts between random pairs of bodies of three speeds."""
    row = np.repeat(np.arange(width * count), 6)
    pairs = np.stack([rng.permutation(bodies)[:2] for _ in range(count)])
    column = np.repeat((3 * pairs[:, :, None] + np.arange(3)).reshape(count, 6), width, axis=0)
    data = rng.normal(size=row.size), (row, column.ravel())
    return scipy.sparse.csr_array(data, shape=(width * count, 3 * bodies))


@pytest.mark.parametrize("columns", [256, 3])
@pytest.mark.parametrize("joints", [False, True])
def test_mobility_solves_the_equations_of_free_and_joined_bodies(joints, columns, monkeypatch):
    monkeypatch.setattr("dalembert.analysis.nonsmooth.mobility.COLUMNS", columns)
    rng = np.random.default_rng(4)
    solver = random_mobility(rng, 20, joints)
    matrix, constraint = solver.matrix.toarray(), solver.joints.toarray()
    right, below = rng.normal(size=matrix.shape[0]), rng.normal(size=constraint.shape[0])
    speeds, multipliers = solver(right, below)
    assert matrix @ speeds + constraint.T @ multipliers == pytest.approx(right)
    assert constraint @ speeds == pytest.approx(below)
    directions = random_directions(rng, 40, matrix.shape[0])
    expected = solver(directions.toarray().T)[0].T
    assert solver.responses(directions).toarray() == pytest.approx(expected)


@pytest.mark.parametrize("joints", [False, True])
@pytest.mark.parametrize("groups", [(), (1,), (2,), (1, 1), (2, 2, 1)])
@pytest.mark.parametrize("minimum", [0.0, 0.3])
def test_sparse_impulses_are_those_of_the_dense_matrix(joints, groups, minimum):
    """Operator, its diagonal and shift, sweeps, and Newton steps with eliminated impulses."""
    rng, width = np.random.default_rng(5), 1 + sum(groups)
    mobility, count = random_mobility(rng, 60, joints), 1 + DENSE // width
    directions = random_directions(rng, count * width, mobility.matrix.shape[0])
    responses, shift = mobility.responses(directions), rng.random(count * width)
    sparse = Delassus(directions, responses, mobility.matrix, mobility.joints, shift)
    dense = directions.toarray() @ responses.toarray().T + np.diag(shift)
    some = rng.normal(size=count * width)
    assert sparse.dense is None
    assert sparse @ some == pytest.approx(dense @ some)
    assert sparse.diagonal() == pytest.approx(dense.diagonal())
    velocity, friction = rng.normal(size=(count, width)), rng.random((count, len(groups)))
    law = {"friction": friction, "groups": groups, "minimum": minimum * rng.random(count)}
    problem = FrictionProblem(sparse, velocity, **law)
    same = FrictionProblem(dense, velocity, **law)
    start = np.zeros(problem.shape)
    expected = semismooth_newton(same, start, 1e-12)
    assert same.residual(expected) < 1e-10
    assert semismooth_newton(problem, start, 1e-12) == pytest.approx(expected, abs=1e-8)
    assert swept(problem, start, 1e-13) == pytest.approx(expected, abs=1e-8)
    if not joints:
        sizes = np.array([3] * 60 + [JOINED])
        orderings = BlockOrderings(sizes, np.stack(mobility.matrix.tocoo().coords))
        blocks = replace(problem, matrix=replace(sparse, orderings=orderings))
        assert blocks.matrix.by_blocks
        assert semismooth_newton(blocks, start, 1e-12) == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("groups", [(), (1,), (2,)])
def test_interior_points_alone_solve_problems_of_free_bodies(groups, monkeypatch):
    """One step of Newton's method per call leaves the problem to interior points."""
    rng, width = np.random.default_rng(3), 1 + sum(groups)
    mobility, count = random_mobility(rng, 60, False), 1 + DENSE // width
    directions = pair_directions(rng, count, width, 60)
    directions.resize((count * width, mobility.matrix.shape[0]))
    responses, none = mobility.responses(directions), np.zeros(count * width)
    sizes = np.array([3] * 60 + [JOINED])
    orderings = BlockOrderings(sizes, np.stack(mobility.matrix.tocoo().coords))
    operator = Delassus(directions, responses, mobility.matrix, mobility.joints, none)
    operator = replace(operator, orderings=orderings)
    velocity, friction = rng.normal(size=(count, width)), 0.3 * rng.random((count, len(groups)))
    problem = FrictionProblem(operator, velocity, friction, groups)
    start = np.zeros(problem.shape)
    expected = da.ContactSolver(tolerance=1e-11).solve(problem).impulses
    assert problem.residual(expected) < 1e-10
    monkeypatch.setattr(compiled_newton, "NEWTON_STEPS", 1)
    solution = compiled_newton.compiled_solution(problem, start, 1e-8, 0)
    assert solution is not None and solution[1] == 0
    speeds = problem.speeds(solution[0])
    assert problem.residual(solution[0]) < 1e-8 * problem.size(expected)
    assert speeds == pytest.approx(problem.speeds(expected), abs=1e-6)
    monkeypatch.setitem(SOLUTION_COUNTS, Counts.MAX_INTERIOR, 0)
    without = compiled_newton.compiled_solution(problem, start, 1e-8, 0)
    assert without is not None and problem.residual(without[0]) > 1e-3


@pytest.mark.parametrize("groups", [(), (1,), (2,)])
def test_proximal_problems_use_the_mobilities_of_coupled_bodies(groups, monkeypatch):
    """Impulses move bodies that are coupled with those of their contact, as by springs."""
    rng, width, bodies = np.random.default_rng(6), 1 + sum(groups), 60
    count, n = 1 + DENSE // width, 3 * bodies
    row, column = np.indices((n, n))
    near = np.abs(row // 3 - column // 3) <= 1
    part = np.where(near, rng.normal(size=(n, n)), 0.0)
    matrix = scipy.sparse.csr_array(np.where(near, part + part.T, 0.0) + 30 * np.eye(n))
    none = scipy.sparse.csr_array((0, n))
    patterns = ca.sparsify(ca.DM(matrix.toarray())).sparsity(), ca.DM(0, n).sparsity()
    mobility = Mobility(matrix, none, Coupling.of(*patterns, bodies=[3] * bodies))
    directions = pair_directions(rng, count, width, bodies)
    responses, shift = mobility.responses(directions), np.zeros(count * width)
    assert responses.nnz > directions.nnz
    orderings = mobility.coupling.orderings
    operator = Delassus(directions, responses, matrix, none, shift, orderings=orderings)
    velocity, friction = rng.normal(size=(count, width)), 0.5 * rng.random((count, len(groups)))
    problem = FrictionProblem(operator, velocity, friction, groups)
    monkeypatch.setattr(compiled_newton, "NEWTON_STEPS", 3)
    monkeypatch.setitem(SOLUTION_COUNTS, Counts.MAX_INTERIOR, 0)
    impulses, rounds = compiled_newton.compiled_solution(problem, np.zeros(problem.shape), 1e-8, 99)
    assert rounds > 0
    assert problem.residual(impulses) <= 1e-8 * problem.size(impulses)


def test_blocks_of_bodies_are_those_of_the_factors_and_serve_fewer_contacts():
    """Filled entries lie in the pattern; contacts of fewer pairs of bodies have the same order."""
    rng, count = np.random.default_rng(7), 30
    directions = pair_directions(rng, count, 2, count)
    bodies = directions.indices.reshape(count, 2, 2, 3)[:, 0, :, 0] // 3
    orderings = BlockOrderings(np.full(count, 3), np.tile(np.arange(3 * count), (2, 1)))
    order = orderings(directions, 2)
    rank = order.owner[::3]
    matrix = np.eye(count) * 100
    matrix[bodies[:, 0], bodies[:, 1]] = matrix[bodies[:, 1], bodies[:, 0]] = -1.0
    permuted = np.zeros_like(matrix)
    permuted[np.ix_(rank, rank)] = matrix
    filled = np.tril(np.linalg.cholesky(permuted), -1)
    columns = np.repeat(np.arange(count), np.diff(order.first))
    filled[order.row, columns] = 0.0
    assert not filled.any()
    assert orderings(directions[: 2 * 20], 2) is order


@pytest.mark.parametrize("large", [0, 1, 3])
def test_near_balls_of_all_sizes_are_those_of_all_pairs(large):
    """Points, small balls of many sizes, and large ones around them."""
    rng, count, reach = np.random.default_rng(large), 80, 0.05
    centers, radii = rng.normal(size=(count, 3)), 0.1 * np.exp(rng.normal(size=count))
    radii[:10], radii[10 : 10 + large] = 0.0, 2.0
    i, j = np.triu_indices(count, 1)
    near = np.linalg.norm(centers[i] - centers[j], axis=1) <= radii[i] + radii[j] + reach
    assert np.array_equal(near_balls(centers, radii, reach), np.stack([i[near], j[near]]))


def test_a_list_of_neighbours_contains_all_near_pairs_while_bodies_move():
    rng = np.random.default_rng(6)
    count, radii = 60, np.full(60, 0.1)
    positions = np.hstack([rng.uniform(0, 2, (count + 1, 2)), np.zeros((count + 1, 1))])
    positions[count] = 0.0
    normals, neighbours = np.array([[0.0, 1.0, 0.0]]), Neighbours(np.arange(count + 1))
    for _ in range(30):
        positions[:count, :2] += rng.uniform(-0.004, 0.004, (count, 2))
        reach = rng.uniform(0.0, 0.05)
        pairs, walls = neighbours.near(positions, normals, radii, reach)
        first, second = np.triu_indices(count, 1)
        apart = np.linalg.norm(positions[first] - positions[second], axis=1) - 0.2
        near = apart <= reach
        assert (pairs == np.stack([first[near], second[near]])).all()
        assert (walls[1] == np.flatnonzero(positions[:count, 1] - 0.1 <= reach)).all()


def pile(rows: int, columns: int, pendulum: bool = False) -> da.Model:
    """Discs in rows in a box; a pendulum may swing into them."""
    rng, radius = np.random.default_rng(7), 0.05
    system, width = da.System("pile", gravity=(0.0, -G)), 2.3 * 0.05 * columns
    shapes = []
    for k in range(rows * columns):
        place = (0.115 * (k % columns) + 0.06 + 0.004 * rng.random(), 0.06 + 0.11 * (k // columns))
        disc = planar.Body(f"d{k}", mass=1.0, inertia=0.00125, position=place, angle=0.0)
        shapes.append(planar.contact.Circle(system.add(disc), radius))
    if pendulum:
        rod = planar.Bar("rod", length=0.4, mass=5.0, angle=0.0, position=(0.2, 0.5))
        system.add(rod)
        system.add(planar.Revolute("pin", system.ground.point(0.0, 0.5), rod.start))
        shapes.append(planar.contact.Circle(rod.end, radius))
    corners = system.ground.center, system.ground.point(width, 0.0)
    shapes += [
        planar.contact.HalfPlane(corners[0], (0.0, 1.0)),
        planar.contact.HalfPlane(corners[0], (1.0, 0.0)),
        planar.contact.HalfPlane(corners[1], (-1.0, 0.0)),
    ]
    system.add(planar.Collisions("contacts", shapes, friction=0.3))
    return system.build()


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_a_pile_of_discs_closes_no_gap_and_gains_no_energy_in_contacts(scheme):
    motion = da.solve_nonsmooth(pile(8, 8), 0.15, step=1e-3, integrator=scheme)
    assert motion.status.success
    assert motion.statistics["maximum active contacts"] > 40
    assert motion.statistics["maximum residual [m/s]"] <= 1e-8
    assert motion.statistics["maximum penetration [m]"] <= 1e-9 * 0.05
    assert motion.statistics["maximum energy gained in contacts [J]"] <= 1e-10
    if scheme.anticipates:
        assert np.diff(motion.data["energy"]).max() <= 1e-10


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_runs_of_a_pile_are_repeated_bit_by_bit(scheme):
    """Orders of elimination of one run are not those of the next."""
    model = pile(5, 6)
    first, second = (
        da.solve_nonsmooth(model, 0.2, step=2e-3, integrator=scheme).record.ends for _ in range(2)
    )
    assert (first.y == second.y).all() and (first.v == second.v).all()


@pytest.mark.thorough
def test_a_pile_falls_alike_with_and_without_corrections_of_positions():
    """Friction of lasting contacts slows the fall; corrections lift by 1 % of what is lost."""
    model, heights = pile(8, 8), []
    for scheme in (da.AnticipatedImpacts(), da.MoreauJean()):
        motion = da.solve_nonsmooth(model, 0.3, step=1e-3, integrator=scheme, outputs=31)
        heights.append(np.mean([motion.values(f"d{k}.y") for k in range(64)], axis=0))
        assert motion.status.success and not other_warnings(motion)
    assert np.abs(heights[1] - heights[0]).max() <= 1e-2 * np.ptp(heights[0])
    statistics = motion.statistics
    lost = statistics["energy dissipated in contacts [J]"]
    lifted = statistics["work of corrections of positions [J]"]
    assert 0 <= lifted <= 1e-2 * lost
    assert motion.data["balance_error"][-1] == pytest.approx(lifted, abs=1e-9 * lost)
    assert 0 < statistics["energy dissipated by friction of contacts [J]"] < lost


@pytest.mark.thorough
def test_a_joint_stays_closed_beside_a_pile():
    motion = da.solve_nonsmooth(pile(3, 8, pendulum=True), 0.4, step=1e-3)
    assert motion.status.success
    assert motion.data["position_violation"].max() <= 1e-11
    assert motion.data["penetration"].max() <= 1e-9 * 0.05
    assert np.abs(motion.data["balance_error"]).max() <= 1e-3 * motion.data["dissipated_energy"][-1]


@pytest.mark.few(1)
@pytest.mark.parametrize("theta", [0.5, 0.8, 1.0])
def test_energy_dissipated_by_the_scheme_is_accounted(theta):
    """An oscillator: the θ-method takes ``(θ − ½)(Δvᵀ M Δv + Δyᵀ K Δy)`` in each step."""
    system = da.System("oscillator")
    ball = system.add(planar.Particle("ball", mass=1.0, position=(1.5, 0.0)))
    spring = {"stiffness": 400.0, "free_length": 1.0}
    system.add(planar.Spring("spring", system.ground.center, ball.center, **spring))
    floor = planar.contact.HalfPlane(system.ground.point(0.0, -1.0))
    system.add(planar.Collisions("floor", [planar.contact.Circle(ball, 0.1), floor]))
    scheme = da.MoreauJean(theta=theta)
    motion = da.solve_nonsmooth(system.build(), 3.0, step=1e-2, integrator=scheme)
    y, v = motion.trajectory.y[0], motion.trajectory.v[0]
    expected = (theta - 0.5) * (np.diff(v) ** 2 + 400.0 * np.diff(y) ** 2).sum()
    assert motion.status.success and not other_warnings(motion)
    assert motion.statistics["energy dissipated by the scheme [J]"] == pytest.approx(expected)
    assert motion.data["dissipated_energy"][-1] == pytest.approx(expected)
    assert np.abs(motion.data["balance_error"]).max() <= 1e-9


@pytest.mark.thorough
def test_residuals_above_the_tolerance_are_stated():
    """No sum of rounded numbers attains the tolerance; the run continues and warns."""
    model, solver = pile(3, 3), da.ContactSolver(tolerance=1e-19, max_iterations=3)
    motion = da.solve_nonsmooth(model, 0.2, step=2e-3, solver=solver)
    assert motion.status.success
    (warning,) = [text for text in motion.warnings if "residuals above the tolerance" in text]
    assert f"of {motion.record.converged.size} steps" in warning
    assert not motion.record.converged.all()
    assert motion.record.residual.max() < 1e-12
    strict = da.ContactSolver(tolerance=1e-19, acceptable=1e-19, max_iterations=3)
    failed = da.solve_nonsmooth(model, 0.2, step=2e-3, solver=strict)
    assert failed.status.outcome is da.Outcome.NOT_CONVERGED
