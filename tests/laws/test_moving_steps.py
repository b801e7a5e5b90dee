"""Fixed steps that follow parameters, and instants that move: gradients are those of whole runs."""

from __future__ import annotations

import functools

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

RUNS = {
    "default steps": {"duration": "T", "integrator": da.BackwardEuler()},
    "a share of the duration": {"duration": "T", "step": "T/50", "integrator": da.HHT()},
    "RK4, outputs counted": {"duration": "T", "step": "T/30", "outputs": 21},
    "RK4, outputs listed": {"duration": "T", "step": "T/30", "outputs": [0.1, 0.503, "0.7*T"]},
    "the last step": {"duration": "T", "step": 0.05, "integrator": da.Heun()},
    "the step alone": {"duration": 1.013, "step": "l/(20 m/s)", "integrator": da.Newmark()},
    "corrected now and then": {
        "duration": "T",
        "step": "T/400 + l/(1000 m/s)",
        "stabilization": da.Projection(every=2),
    },
    "algorithmic damping": {"duration": "T", "step": "T/40", "integrator": da.GeneralizedAlpha()},
    "collocation": {"duration": "T", "step": "T/10", "integrator": da.Radau(fixed=True)},
    "up to an event": {
        "duration": "3*T",
        "step": "T/30",
        "events": {"low": da.Event("b.angle + 1.2", terminal=True)},
    },
}
RESPONSES = [
    da.integral("b.end.y"),
    da.final("b.end.x"),
    da.maximum("b.end.y", smooth="0.2 m"),
    da.rms("b.end.x"),
    da.total("b.end.y"),
    da.at(0.2073, "b.end.x"),
    da.integral("O.force.y"),
    da.at_event(da.Event("b.angle"), "b.angular_velocity", name="speed at zero"),
]


@functools.cache
def pendulum() -> da.Model:
    system = da.System("pendulum", gravity=(0, -9.81))
    system.parameter("T", 1.31, unit="s")
    length = system.parameter("l", 0.4, unit="m")
    bar = system.add(planar.Bar("b", length=length, mass=1.0, angle=0.3, angular_velocity=2.0))
    system.add(planar.Revolute("O", system.ground, bar.start))
    return system.build()


def whole_runs(model: da.Model, responses, name: str, h: float = 1e-4, **options) -> np.ndarray:
    """Differences of fourth order of runs of their own."""
    size = model.parameters[name].value

    def values(change: float) -> np.ndarray:
        motion = da.solve_dynamics(model, parameters={name: size * (1 + change)}, **options)
        return np.array([da.evaluate(motion, response) for response in responses])

    near, far = values(h) - values(-h), values(2 * h) - values(-2 * h)
    return (8 * near - far) / (12 * h * size)


@pytest.mark.few(1)
@pytest.mark.parametrize("name", RUNS)
def test_fixed_steps_that_follow_parameters(name):
    """The rerun takes other steps, and the gradient knows."""
    options = RUNS[name] | {"backend": "vm"}
    motion = da.solve_dynamics(pendulum(), **options)
    direct, adjoint = (
        da.sensitivity(motion, RESPONSES, method=method).values for method in ("direct", "adjoint")
    )
    wanted = np.column_stack(
        [whole_runs(pendulum(), RESPONSES, p, **options) for p in pendulum().parameters]
    )
    size = np.abs(wanted).max(axis=1, keepdims=True)
    np.testing.assert_allclose(direct / size, adjoint / size, rtol=0, atol=1e-10)
    np.testing.assert_allclose(adjoint / size, wanted / size, rtol=0, atol=1e-6)


@pytest.mark.thorough
def test_certificates_run_fixed_steps_anew():
    """A gradient that holds the steps is contradicted; 2.6 % were lacking here."""
    motion = da.solve_dynamics(pendulum(), backend="vm", **RUNS["default steps"])
    gradient = da.sensitivity(motion, RESPONSES[:2], certificate=True)
    assert gradient.attrs["certificate"].passed
    assert not any("at fixed times" in line for line in gradient.attrs["certificate"].summary())
    differences = da.sensitivity(motion, RESPONSES[:2], method="finite-difference")
    np.testing.assert_allclose(differences, gradient, rtol=1e-8)


def test_steps_of_structures_that_follow_parameters_are_refused():
    bar = da.Structure("oscillator")
    period = bar.parameter("T", 1.0, unit="s")
    start, end = bar.node("a", 0), bar.node("b", 1)
    bar.add(da.structures.AxialSpring("spring", start, end, stiffness=100.0))
    bar.add(da.structures.PointMass("mass", end, mass=1.0))
    bar.support(start)
    bar.initial(end, vx=2.0)
    assert period is not None
    motion = da.solve_transient(bar.build(), 1.0, step="T/50")
    with pytest.raises(da.UnsupportedError, match="step of the dynamics follows"):
        da.sensitivity(motion, da.final("b.ux"))


BOUNCES = [
    da.maximum("ball.vy", smooth="0.3 m/s", name="smooth speed"),
    da.minimum("ball.vy", name="speed of the impact"),
    da.maximum("ball.y", smooth="0.2 m", name="smooth height"),
    da.integral("ball.vy**2"),
    da.mean("ball.vy"),
    da.rms("ball.vy"),
    da.total("ball.vy"),
    da.final("ball.y"),
]


@functools.cache
def bouncing_ball() -> da.Model:
    contact = planar.contact
    system = da.System("bounce", gravity=(0, -10.0))
    height, cr = system.parameter("height", 0.83, unit="m"), system.parameter("cr", 0.7)
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0, height), velocity=(1, 0)))
    floor = contact.HalfPlane(system.ground.center, normal=(0, 1))
    tip = contact.Vertex(ball.center)
    system.add(planar.Contact("floor", floor, tip, law=contact.Restitution(cr)))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "options",
    [
        {"step": 0.013},
        {"step": 0.013, "outputs": 41},
        {"integrator": da.DormandPrince(1e-9, 1e-11), "outputs": 41},
        {"step": "height/(79 m/s)"},
    ],
    ids=["fixed", "outputs", "adaptive", "steps that follow"],
)
def test_responses_over_impacts_that_move(options):
    """Two impacts: what jumps there, and what is sampled there."""
    options = {"duration": 1.0, "backend": "vm"} | options
    motion = da.solve_dynamics(bouncing_ball(), **options)
    assert len(motion.impacts) == 2
    gradient = da.sensitivity(motion, BOUNCES, method="direct")
    adjoint = da.sensitivity(motion, BOUNCES, method="adjoint").values
    wanted = np.column_stack(
        [whole_runs(bouncing_ball(), BOUNCES, p, h=1e-5, **options) for p in ("height", "cr")]
    )
    size = np.abs(wanted).max(axis=1, keepdims=True) + 1e-9
    np.testing.assert_allclose(gradient / size, adjoint / size, rtol=0, atol=1e-9)
    np.testing.assert_allclose(gradient / size, wanted / size, rtol=0, atol=1e-6)
    assert not any("jumps" in note for note in gradient.attrs["notes"])
    if "outputs" not in options:  # closed form: v = -√(2 g H)
        assert gradient.values[1] == pytest.approx([-np.sqrt(10 / (2 * 0.83)), 0], abs=1e-6)


@pytest.mark.thorough
def test_a_certificate_over_impacts():
    motion = da.solve_dynamics(bouncing_ball(), 0.6, step=0.013, backend="vm")
    gradient = da.sensitivity(motion, BOUNCES[3:5], ["height"], certificate=True)
    assert gradient.attrs["certificate"].passed
