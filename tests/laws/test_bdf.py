"""Backward differentiation: orders, tolerances, stiffness and every index."""

from __future__ import annotations

import functools

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar
from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.integrators.base import Problem
from dalembert.integrators.bdf.control import Accuracy
from dalembert.integrators.bdf.step import BDFStep
from dalembert.integrators.marching.adaptive import AdaptiveMarch
from dalembert.integrators.marching.march import FixedMarch
from dalembert.integrators.marching.steps import Watch
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.equations.semi_explicit import SemiExplicit

FORMS = {
    "index 1": da.RangeSpace(),
    "index 2": da.DAE(index=2),
    "index 3": da.DAE(index=3),
    "stabilized": da.DAE(index=2, stabilized=True),
}
OUTPUTS = np.linspace(0.0, 0.64, 23)


@functools.cache
def chain():
    """Two bars and a spring, smooth, with parameters of every kind."""
    system = da.System("chain", gravity=(0.0, -9.81))
    length, speed = system.parameter("length", 0.6), system.parameter("speed", 0.4)
    mass, stiffness = system.parameter("mass", 0.7), system.parameter("stiffness", 6.0)
    upper = planar.Bar("upper", length=length, mass=1.2, angle=-0.9, angular_velocity=speed)
    upper = system.add(upper)
    lower = planar.Bar("lower", length=0.5, mass=mass, angle=-1.3, angular_velocity=-0.6)
    lower = system.add(lower)
    system.add(planar.Revolute("pin", system.ground.point(0, 0), upper.start))
    system.add(planar.Revolute("knee", upper.end, lower.start))
    tie = system.ground.point(1.4, 0.3)
    system.add(
        planar.Spring("spring", tie, lower.end, stiffness=stiffness, damping=0.4, free_length=0.9)
    )
    return system.build()


@functools.cache
def exact(times: tuple[float, ...]):
    method = da.DormandPrince853(1e-13, 1e-13)
    return da.solve_dynamics(
        chain(), t_span=(0.0, times[-1]), integrator=method, outputs=times
    ).trajectory


def relative_errors(computed, true) -> np.ndarray:
    """Largest errors of positions, speeds and multipliers by the size of each kind."""
    return np.array(
        [
            np.abs(getattr(computed, n) - getattr(true, n)).max()
            / (1 + np.abs(getattr(true, n)).max())
            for n in ("y", "v", "multiplier")
        ]
    )


@pytest.mark.few(1)
@pytest.mark.parametrize("stabilization", [da.Stabilization(), da.Projection()], ids=repr)
@pytest.mark.parametrize("form", FORMS)
def test_tolerance_is_met_at_steps_and_between(form, stabilization):
    """Errors of positions, speeds and multipliers follow the tolerance over six decades."""
    tolerances, table = 10.0 ** -np.arange(4, 11, 2), []
    for tolerance in tolerances:
        motion = run(form, tolerance, stabilization=stabilization)
        assert motion.status.success
        table.append(relative_errors(motion.trajectory, exact(tuple(OUTPUTS))))
    # with index 3 and no projection, speeds are controlled to tolerance/h only
    loose = form == "index 3" and stabilization == da.Stabilization()
    assert np.all(np.array(table) < (400 if loose else 40) * tolerances[:, None])


def run(form: str, tolerance: float, **options):
    return da.solve_dynamics(
        chain(),
        0.64,
        integrator=da.BDF(tolerance, tolerance),
        formulation=FORMS[form],
        outputs=OUTPUTS,
        **options,
    )


@pytest.mark.product
@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("stabilization", [da.Stabilization(), da.Projection()], ids=repr)
@pytest.mark.parametrize("form", FORMS)
def test_order_with_constant_steps(form, stabilization, order):
    """Started on exact differences, errors fall with the order; corrections do not spoil it."""
    begin, length, counts = 0.2, 0.4, np.array([100, 140, 200])
    choices = {"formulation": FORMS[form], "stabilization": stabilization}
    kernel, p = Dynamics(1.0, integrator=da.BDF(), **choices).kernel(chain()), chain().nominal
    mode = kernel.choose(0.0, np.zeros(chain().start.y.size), p)
    step = BDFStep(kernel.variants[mode].problem, Accuracy(1e-9, 1e-9, order, order))
    end = exact((begin + length,))
    true, errors = np.concatenate([end.y, end.v])[:, 0], []
    for count in counts:
        h = length / count
        past = exact(tuple(begin + h * np.arange(-order, 1)))
        values = np.vstack([past.y, past.v, np.zeros((2, order + 1))])
        differences = [np.diff(values, j)[:, -1] for j in range(order + 1)]
        memory = [np.zeros(values.shape[0]), [order, h, 0]]
        march = FixedMarch(lambda mode: step)
        grid = begin + h * np.arange(count + 1)
        trajectory = march.run(grid, np.concatenate([*differences, *memory]), p, 0, Watch())
        errors.append(np.abs(trajectory.x[: true.size, -1] - true).max())
    assert np.polyfit(np.log(1 / counts), np.log(errors), 1)[0] == pytest.approx(order, abs=0.2)


@pytest.mark.parametrize("form", ["index 3", "stabilized"])
def test_positions_stay_on_the_constraints_without_projection(form):
    motion = run(form, 1e-6, stabilization=da.Stabilization())
    assert float(motion.data.position_violation.max()) < 1e-11


def van_der_pol(mu: float) -> Problem:
    """``ẍ = μ (1 − x²) ẋ − x`` without a mechanism."""
    t, x, z, p = ca.SX.sym("t"), ca.SX.sym("x", 2), ca.SX(0, 1), ca.SX.sym("p", 0)
    rate = ca.vertcat(x[1], mu * (1 - x[0] ** 2) * x[1] - x[0])
    start = ImplicitFunction("start", [t, x, p], [], [z])
    system = SemiExplicit(t, x, z, p, rate, z, (), (), 1, start)
    return Problem(None, lambda: system, None, controlled=2, positions=1)


@pytest.mark.thorough
@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
def test_stiff_oscillator_like_another_implementation(tolerance):
    """Van der Pol's equation, μ = 1000: no more steps than SciPy's BDF, no larger error."""
    mu, end, x0, p = 1e3, 2000.0, np.array([2.0, 0.0]), np.zeros(0)
    method, problem = da.BDF(tolerance, 1e-2 * tolerance), van_der_pol(mu)
    step = method.step(problem)
    memory = step.begin.function(0.0, x0, p).full().ravel()
    attempt = method.attempt(problem, step)
    march = AdaptiveMarch(lambda mode: attempt)
    trajectory = march.run(0.0, end, np.concatenate([x0, memory]), p, 1e-4, end, 0, Watch())
    assert not trajectory.message

    def scipy(method, rtol, atol):
        return solve_ivp(
            lambda t, x: [x[1], mu * (1 - x[0] ** 2) * x[1] - x[0]],
            (0.0, end),
            x0,
            method=method,
            rtol=rtol,
            atol=atol,
            jac=lambda t, x: [[0, 1], [-2 * mu * x[0] * x[1] - 1, mu * (1 - x[0] ** 2)]],
        )

    other, true = scipy("BDF", tolerance, 1e-2 * tolerance), scipy("Radau", 1e-9, 1e-11)
    assert trajectory.count < 1.2 * (other.t.size - 1)
    error = np.abs(trajectory.x[0, -1] - true.y[0, -1])
    assert error < 2 * np.abs(other.y[0, -1] - true.y[0, -1])


def test_stiff_bushing_needs_few_steps():
    """A pendulum in a hard bushing: far fewer steps than explicit ones, to the same motion."""
    system = da.System("hung", gravity=(0.0, -9.81))
    bar = planar.Bar("bar", length=1.0, mass=1.0, position=(0.5, 0.0), angle=0.0)
    bar = system.add(bar)
    pin, hard = system.ground.point(0, 0), {"stiffness": (1e7, 1e7), "damping": (1e4, 1e4)}
    system.add(planar.Bushing("bush", pin, bar.start, **hard))
    model, outputs = system.build(), [0.25, 0.5, 1.0]
    implicit = da.solve_dynamics(model, 1.0, integrator=da.BDF(1e-5, 1e-7), outputs=outputs)
    explicit = da.solve_dynamics(
        model, 1.0, integrator=da.DormandPrince(1e-8, 1e-10), outputs=outputs
    )
    assert implicit.statistics["steps"] < explicit.statistics["steps"] / 20
    np.testing.assert_allclose(implicit.trajectory.y, explicit.trajectory.y, atol=1e-3)


@pytest.mark.few(1)
@pytest.mark.parametrize("form", FORMS)
def test_steps_can_be_repeated_and_differentiated(form):
    """Replays are the run itself; direct = adjoint to round-off, both = differences of replays."""
    analysis = Dynamics(
        0.64, integrator=da.BDF(1e-5, 1e-5), formulation=FORMS[form], outputs=OUTPUTS
    )
    motion = analysis.run(chain())
    again = analysis.replay(motion, motion.parameters)
    np.testing.assert_array_equal(again.trajectory.y, motion.trajectory.y)
    responses = [da.final("lower.angle"), da.integral("knee.force_norm")]
    adjoint, direct, differences = (
        da.sensitivity(motion, responses, method=method).values
        for method in (da.Adjoint(), da.Direct(), da.FiniteDifference())
    )
    size = np.abs(adjoint).max()
    np.testing.assert_allclose(direct, adjoint, rtol=0, atol=1e-12 * size)
    np.testing.assert_allclose(adjoint, differences, rtol=0, atol=1e-6 * size)


def test_a_fall_into_a_singular_force_ends_with_a_status():
    """``ẍ = −1/x³`` reaches x = 0 at t = 1: the step collapses there, and no sooner."""
    system = da.System("fall")
    body = system.add(planar.Particle("body", mass=1.0, position=(1.0, 0.0)))
    system.add(planar.Force("pull", body.center, (-1 / body.x**3, 0.0)))
    motion = da.solve_dynamics(system.build(), 2.0, integrator=da.BDF())
    assert not motion.status.success
    assert motion.status.time == pytest.approx(1.0, abs=1e-3)
    x, t = motion.data.position.values[:, 0, 0], motion.time
    np.testing.assert_allclose(x[t < 0.99], np.sqrt(1 - t[t < 0.99] ** 2), atol=1e-4)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"rtol": 0.0}, "positive"),
        ({"atol": -1e-8}, "positive"),
        ({"max_step": 0.0}, "max_step"),
        ({"max_order": 6}, "max_order"),
        ({"max_order": 0}, "max_order"),
    ],
)
def test_wrong_options_are_refused(options, words):
    with pytest.raises(da.UnsupportedError, match=words):
        da.BDF(**options)


@pytest.mark.parametrize("coordinates", [da.AbsoluteCoordinates(), da.JointCoordinates()])
def test_corrected_energy_costs_no_steps(coordinates):
    """Through standstills, where errors of positions become jumps of speeds."""
    system = da.System("pendulum", gravity=(0.0, -9.81))
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0, angle=0.3))
    system.add(planar.Revolute("O", system.ground.point(0, 0), bar.start))
    model = system.build()
    for rtol in (1e-6, 1e-10):
        run = functools.partial(
            da.solve_dynamics, model, 2.0, integrator=da.BDF(rtol=rtol), coordinates=coordinates
        )
        plain = run(stabilization=da.Projection())
        corrected = run(stabilization=da.EnergyProjection())
        assert plain.status.success and corrected.status.success
        assert corrected.record.steps.count < 1.1 * plain.record.steps.count
        errors = [np.abs(motion.data.balance_error.values).max() for motion in (plain, corrected)]
        assert errors[1] < 0.1 * errors[0]
