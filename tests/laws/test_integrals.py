"""Integrals over runs are as exact as the runs, whatever the outputs."""

from __future__ import annotations

import numpy as np
import pytest
from registry import INTEGRATORS
from test_bdf import chain

import dalembert as da
from dalembert import planar
from dalembert.analysis.dynamics.dynamics import Dynamics

SPEED, SPIN = "lower.angular_velocity", da.integral("lower.angular_velocity", name="turned")
ANGLE = da.final("lower.angle")
ADAPTIVE = {
    "DormandPrince": da.DormandPrince(1e-10, 1e-10),
    "DormandPrince853": da.DormandPrince853(1e-10, 1e-10),
    "Radau": da.Radau(1e-10, 1e-10),
    "BDF": da.BDF(1e-8, 1e-8),
    "BDF of order 2": da.BDF(1e-5, 1e-5, max_order=2),
}


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ADAPTIVE)
def test_the_integral_of_a_speed_is_the_change_of_the_angle(name):
    """To the tolerance, and so are its gradients, which are the derivatives of the quadrature."""
    integrator = ADAPTIVE[name]
    analysis = Dynamics(1.0 if name == "Radau" else 2.0, integrator=integrator, outputs=5)
    motion = analysis.run(chain())
    start = da.at(0.0, "lower.angle")
    assert da.evaluate(motion, SPIN) == pytest.approx(
        da.evaluate(motion, ANGLE) - da.evaluate(motion, start), rel=20 * integrator.rtol
    )
    adjoint, direct = (
        da.sensitivity(motion, [SPIN, ANGLE, start], method=method).values
        for method in ("adjoint", "direct")
    )
    size = np.abs(adjoint).max()
    np.testing.assert_allclose(direct, adjoint, rtol=0, atol=1e-12 * size)
    rest = adjoint[0] - adjoint[1] + adjoint[2]
    assert np.abs(rest).max() < 100 * integrator.rtol * size
    differences = da.sensitivity(motion, SPIN, method=da.FiniteDifference("richardson", 1e-3))
    np.testing.assert_allclose(differences.values[0], adjoint[0], rtol=0, atol=1e-7 * size)


@pytest.mark.few(5)
@pytest.mark.parametrize("kind", [da.integral, da.mean, da.rms])
@pytest.mark.parametrize("integrator", [da.RK4(), da.DormandPrince(), da.Radau(fixed=True)])
def test_outputs_do_not_matter(integrator, kind):
    runs = [
        Dynamics(0.5, step=None if integrator.adaptive else 0.02, integrator=integrator, outputs=n)
        for n in (None, 3, [0.1, 0.4])
    ]
    values = [da.evaluate(run.run(chain()), kind(SPEED)) for run in runs]
    np.testing.assert_allclose(values, values[0], rtol=1e-13)


def test_measures_may_vary_faster_than_the_motion():
    """A throw takes few steps; kinks and oscillations of measures between them count."""
    system = da.System("throw", gravity=(0, -10))
    rise = system.parameter("rise", 7.0)
    system.add(planar.Particle("stone", mass=2.0, position=(0, 1), velocity=(3, rise)))
    motion = da.solve_dynamics(system.build(), 2.0, integrator=da.DormandPrince())
    assert motion.statistics["steps"] < 20
    t = np.linspace(0, 2, 200_001)
    y, vy = 1 + 7 * t - 5 * t**2, 7 - 10 * t
    exact = {
        "sin(50*time)**2": np.sin(50 * t) ** 2,
        "sin(20*stone.y)": np.sin(20 * y),
        "abs(stone.vy)": np.abs(vy),
        "stone.y**6": y**6,
    }
    for measure, values in exact.items():
        size = np.trapezoid(np.abs(values), t)
        error = da.evaluate(motion, da.integral(measure)) - np.trapezoid(values, t)
        assert abs(error) < 1e-5 * size, measure
    slope = da.sensitivity(motion, da.integral("sin(20*stone.y)")).item()
    assert slope == pytest.approx(np.trapezoid(20 * t * np.cos(20 * y), t), abs=1e-4)


ORDERS = {"Euler": 1, "Heun": 2, "RK4": 4, "Trapezoidal": 2, "GeneralizedAlpha": 2, "Radau": 5}


@pytest.mark.few(2)
@pytest.mark.parametrize("name", ORDERS)
def test_integrals_of_fixed_steps_converge_with_the_order(name):
    integrator = da.Radau(fixed=True) if name == "Radau" else INTEGRATORS[name]
    fine = Dynamics(0.64, integrator=da.DormandPrince853(1e-13, 1e-13)).run(chain())
    exact = da.evaluate(fine, da.final("lower.angle")) - da.evaluate(fine, da.at(0, "lower.angle"))
    counts = np.array([8, 16] if name == "Radau" else [20, 40])
    errors = [
        abs(
            da.evaluate(
                Dynamics(0.64, step=0.64 / n, integrator=integrator, outputs=3).run(chain()), SPIN
            )
            - exact
        )
        for n in counts
    ]
    order = -np.diff(np.log(errors))[0] / np.log(2)
    assert order > ORDERS[name] - 0.35


def test_totals_add_the_outputs():
    motion = Dynamics(0.5, step=0.02, outputs=[0.1, 0.2, 0.45]).run(chain())
    total = da.total(SPEED)
    assert da.evaluate(motion, total) == pytest.approx(float(motion[SPEED].sum()), rel=1e-14)
    parts = [da.at(t, SPEED, name=f"{t}") for t in (0.1, 0.2, 0.45)]
    for method in ("adjoint", "direct"):
        expected = da.sensitivity(motion, parts, method=method).values.sum(axis=0)
        gradient = da.sensitivity(motion, total, method=method)
        np.testing.assert_allclose(gradient.values[0], expected, rtol=1e-12, atol=1e-14)
    assert gradient.response_unit.item() == motion.expression(SPEED).unit


CONTROLLED = [name for name, method in INTEGRATORS.items() if method.controls_error]


@pytest.mark.few(3)
@pytest.mark.parametrize("name", CONTROLLED)
def test_defaults_hold_six_digits_of_a_long_swing(name):
    """Ten seconds of a pendulum: what one method holds by default, the others hold too."""
    system = da.System("pendulum", gravity=(0.0, -9.81))
    rod = system.add(planar.Bar("rod", length=1.0, mass=1.0, angle=0.0))
    system.add(planar.Revolute("pin", system.ground.center, rod.start))
    model, end = system.build(), [10.0]
    fine = da.solve_dynamics(model, 10.0, outputs=end, integrator=da.DormandPrince853(1e-12, 1e-12))
    motion = da.solve_dynamics(model, 10.0, outputs=end, integrator=INTEGRATORS[name])
    np.testing.assert_allclose(motion.trajectory.y, fine.trajectory.y, rtol=0, atol=5e-7)
