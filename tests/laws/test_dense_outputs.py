"""Runs with error control show, and responses see, the motion between the ends of its steps."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import dalembert as da
from dalembert import planar
from dalembert.analysis.timeline import MIN_STEPS, Pace

G, E = 9.81, 0.8
INTEGRATORS = {
    "default": {},
    "DormandPrince853": {"integrator": da.DormandPrince853()},
    "Radau": {"integrator": da.Radau()},
    "BDF": {"integrator": da.BDF(1e-9)},
}


@cache
def ball() -> da.Model:
    """It falls from a height h and bounces on a floor."""
    system = da.System("ball", gravity=(0, -G))
    height = system.parameter("h", 1.0)
    body = system.add(planar.Particle("ball", mass=1.0, position=(0, height)))
    system.add(planar.UnilateralConstraint("floor", body.y, restitution=E))
    return system.build()


@cache
def pendulum() -> da.Model:
    """A thin bar that is let go from an angle a to the vertical."""
    system = da.System("pendulum", gravity=(0, -G))
    angle = system.parameter("a", 1.0)
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0, angle=angle - pi / 2))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    return system.build()


@cache
def sliding() -> da.Model:
    """An oscillator with dry friction, whose acceleration jumps where it turns back."""
    system = da.System("rubbed", gravity=(0, -G))
    start = system.parameter("start", 1.0)
    body = system.add(planar.Particle("body", mass=1.0, position=(start, 0)))
    system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    pull = planar.Force("pull", body.center, (-100 * body.x - 5 * da.sign(body.vx), 0))
    system.add(pull)
    return system.build()


def heights(t: np.ndarray) -> np.ndarray:
    """Of the bouncing ball, until bounces become short."""
    t, speed, computed = t - sqrt(2 / G), sqrt(2 * G), 1 - G * t**2 / 2
    while t.max() > 0:
        speed *= E
        computed = np.where(t > 0, speed * t - G * t**2 / 2, computed)
        t = t - 2 * speed / G
    return computed


@pytest.mark.few(2)
@pytest.mark.parametrize("name", INTEGRATORS)
def test_straight_lines_between_outputs_follow_the_motion(name):
    """Also where few steps lead far; and both sides of a jump are outputs."""
    motion = da.solve_dynamics(ball(), 3.0, **INTEGRATORS[name])
    t = np.linspace(0, 3, 2001)
    assert motion.time.size < 1000 and np.all(np.diff(motion.time) > 0)
    lines = np.interp(t, motion.time, motion["ball.y"])
    np.testing.assert_allclose(lines, heights(t), atol=4e-3)
    for impact in motion.impacts:
        (k,) = np.flatnonzero(motion.time == impact.time)
        before, after = motion.values("ball.vy")[k - 1 : k + 1]
        assert after == pytest.approx(-E * before, rel=1e-6) and after > 0
    motion = da.solve_dynamics(pendulum(), 5.0, **INTEGRATORS[name])
    for measure in ("bar.angle", "bar.angular_velocity", "bar.end.ax", "O.force.y"):
        exact = motion.at(t)[measure].values
        lines = np.interp(t, motion.time, motion[measure])
        np.testing.assert_allclose(lines, exact, atol=4e-3 * np.ptp(exact))


def expected() -> dict[str, tuple]:
    """Model, duration, response, its value and its derivative."""
    fast = sqrt(2 * G)
    first, up = sqrt(2 / G), E * fast
    near = (up + 4) / (G + 4)  # of the largest y − 2 (t − t₁ − 1)², by the time since the impact
    spin = sqrt(3 * G * (1 - cos(1)))
    return {
        "apex after one bounce": (ball, 1.1, da.maximum("ball.y - 10*(t < 0.5)"), E**2, E**2),
        "beside a parabola": (
            *(ball, 1.1, da.maximum(f"ball.y - 2*(t - {first + 1})**2 - 10*(t < 0.5)")),
            up * near - G * near**2 / 2 - 2 * (near - 1) ** 2,
            near * up / 2 - 4 * (near - 1) * first / 2,
        ),
        "before an impact": (ball, 1.1, da.minimum("ball.vy"), -fast, -fast / 2),
        "after an impact": (ball, 1.1, da.maximum("ball.vy"), up, up / 2),
        "lowest": (ball, 1.1, da.minimum("ball.y"), 0.0, 0.0),
        "spin": (pendulum, 3.0, da.maximum("bar.angular_velocity"), spin, 1.5 * G * sin(1) / spin),
        "turns back": (pendulum, 1.2, da.minimum("bar.angle"), -1 - pi / 2, -1.0),
        "fast formula": (pendulum, 1.2, da.maximum("sin(40*bar.angle)"), 1.0, 0.0),
        "reaction": (
            *(pendulum, 3.0, da.maximum("O.force_norm")),
            *(G * (2.5 - 1.5 * cos(1)), 1.5 * G * sin(1)),
        ),
        "before friction turns": (sliding, 0.5, da.maximum("body.ax"), 100 * 0.9 + 5, 100.0),
    }


@pytest.mark.few(1)
@pytest.mark.parametrize(("name", "outputs"), [*((n, None) for n in INTEGRATORS), ("default", 5)])
def test_extremes_are_those_of_the_motion(name, outputs):
    """Values and derivatives by closed forms, whatever the outputs; all methods agree."""
    for case, (model, duration, response, value, slope) in expected().items():
        motion = da.solve_dynamics(model(), duration, outputs=outputs, **INTEGRATORS[name])
        assert da.evaluate(motion, response) == pytest.approx(value, rel=1e-6, abs=1e-9), case
        direct, adjoint, differences = (
            da.sensitivity(motion, response, method=m).item()
            for m in ("direct", "adjoint", da.FiniteDifference("richardson", 1e-4))
        )
        assert direct == pytest.approx(adjoint, rel=1e-11, abs=1e-9), case
        assert direct == pytest.approx(differences, rel=1e-6, abs=1e-6), case
        assert direct == pytest.approx(slope, rel=1e-5, abs=1e-6), case


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["default", "DormandPrince853", "BDF"])
def test_smooth_extremes_are_means_over_time(name):
    """``(1/ρ) ln((1/T) ∫ exp(ρ m) dt)``, also where an event ends the run within its only step."""
    ended = {"half": da.Event("ball.y - 0.5", terminal=True)}
    fall, rho = sqrt(1 / G), 60.0
    response = da.minimum("ball.y", smooth=f"{1 / rho} m")
    motion = da.solve_dynamics(ball(), 1.0, **INTEGRATORS[name], events=ended)

    def smooth(height: float) -> float:
        end = sqrt(2 * (height - 0.5) / G)
        mean = quad(lambda t: np.exp(-rho * (height - 0.5 - G * t**2 / 2)), 0, end)[0] / end
        return 0.5 - np.log(mean) / rho

    assert motion.time[-1] == pytest.approx(fall) and motion.status.success
    assert da.evaluate(motion, response) == pytest.approx(smooth(1.0), rel=1e-8)
    slope = (smooth(1 + 1e-4) - smooth(1 - 1e-4)) / 2e-4
    for method in ("direct", "adjoint"):
        derivative = da.sensitivity(motion, response, method=method).item()
        assert derivative == pytest.approx(slope, rel=1e-6)
    exact = da.hessian_product(
        da.solve_dynamics(pendulum(), 1.0, integrator=da.DormandPrince()),
        da.maximum("bar.angular_velocity", smooth="0.2 rad/s"),
        {"a": 1.0},
    ).item()
    step = 1e-4
    slopes = [
        da.sensitivity(
            da.solve_dynamics(
                pendulum(), 1.0, integrator=da.DormandPrince(), parameters={"a": 1 + s * step}
            ),
            da.maximum("bar.angular_velocity", smooth="0.2 rad/s"),
        ).item()
        for s in (-1, 1)
    ]
    assert exact == pytest.approx(np.diff(slopes).item() / (2 * step), rel=1e-4)


def test_second_derivatives_of_a_moving_extreme_are_refused():
    motion = da.solve_dynamics(pendulum(), 1.0)
    with pytest.raises(da.UnsupportedError, match=r"instant of an extreme.*smooth"):
        da.hessian_product(motion, da.maximum("bar.angular_velocity"), {"a": 1.0})


@pytest.mark.parametrize("name", INTEGRATORS)
def test_events_there_and_back_within_a_step_are_located(name):
    """Rising and falling again at both sides of the apex; the run ends at the first of them."""
    speed, first = E * sqrt(2 * G), sqrt(2 / G)
    apart = sqrt(speed**2 - 2 * G * 0.6)
    times = [sqrt(0.8 / G), first + (speed - apart) / G, first + (speed + apart) / G]
    event = da.Event("ball.y - 0.6")
    run = INTEGRATORS[name]
    motion = da.solve_dynamics(ball(), 1.1, events={"high": event}, **run)
    computed = [(e.time, e.direction) for e in motion.events]
    assert np.array(computed) == pytest.approx(np.column_stack([times, (-1, 1, -1)]), rel=1e-8)
    number = da.event_time(da.Event("ball.y - 0.6", direction=-1), 2)
    assert da.evaluate(motion, number) == pytest.approx(times[2], rel=1e-8)
    rising = {"up": da.Event("ball.y - 0.6", direction=1, terminal=True)}
    motion = da.solve_dynamics(ball(), 1.1, events=rising, **run)
    assert motion.status.outcome is da.Outcome.TERMINATED
    assert motion.time[-1] == pytest.approx(times[1], rel=1e-8)


def test_each_design_of_a_batch_has_its_own_extreme():
    angles = [0.4, 1.0, 1.6]
    many = da.solve_dynamics(
        pendulum(), 1.2, parameters={"a": angles}, outputs=7, integrator=da.DormandPrince()
    )
    computed = da.evaluate(many, da.minimum("bar.angular_velocity")).values
    np.testing.assert_allclose(computed, [-sqrt(3 * G * (1 - cos(a))) for a in angles], rtol=1e-6)


def test_few_short_steps_tell_nothing_about_the_rest():
    """Of 1e-14 of the run at first; later they do."""
    pace = Pace(0.0, 5.0, 100.0)
    assert not pace.exceeds(np.array([0, 1e-14, 2e-14]))
    times = 1e-12 * np.arange(2 * MIN_STEPS)
    refused = [pace.exceeds(times[a : b + 1]) for a, b in pairwise(range(0, times.size, 50))]
    assert any(refused) and not any(refused[: MIN_STEPS // 50 - 1])
    assert "at the pace of the last" in pace.excess


@pytest.mark.parametrize("rate", [100.0, 1500.0])
def test_a_surface_that_moves_faster_than_the_steps_is_met_when_it_is_reached(rate):
    """A particle falls on a vibrating floor; the first meeting is a root of the closed form."""
    system = da.System("table", gravity=(0, -G))
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0.3)))
    gap = ball.y - 0.02 * da.sin(rate * da.t)
    system.add(planar.UnilateralConstraint("floor", gap, restitution=0.6))
    motion = da.solve_dynamics(system.build(), 0.6)

    def distance(t):
        return 0.3 - G * t**2 / 2 - 0.02 * np.sin(rate * t)

    times = np.linspace(0, 0.4, 40001)
    k = int(np.argmax(distance(times) < 0))
    first = brentq(distance, *times[k - 1 : k + 1], xtol=1e-13)
    assert motion.status.success and motion.impacts[0].time == pytest.approx(first, abs=1e-9)
    assert distance(0.0) > 0 and (motion.values(gap) > -1e-9).all()
