"""Batches of mechanisms with states of first order and sampled blocks are their single runs."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np
import pytest

import dalembert as da
from dalembert import planar


def cabin(system: da.System) -> tuple[planar.Particle, planar.PinInSlot]:
    """A cabin of 2 kg on a vertical rail."""
    body = system.add(planar.Particle("cabin", mass=2.0))
    rail = system.add(planar.PinInSlot("rail", system.ground.center, body.center, axis=(0, 1)))
    return body, rail


def controlled() -> da.Model:
    """A PID controller holds the weight; its integral is that force."""
    system = da.System("controlled", gravity=(0, -10))
    value, gain = system.parameter("value", 1.0), system.parameter("gain", 80.0)
    body, _ = cabin(system)
    gains = {"proportional": gain, "integral": 60.0, "derivative": 40.0, "filter_time": 0.02}
    pid = system.add(da.blocks.PID("pid", value, body.y, **gains))
    system.add(planar.Force("drive", body.center, (0, pid.output)))
    return system.build()


def sampled() -> da.Model:
    """The same by samples of a held position; large gains are unstable."""
    system = da.System("sampled", gravity=(0, -10))
    value, gain = system.parameter("value", 1.0), system.parameter("gain", 80.0)
    body, _ = cabin(system)
    gains = {"proportional": gain, "integral": 60.0, "derivative": 40.0, "filter_time": 0.02}
    seen = system.add(da.blocks.ZeroOrderHold("seen", body.y, sample_time=0.05)).output
    pid = system.add(da.blocks.SampledPID("pid", value, seen, sample_time=0.05, **gains))
    system.add(planar.Force("drive", body.center, (0, pid.output)))
    return system.build()


def levitation() -> da.Model:
    """A ball below a magnet, unstable without a gain; nonlinear forces and states."""
    system = da.System("levitation", gravity=(0, -9.81))
    value, gain = system.parameter("value", 2.2, "A"), system.parameter("gain", 2000.0)
    ball = system.add(planar.Particle("ball", mass=0.5, position=(0, -0.01)))
    system.add(planar.PinInSlot("rail", system.ground.center, ball.center, axis=(0, 1)))
    current = system.add(da.blocks.State("current", start=2.2, unit="A"))
    gap = -ball.y
    system.add(planar.Force("magnet", ball.center, (0, 1e-4 * current.value**2 / gap**2)))
    control = gain * (gap - 0.01) - 0.05 * gain * ball.vy
    current.rate = (value + control - current.value) / 0.01
    return system.build()


def steady() -> da.Model:
    """A closed loop on a soft spring, whose state begins at rest, near one of three roots."""
    system = da.System("four-bar", gravity=(0, -9.81))
    value, gain = system.parameter("value", 0.3, "m"), system.parameter("gain", 2.0)
    crank = system.add(planar.Bar("crank", length=value, mass=1.5, angle=1.2))
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=5.0))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=3.0, angle=1.0))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    spring = {"stiffness": 60.0, "free_angle": 0.8}
    system.add(planar.TorsionSpring("spring", system.ground, crank, **spring))
    x = system.add(da.blocks.State("x", steady=True))
    x.rate = gain * da.sin(crank.angle) - x.value**3 - x.value
    system.add(planar.Torque("motor", crank, 5 * x.value))
    return system.build()


MODELS: dict[str, tuple[Callable[[], da.Model], dict, list[str]]] = {
    "controller": (
        controlled,
        {"value": [0.4, 1.5, 1.0, -2.0], "gain": [80.0, 150.0, 0.5, 300.0]},
        ["cabin.y", "pid.integral", "rail.force"],
    ),
    "sampled": (
        sampled,
        {"value": [0.4, 1.5, 1.0, -2.0], "gain": [80.0, 200.0, 900.0, 120.0]},
        ["cabin.y", "pid.integral", "pid.output"],
    ),
    "levitation": (
        levitation,
        {"value": [2.0, 2.2, 2.3, 2.4], "gain": [2000.0, 0.0, 1500.0, 3000.0]},
        ["ball.y", "current.value"],
    ),
    "steady start": (
        steady,
        {"value": [0.25, 0.3, 0.35, 0.4], "gain": [1.0, 2.0, 3.0, 4.0]},
        ["crank.angle", "x.value", "B.force"],
    ),
}


@pytest.mark.few(1)
@pytest.mark.parametrize("name", MODELS)
def test_equilibria_are_solved_together_as_alone(name):
    build, designs, measures = MODELS[name]
    model = build()
    batch = da.solve_equilibrium(model, parameters=designs)
    assert batch.statistics["designs run on their own"] == 0
    stable = []
    for k in range(4):
        values = {n: v[k] for n, v in designs.items()}
        single = da.solve_equilibrium(model, parameters=values)
        computed, expected = batch.statuses[k], single.status
        numbers = r"residual \S+ N|after \d+ iterations?"
        texts = [re.sub(numbers, "", s.message) for s in (computed, expected)]
        assert computed.outcome == expected.outcome and texts[0] == texts[1]
        counts = [int(re.findall(r"after (\d+)", s.message)[0]) for s in (computed, expected)]
        assert abs(counts[0] - counts[1]) <= 1  # the last one may be within rounding
        assert max(computed.residual, expected.residual) < 1e-10
        stable.append("not a stable position" not in computed.message)
        if name == "sampled":
            plant = da.Stepper(model, step=0.05)
            plant.reset(motion=single)
            assert plant.state_space().stable == stable[-1]
        for measure in measures:
            wanted = single.values(measure)
            size = np.abs(wanted).max() or 1.0
            assert np.abs(batch.values(measure)[k] - wanted).max() < 1e-12 * size
    if name == "controller":  # Routh, without the filter: stable for gain · 40 > 2 · 60
        assert stable == [gain > 3 for gain in designs["gain"]]
    assert any(stable) and all(stable) == (name == "steady start")


@pytest.mark.few(1)
@pytest.mark.parametrize("method", ["direct", "adjoint"])
@pytest.mark.parametrize("name", MODELS)
def test_gradients_of_equilibria_are_those_of_single_ones(name, method):
    build, designs, measures = MODELS[name]
    model = build()
    responses = [da.final(f"{m}.y" if m.endswith(".force") else m) for m in measures]
    batch = da.solve_equilibrium(model, parameters=designs)
    gradient = da.sensitivity(batch, responses, method=method)
    for k in range(4):
        single = da.solve_equilibrium(model, parameters={n: v[k] for n, v in designs.items()})
        expected = da.sensitivity(single, responses, method=method).values
        size = np.abs(expected).max()
        np.testing.assert_allclose(gradient[k], expected, rtol=0, atol=1e-12 * size)


def test_values_of_a_controlled_cabin_in_closed_form():
    """``y = target`` and an integral of ``m g``, whatever the gain; of levitation, ``F = m g``."""
    designs = MODELS["sampled"][1]
    for build in (controlled, sampled):
        batch = da.solve_equilibrium(build(), parameters=designs)
        np.testing.assert_allclose(batch.values("cabin.y")[:, 0], designs["value"], rtol=1e-9)
        np.testing.assert_allclose(batch.values("pid.integral")[:, 0], 20.0, rtol=1e-9)
    batch = da.solve_equilibrium(levitation(), parameters=MODELS["levitation"][1])
    pull = 1e-4 * (batch.values("current.value") / batch.values("ball.y")) ** 2
    np.testing.assert_allclose(pull, 0.5 * 9.81, rtol=1e-9)


def weak() -> da.Model:
    """A motor with a limit lifts a mass on a bar; heavy masses exceed it."""
    system = da.System("weak", gravity=(0, -9.81))
    mass, inertia = system.parameter("mass", 1.0, "kg"), system.parameter("speed", 5.0, "1/s")
    bar = system.add(planar.Bar("bar", length=1.0, mass=mass, angle=0.2))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    state = system.add(da.blocks.State("torque", start=0.0, unit="N m"))
    state.rate = inertia * (20.0 * (0.3 - bar.angle) - state.value)
    grip = 10.0 * da.atan(state.value / 10.0)
    system.add(planar.Torque("motor", bar, grip - 0.2 * bar.angular_velocity))
    return system.build()


def test_failed_designs_have_the_status_of_their_single_run():
    masses = [1.0, -1.0, 2.0, np.nan, 1.5]
    model = weak()
    batch = da.solve_equilibrium(model, parameters={"mass": masses})
    for k, mass in enumerate(masses):
        if k in (1, 3):
            with pytest.raises(da.DalembertError) as error:
                da.solve_equilibrium(model, parameters={"mass": mass})
            assert batch.statuses[k].message == str(error.value)
            assert not batch.statuses[k].success
            continue
        single = da.solve_equilibrium(model, parameters={"mass": mass})
        assert batch.statuses[k].outcome == single.status.outcome
        np.testing.assert_allclose(
            batch.values("bar.angle")[k], single.values("bar.angle"), rtol=1e-12
        )


def test_endless_samples_are_refused_by_design():
    """A counter has no fixed point, and every value is one if it does not count."""
    system = da.System("counter", gravity=(0, -10))
    step = system.parameter("step", 0.0)
    body, _ = cabin(system)
    count = system.add(da.blocks.SampledState("count", sample_time=0.1))
    count.next = count.value + step
    pid = da.blocks.PID("pid", 1.0, body.y, proportional=80.0, integral=60.0, derivative=40.0)
    system.add(planar.Force("drive", body.center, (0, system.add(pid).output)))
    model = system.build()
    batch = da.solve_equilibrium(model, parameters={"step": [0.0, 1.0, -0.5]})
    assert not any(status.success for status in batch.statuses)
    for k, value in ((1, 1.0), (2, -0.5)):
        with pytest.raises(da.AnalysisError, match=r"count\.value changes") as error:
            da.solve_equilibrium(model, parameters={"step": value})
        assert batch.statuses[k].message == str(error.value)
    assert batch.statuses[0].outcome == da.solve_equilibrium(model).status.outcome


def test_states_that_any_position_keeps_are_reported():
    system = da.System("brake", gravity=(0, -10))
    stiffness = system.parameter("stiffness", 100.0, "N/m")
    body, _ = cabin(system)
    system.add(planar.Spring("spring", system.ground.point(0, 1), body.center, stiffness=stiffness))
    x = system.add(da.blocks.State("path", start=0.1, unit="m"))
    x.rate = body.vy
    model = system.build()
    batch = da.solve_equilibrium(model, parameters={"stiffness": [50.0, 100.0]})
    single = da.solve_equilibrium(model)
    assert batch.warnings == single.warnings and "keep their values" in batch.warnings[0]
    np.testing.assert_allclose(batch.values("cabin.y")[1], single.values("cabin.y"), rtol=1e-12)


@pytest.mark.parametrize("options", [{"step": 0.01}, {}], ids=["fixed steps", "error control"])
def test_dynamics_from_steady_states_marches_in_lanes(options):
    model, designs = steady(), MODELS["steady start"][1]
    batch = da.solve_dynamics(model, 0.2, outputs=3, parameters=designs, **options)
    assert batch.statistics["designs run on their own"] == 0
    for k in range(4):
        values = {n: v[k] for n, v in designs.items()}
        single = da.solve_dynamics(model, 0.2, outputs=3, parameters=values, **options)
        angle, gain = single["crank.angle"][0].item(), values["gain"]
        start = single["x.value"][0].item()
        assert start**3 + start == pytest.approx(gain * np.sin(angle), abs=1e-11)
        for measure in ("crank.angle", "x.value"):
            np.testing.assert_allclose(
                batch.values(measure)[k], single.values(measure), rtol=0, atol=1e-12
            )
