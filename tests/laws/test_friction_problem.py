"""Impulses of contact: complementarity against enumeration, cones against their own conditions."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import dalembert as da
from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.contacts import FrictionProblem


def random_problem(seed: int, count: int, width: int, freedom: int, friction: float):
    """``H = W Wᵀ`` of a body with so many ways to move; without impulses it moves by chance."""
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(count * width, freedom))
    velocity = (directions @ rng.normal(size=freedom)).reshape(count, width)
    matrix = directions @ directions.T
    return FrictionProblem(matrix, velocity, np.full(count, friction))


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
    problem = random_problem(seed, count, 1, freedom, 0.0)
    expected = enumerated(problem.matrix, problem.velocity.ravel())
    solved = da.ContactSolver().solve(problem)
    assert solved.converged and expected
    speeds = problem.speeds(solved.impulses).ravel()
    assert min(np.abs(speeds - other).max() for other in expected) < 1e-7


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 20), st.sampled_from([2, 3]), st.floats(0.0, 0.4))
def test_impulses_stay_in_their_cones_and_oppose_slip(seed, count, width, friction):
    problem = random_problem(seed, count, width, count * width, friction)
    solved = da.ContactSolver().solve(problem)
    assert solved.converged, solved.residual
    impulses, speeds = solved.impulses, problem.speeds(solved.impulses)
    small = 1e-7 * problem.size(impulses)
    normal, tangential = impulses[:, 0], np.linalg.norm(impulses[:, 1:], axis=1)
    assert normal.min() >= 0 and speeds[:, 0].min() >= -small
    assert np.abs(normal * speeds[:, 0]).max() <= small * (1 + normal.max())
    assert (tangential <= friction * normal * (1 + 1e-9) + 1e-12).all()
    slip = np.linalg.norm(speeds[:, 1:], axis=1)
    power = np.sum(impulses[:, 1:] * speeds[:, 1:], axis=1)
    assert power == pytest.approx(-friction * normal * slip, abs=small * (1 + normal.max()))


def test_more_contacts_than_freedoms():
    """Impulses of a hyperstatic pile are not unique, and are found."""
    problem = random_problem(3, 30, 2, 20, 0.3)
    solved = da.ContactSolver().solve(problem)
    assert solved.converged and solved.residual < 1e-8


def test_problems_without_solution_are_reported():
    """A wall that cannot move and is moved into: ``u = b < 0`` whatever the impulse."""
    problem = FrictionProblem(np.zeros((1, 1)), np.array([[-1.0]]), np.zeros(1))
    solved = da.ContactSolver(max_iterations=10).solve(problem)
    assert not solved.converged and solved.residual == pytest.approx(1.0)


@pytest.mark.parametrize("options", [{"tolerance": 0.0}, {"max_iterations": -1}])
def test_bad_options(options):
    with pytest.raises(UnsupportedError, match=next(iter(options))):
        da.ContactSolver(**options)
