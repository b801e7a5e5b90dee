"""Laws of the one Newton iteration: quadratic, honest about rounding and failure, free of units."""

import numpy as np
import pytest

from dalembert.symbolic.equations.newton import Ending, Equations, NewtonSettings, Residual, solve

TIGHT = NewtonSettings(tolerance=1e-14, max_iterations=30)
FACTORS = [1e-9, 1e-3, 1e6, 1e9]


class Circle(Equations):
    """A circle and a line, ``x² + y² = l²``, ``y = x / 2``, with lengths in any unit."""

    def __init__(self, unit=1.0, rows=(1.0, 1.0), longest=np.inf):
        self.unit, self.rows, self.longest = unit, np.array(rows), longest
        self.sizes = []

    def residual(self, x):
        squares, line = (x / self.unit) ** 2, np.array([x[0] / 2, x[1]]) / self.unit
        value = np.array([squares.sum() - 1.0, line[1] - line[0]])
        self.sizes.append(np.abs(value).max())
        scale = np.array([squares.sum() + 1.0, np.abs(line).sum()])
        return Residual(self.rows * value, self.rows * scale)

    def step(self, x, residual):
        jacobian = np.array([2 * x / self.unit**2, np.array([-0.5, 1.0]) / self.unit])
        return -np.linalg.solve(self.rows[:, None] * jacobian, residual.value)


class Scalar(Equations):
    """A function of one variable with its derivative and the size of its terms."""

    def __init__(self, function, slope, scale=1.0, rounding=None):
        self.function, self.slope, self.scale, self.rounding = function, slope, scale, rounding
        self.evaluations = 0

    def residual(self, x):
        self.evaluations += 1
        return Residual(np.array([self.function(x[0])]), self.scale, self.rounding)

    def step(self, x, residual):
        if self.slope(x[0]) == 0:
            raise np.linalg.LinAlgError("flat")
        return -residual.value / self.slope(x[0])


def test_convergence_is_quadratic():
    circle = Circle()
    root = solve(circle, np.array([2.0, 0.3]), TIGHT)
    errors = np.array([s for s in circle.sizes if s > 1e-12])
    assert root.ending is Ending.CONVERGED and root.accepted
    np.testing.assert_allclose(root.x, np.array([2.0, 1.0]) / np.sqrt(5), rtol=1e-14)
    assert np.all(errors[2:] < 2 * errors[1:-1] ** 2)


@pytest.mark.parametrize("unit", FACTORS)
@pytest.mark.parametrize("rows", [(1.0, 1.0), (1e-9, 1e6)])
def test_units_of_rows_and_unknowns_change_nothing(unit, rows):
    start = np.array([5.0, -0.2])
    plain, scaled = Circle(longest=0.5), Circle(unit, rows, longest=0.5 * unit)
    a, b = solve(plain, start, TIGHT), solve(scaled, unit * start, TIGHT)
    np.testing.assert_allclose(b.x / unit, a.x, rtol=1e-14)
    np.testing.assert_allclose(scaled.sizes, plain.sizes, rtol=1e-6, atol=1e-14)
    assert (a.iterations, a.ending) == (b.iterations, b.ending)


def test_a_long_step_is_halved_until_the_residual_falls():
    arc = Scalar(np.arctan, lambda x: 1 / (1 + x**2))
    full = NewtonSettings(tolerance=1e-14, max_iterations=30, halvings=0, growth=1.5)
    assert solve(arc, np.array([20.0]), TIGHT).ending is Ending.CONVERGED
    lost = solve(
        arc, np.array([20.0]), NewtonSettings(tolerance=1e-14, max_iterations=9, halvings=0)
    )
    assert not lost.accepted
    steep = Scalar(lambda x: np.sign(x) * np.sqrt(abs(x)), lambda x: 0.3 / np.sqrt(abs(x)))
    assert solve(steep, np.array([1.0]), full).ending is Ending.DIVERGED


def test_rounding_stands_still_and_is_accepted_only_below_a_stated_residual():
    noise = 3e-13

    def noisy(x):
        return noise * (np.floor((x - np.pi) / noise) + 0.5)

    settings = NewtonSettings(tolerance=1e-14, max_iterations=50)
    root = solve(Scalar(noisy, lambda x: 1.0), np.array([4.0]), settings)
    assert root.ending is Ending.STANDSTILL and root.accepted and root.iterations < 6
    strict = NewtonSettings(tolerance=1e-14, max_iterations=50, slack=2.0)
    root = solve(Scalar(noisy, lambda x: 1.0), np.array([4.0]), strict)
    assert not root.accepted and root.residual > 1e-13
    equation = Scalar(noisy, lambda x: 1.0, rounding=2 * noise)
    assert solve(equation, np.array([4.0]), strict).ending is Ending.CONVERGED


def test_a_residual_without_a_root_stands_above_it():
    root = solve(Scalar(lambda x: x**2 + 1, lambda x: 2 * x, 1.0), np.array([0.7]), TIGHT)
    assert root.ending is Ending.STANDSTILL and not root.accepted
    assert root.residual > 0.5


@pytest.mark.parametrize("start", [np.nan, np.inf, 0.9])
def test_nan_is_never_a_solution(start):
    broken = Scalar(lambda x: 2.0 if x == 0.9 else np.nan, lambda x: -1.0)
    root = solve(broken, np.array([start]), TIGHT)
    assert root.ending is Ending.NOT_FINITE and not root.accepted


def test_a_flat_equation_is_singular():
    root = solve(Scalar(lambda x: 1.0, lambda x: 0.0), np.array([1.0]), TIGHT)
    assert root.ending is Ending.SINGULAR and not root.accepted


def test_an_early_end_returns_the_best_point():
    slow = NewtonSettings(tolerance=1e-14, max_iterations=2)
    root = solve(Scalar(lambda x: x**3, lambda x: 3 * x**2), np.array([1.0]), slow)
    assert root.ending is Ending.ITERATIONS and root.iterations == 2
    np.testing.assert_allclose(root.x, (2 / 3) ** 2)


def test_nothing_left_of_nothing_is_solved():
    empty = Scalar(lambda x: 0.0, lambda x: 0.0, scale=0.0)
    assert solve(empty, np.array([3.0]), TIGHT).ending is Ending.CONVERGED
    something = Scalar(lambda x: 1e-300, lambda x: 0.0, scale=0.0)
    assert not solve(something, np.array([3.0]), TIGHT).accepted


def test_positions_may_be_points_of_a_manifold():
    """Where a unit vector stands across another: steps are angles, points stay on the circle."""

    class Across(Equations):
        def residual(self, x):
            return Residual(np.array([x @ [0.6, 0.8]]), 1.0)

        def step(self, x, residual):
            return -residual.value / np.array([[-x[1], x[0]] @ np.array([0.6, 0.8])])

        def retract(self, x, step):
            c, s = np.cos(step[0]), np.sin(step[0])
            return np.array([c * x[0] - s * x[1], s * x[0] + c * x[1]])

    root = solve(Across(), np.array([1.0, 0.0]), TIGHT)
    np.testing.assert_allclose(np.abs(root.x), [0.8, 0.6], rtol=1e-14)


def test_shorter_steps_may_be_other_steps():
    """Levenberg–Marquardt finds the root of Powell's badly scaled singular start."""

    class Marquardt(Circle):
        damping = 1e-3

        def steps(self, x, residual):
            jacobian = np.array([2 * x, [-0.5, 1.0]]) / residual.scale[:, None]
            self.damping /= 10
            while True:
                self.damping *= 5
                normal = jacobian.T @ jacobian + self.damping * np.eye(2)
                yield -np.linalg.solve(normal, jacobian.T @ (residual.value / residual.scale))

    root = solve(
        Marquardt(), np.zeros(2) + 1e-3, NewtonSettings(tolerance=1e-13, max_iterations=99)
    )
    assert root.accepted
    np.testing.assert_allclose(np.abs(root.x), np.array([2.0, 1.0]) / np.sqrt(5), rtol=1e-12)
