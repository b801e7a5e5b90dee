"""Impulses of contact: complementarity against enumeration, cones against their own conditions."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import dalembert as da
from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.contacts import FrictionProblem


def random_problem(
    seed: int,
    count: int,
    groups: tuple[int, ...],
    freedom: int,
    friction: float,
    minimum: float = 0.0,
):
    """``H = W Wᵀ`` of a body with so many ways to move; without impulses it moves by chance."""
    rng, width = np.random.default_rng(seed), 1 + sum(groups)
    directions = rng.normal(size=(count * width, freedom))
    velocity = (directions @ rng.normal(size=freedom)).reshape(count, width)
    coefficients = friction * (1 + np.arange(len(groups))) * np.ones((count, 1))
    lowest = minimum * rng.choice([0.0, 1.0], count)
    matrix = directions @ directions.T
    return FrictionProblem(matrix, velocity, coefficients, groups, minimum=lowest)


def enumerated(matrix: np.ndarray, velocity: np.ndarray) -> list[np.ndarray]:
    """Every velocity ``u`` with ``0 ≤ u = H P + b ⟂ P ≥ 0``, by trying which contacts press."""
    results, size = [], velocity.size
    for pressing in product([False, True], repeat=size):
        part = np.flatnonzero(pressing)
        impulses = np.zeros(size)
        block = matrix[np.ix_(part, part)]
        if part.size:
            if np.linalg.cond(block) > 1e10:
                continue
            impulses[part] = np.linalg.solve(block, -velocity[part])
        speeds = matrix @ impulses + velocity
        if impulses.min() >= -1e-9 and speeds.min() >= -1e-9:
            results.append(speeds)
    return results


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 6), st.integers(2, 8))
def test_without_friction_it_is_the_enumerated_complementarity(seed, count, freedom):
    """Speeds are unique whatever the impulses are."""
    problem = random_problem(seed, count, (), freedom, 0.0)
    expected = enumerated(problem.matrix, problem.velocity.ravel())
    solved = da.ContactSolver().solve(problem)
    assert solved.converged and expected
    speeds = problem.speeds(solved.impulses).ravel()
    assert min(np.abs(speeds - other).max() for other in expected) < 1e-7


GROUPS = (1,), (2,), (1, 1), (2, 2, 1)
"""Sliding in the plane and in space; the same with rolling, and spinning."""


@settings(max_examples=60, deadline=None)
@given(
    st.integers(0, 10**6),
    st.integers(1, 12),
    st.sampled_from(GROUPS),
    st.floats(0.0, 0.4),
    st.floats(0.0, 0.5),
)
def test_impulses_stay_in_their_cones_and_oppose_slip(seed, count, groups, friction, minimum):
    """Each group has its own disc; impulses above the minimum press a closed gap."""
    problem = random_problem(seed, count, groups, count * (1 + sum(groups)), friction, minimum)
    solved = da.ContactSolver().solve(problem)
    assert solved.converged, solved.residual
    impulses, speeds = solved.impulses, problem.speeds(solved.impulses)
    small = 1e-7 * problem.size(impulses)
    normal = impulses[:, 0]
    excess, size = normal - problem.minimum, 1 + normal.max()
    assert normal.min() >= 0 and excess.min() >= -1e-12 and speeds[:, 0].min() >= -small
    assert np.abs(excess * speeds[:, 0]).max() <= small * size
    for components, coefficients in problem.discs:
        tangential = np.linalg.norm(impulses[:, components], axis=1)
        assert (tangential <= coefficients * normal * (1 + 1e-9) + 1e-12).all()
        slip = np.linalg.norm(speeds[:, components], axis=1)
        power = np.sum(impulses[:, components] * speeds[:, components], axis=1)
        assert power == pytest.approx(-coefficients * normal * slip, abs=small * size)


def test_more_contacts_than_freedoms():
    """Impulses of a hyperstatic pile are not unique, and are found."""
    problem = random_problem(3, 30, (1,), 20, 0.3)
    solved = da.ContactSolver().solve(problem)
    assert solved.converged and solved.residual < 1e-8


def test_problems_without_solution_are_reported():
    """A wall that cannot move and is moved into: ``u = b < 0`` whatever the impulse."""
    problem = FrictionProblem(np.zeros((1, 1)), np.array([[-1.0]]), np.zeros((1, 0)), ())
    solved = da.ContactSolver(max_iterations=10).solve(problem)
    assert not solved.converged and solved.residual == pytest.approx(1.0)


@pytest.mark.parametrize("options", [{"tolerance": 0.0}, {"max_iterations": -1}])
def test_bad_options(options):
    with pytest.raises(UnsupportedError, match=next(iter(options))):
        da.ContactSolver(**options)


@pytest.mark.few(1)
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_problem_without_solution_ends_early(friction):
    """Two walls that close on a body: ``u₁ + u₂ = −2`` for any impulses."""
    directions = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, 1.0]])
    velocity = np.array([[-1.0, 0.3], [-1.0, 0.3]])
    coefficients = np.full((2, 1), friction)
    problem = FrictionProblem(directions @ directions.T, velocity, coefficients, (1,))
    solved = da.ContactSolver().solve(problem)
    assert not solved.accepted and not solved.converged
    assert solved.residual > 0.9
    assert solved.rounds <= 200 < da.ContactSolver().max_iterations
