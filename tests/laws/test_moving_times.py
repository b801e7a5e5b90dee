"""Times that follow parameters: gradients are those of whole runs made anew."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

RESPONSES = [
    da.final("crank.end.x"),
    da.integral("crank.end.y"),
    da.rms("crank.end.y"),
    da.maximum("crank.end.y", smooth=0.2, name="highest"),
    da.total("crank.end.x"),
    da.at(0.2, "crank.end.x"),
]


def crank(driven: bool) -> da.Model:
    system = da.System("crank", gravity=(0.0, -9.81))
    speed = system.parameter("speed", 5.0, unit="rad/s")
    length = system.parameter("length", 0.4, unit="m")
    bar = planar.Bar("crank", length=length, mass=1.0, angle=0.3, angular_velocity=speed)
    system.add(bar)
    system.add(planar.Revolute("O", system.ground, bar.start))
    if driven:
        system.add(planar.RotationalDriver("motor", system.ground, bar, law=0.3 + speed * da.t))
    return system.build()


def whole_runs(solve, model, responses, name: str, h: float = 1e-3) -> np.ndarray:
    """Differences of fourth order of runs of their own, by one parameter."""

    def values(change: float) -> np.ndarray:
        p = {name: model.parameters[name].value * (1 + change)}
        return np.array([da.evaluate(solve(parameters=p), r) for r in responses])

    size = model.parameters[name].value
    near, far = values(h) - values(-h), values(2 * h) - values(-2 * h)
    return (8 * near - far) / (12 * h * size)


@pytest.mark.few(1)
@pytest.mark.parametrize("driven", [True, False])
@pytest.mark.parametrize(
    "times",
    [
        {"duration": "2.5/speed", "outputs": 41},
        {"duration": "2.5/speed", "step": 1e-3},
        {"t_span": (0.0, "1.2*length"), "outputs": [0.1, "0.2 s", "0.8*length", 0.45]},
    ],
)
def test_gradients_are_those_of_whole_runs(driven, times):
    model = crank(driven)
    verb = da.solve_kinematics if driven else da.solve_dynamics
    chosen = {} if driven else {"integrator": da.DormandPrince(1e-11, 1e-11)}
    if not driven:
        times = {k: v for k, v in times.items() if k != "step"} | {"outputs": 41}

    def solve(parameters=None):
        return verb(model, parameters=parameters, **times, **chosen)

    motion = solve()
    responses = RESPONSES if "step" not in times else RESPONSES[:3]  # whose count of outputs jumps
    results = {
        method: da.sensitivity(motion, responses, method=method).values
        for method in ("direct", "adjoint")
    }
    wanted = np.column_stack([whole_runs(solve, model, responses, n) for n in ("speed", "length")])
    np.testing.assert_allclose(results["direct"], wanted, rtol=2e-6, atol=2e-6 * abs(wanted).max())
    np.testing.assert_allclose(results["direct"], results["adjoint"], rtol=1e-10, atol=1e-12)


def test_a_whole_turn_is_one_at_any_speed():
    """Closed form: after ``2π/ω`` the crank stands where it began; its mean height is none."""
    motion = da.solve_kinematics(crank(True), "2*pi/speed", outputs=65)
    gradient = da.sensitivity(motion, [da.final("crank.end.x"), da.mean("crank.end.y")], ["speed"])
    np.testing.assert_allclose(gradient.values, 0.0, atol=1e-10)
    checked = da.sensitivity(motion, da.final("crank.end.x"), ["speed"], certificate=True)
    assert checked.attrs["certificate"].passed
    assert "at fixed times" not in checked.attrs["certificate"].summary()[-1]
    again = motion.analysis.run(motion.model, {"speed": 10.0})
    assert again.time[-1] == pytest.approx(np.pi / 5, rel=1e-15)


def test_an_event_that_ends_the_run_says_when():
    """A pendulum thrown upwards passes a height: the planned end says nothing then."""
    model = crank(False)
    ends = {"passes": da.Event("crank.angle - 0.6", terminal=True)}
    runs = [
        da.solve_dynamics(model, duration, step=1e-3, events=ends) for duration in (2.0, "10/speed")
    ]
    assert all(motion.status.outcome is da.Outcome.TERMINATED for motion in runs)
    fixed, moving = (da.sensitivity(motion, [RESPONSES[0], RESPONSES[1]]) for motion in runs)
    np.testing.assert_allclose(moving, fixed, rtol=1e-9)


def test_unavailable_methods_are_refused():
    model = crank(False)
    motion = da.solve_dynamics(model, t_span=("0.01*speed", 1.0), step=1e-2)
    with pytest.raises(da.UnsupportedError, match="start of the run follows"):
        da.sensitivity(motion, RESPONSES[0])
    assert da.sensitivity(motion, RESPONSES[0], ["length"]).size == 1
    motion = da.solve_dynamics(model, "2/speed", step=1e-2)
    with pytest.raises(da.UnsupportedError, match="at fixed times only"):
        da.hessian_product(motion, RESPONSES[0], [1.0, 0.0])
