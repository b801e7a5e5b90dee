"""Sampled loops against hand-written equations between samples, python-control and differences."""

import functools

import control
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar, spatial
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.symbolic.formulas.expression import Expression

G, L, M = 9.81, 0.8, 1.3
GAIN = 5.0
END = 1.5
FAST, SLOW, PHASE = 0.07, 0.11, 0.03
"""Sample times of two rates, no multiples of each other, and the first sample of the slow one."""


def pendulum(**pid) -> da.System:
    """A point mass on a rod with a torque about its pivot, and outputs of its angle."""
    system = da.System("pendulum", gravity=(0, -G))
    rod = system.add(planar.Body("rod", mass=M, inertia=M * L**2 / 12, angle=0.4))
    system.add(planar.Revolute("pivot", system.ground.center, rod.point(-L / 2, 0)))
    return system


def held_pendulum(t, x, torque):
    """``(M L²/3) θ̈ = −M g (L/2) cos θ + τ``."""
    return [x[1], (torque - M * G * L / 2 * np.cos(x[0])) / (M * L**2 / 3)]


def between(x, start, end, torque):
    if end <= start:
        return x
    options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13, "args": (torque,)}
    return solve_ivp(held_pendulum, (start, end), x, **options).y[:, -1]


@functools.cache
def two_rates() -> da.Model:
    """A filtered, delayed and quantised angle for a PID controller of another rate and phase."""
    system = pendulum()
    gain = system.parameter("gain", GAIN)
    rod, b = system.elements["rod"], da.blocks
    law = {"numerator": (0.5,), "denominator": (1, -0.5)}
    smooth = system.add(b.SampledTransferFunction("smooth", rod.angle, sample_time=FAST, **law))
    late = system.add(b.Delay("late", smooth.output, samples=2, sample_time=FAST, start=0.4))
    adc = b.Quantizer("adc", late.output, resolution=1e-3, sample_time=SLOW, first_sample=PHASE)
    system.add(adc)
    gains = {"proportional": gain, "integral": 4.0, "derivative": 0.8, "filter_time": 0.05}
    timing = {"sample_time": SLOW, "first_sample": PHASE}
    limits = {"lower": -4.0, "upper": 12.0, "tracking_time": 0.4}
    setpoint = 0.2 + 0.1 * da.sin(2 * da.t)
    pid = b.SampledPID("pid", setpoint, adc.output, **gains, **timing, **limits)
    system.add(pid)
    system.add(planar.Torque("motor", rod, pid.output))
    return system.build()


def two_rates_by_hand():
    """Angle, speed and torque at the end."""
    events = [(FAST * k, "fast") for k in range(int(END / FAST) + 1)]
    events += [(PHASE + SLOW * k, "slow") for k in range(int((END - PHASE) / SLOW) + 1)]
    x, time, torque = np.array([0.4, 0.0]), 0.0, 0.0
    smooth = past = integral = derived = previous = 0.0
    delayed, late, first = [0.4, 0.4], 0.4, True
    for instant, kind in sorted((round(e[0], 9), e[1]) for e in events if e[0] < END):
        x, time = between(x, time, instant, torque), instant
        if kind == "fast":  # 0.5/(z − 0.5): w[k] = 0.5 w[k−1] + 0.5 u[k−1]
            smooth, past = (0.5 * smooth + 0.5 * past if instant else 0.0), x[0]
            late, delayed = delayed[0], [delayed[1], smooth]
            continue
        y, r = 1e-3 * np.floor(late / 1e-3 + 0.5), 0.2 + 0.1 * np.sin(2 * time)
        derived = 0.0 if first else (0.05 * derived + 0.8 * (-y - previous)) / (0.05 + SLOW)
        wish = GAIN * (r - y) + integral + derived
        torque, previous, first = min(max(wish, -4.0), 12.0), -y, False
        integral += SLOW * (4.0 * (r - y) + (torque - wish) / 0.4)
    return np.append(between(x, time, END, torque), torque)


@pytest.mark.few(2)
@pytest.mark.parametrize(
    "options",
    [
        {"integrator": da.DormandPrince(rtol=1e-11, atol=1e-13)},
        {"integrator": da.Radau(rtol=1e-10, atol=1e-12)},
        {"integrator": da.RK4(), "step": 0.0005},
        {
            "integrator": da.DormandPrince(rtol=1e-11, atol=1e-13),
            "coordinates": da.JointCoordinates(),
        },
    ],
    ids=["DormandPrince", "Radau", "RK4", "joint coordinates"],
)
def test_two_rates_and_a_phase(options):
    motion = da.solve_dynamics(two_rates(), END, **options)
    values = [motion[n][-1].item() for n in ("rod.angle", "rod.angular_velocity", "pid.output")]
    assert np.allclose(values, two_rates_by_hand(), rtol=0, atol=1e-9)


def test_stepper_of_two_rates():
    """Steps of a hundredth of a second contain all instants."""
    outputs = ["rod.angle", "rod.angular_velocity", "pid.output"]
    plant = da.Stepper(two_rates(), step=0.01, substeps=8, outputs=outputs)
    for _ in range(round(END / 0.01)):
        y = plant.step()
    assert np.allclose(y, two_rates_by_hand(), rtol=0, atol=1e-9)


@pytest.mark.few(2)
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"integrator": da.Radau()},
        {"integrator": da.GeneralizedAlpha(), "step": 0.02},
        {"integrator": da.Trapezoidal(), "step": 0.03},
        {"step": 0.013, "formulation": da.NullSpace()},
    ],
    ids=["automatic", "Radau", "GeneralizedAlpha", "Trapezoidal", "NullSpace"],
)
def test_spatial_body_under_a_held_force(options):
    """A spinning body above a sampled spring, whose height is a parabola between samples."""
    system = da.System("hover", gravity=(0, 0, -G))
    motion = {"position": (0, 0, 0.3), "angular_velocity": (1, 2, 3)}
    body = system.add(spatial.Body("body", mass=1.0, inertia=(0.1, 0.2, 0.3), **motion))
    timing = {"sample_time": 0.1, "first_sample": 0.05}
    hold = system.add(da.blocks.ZeroOrderHold("hold", body.position[2], **timing))
    system.add(spatial.Force("force", body.center, (0, 0, G - 50 * hold.output)))
    result = da.solve_dynamics(system.build(), 1.0, **options)
    x, v, time = 0.3, 0.0, 0.05
    for _ in range(10):
        force, wait = -50 * x, min(0.1, 1.0 - time)
        x, v, time = x + v * wait + force * wait**2 / 2, v + force * wait, time + wait
    assert result["body.position"][-1, 2].item() == pytest.approx(x, abs=1e-12)


# linear systems and equilibria -----------------------------------------------------------
T = 0.02


@functools.cache
def cart(closed: bool, gain: float = 30.0) -> da.Model:
    """A pole on a cart near its upright position, with sampled feedback of the angle."""
    system = da.System("cart-pole", gravity=(0, -G))
    tilt = system.parameter("tilt", 0.0)
    body = system.add(planar.Body("cart", mass=1.0, inertia=0.1))
    system.add(planar.Prismatic("rail", system.ground.center, body.center))
    pole = system.add(planar.Bar("pole", length=1.0, mass=0.2, angle=np.pi / 2 - tilt))
    system.add(planar.Revolute("hinge", body.center, pole.start))
    push = system.input("push", unit="N")
    system.output("x", body.x)
    system.output("angle", pole.angle - np.pi / 2)
    force = push
    if closed:
        law = {"numerator": (-0.9, 1.0), "denominator": (1, -0.3)}
        signal = gain * (pole.angle - np.pi / 2) + 0.5 * body.x
        lead = da.blocks.SampledTransferFunction("lead", signal, sample_time=T, **law)
        force = force + system.add(lead).output
    system.add(planar.Force("drive", body.center, (force, 0)))
    return system.build()


def test_state_space_is_the_sampled_plant():
    continuous = da.linearize(cart(False)).state_space()
    exact = control.c2d(continuous.control, T)
    space = da.Stepper(cart(False), step=T, substeps=50).state_space()
    assert space.dt == T and not space.stable and space.inputs == ["push"]
    frequencies = np.array([0.1, 1.0, 7.0, 20.0])
    expected = np.array([exact(np.exp(2j * np.pi * f * T)) for f in frequencies])
    assert np.allclose(space.at(frequencies), expected, rtol=1e-10, atol=0)
    own = space.control
    assert own.dt == T and own.output_labels == ["x", "angle"]
    assert np.allclose(own(np.exp(0.3j)), exact(np.exp(0.3j)), rtol=1e-10)


def test_poles_of_a_sampled_loop_are_those_of_python_control():
    plant = control.c2d(da.linearize(cart(False)).state_space().control, T)
    signal = control.ss([], [], [], [[0.5, 30.0]], T) * plant
    loop = control.feedback(signal, control.ss(control.tf([-0.9, 1.0], [1, -0.3], T)), sign=1)
    space = da.Stepper(cart(True), step=T, substeps=50).state_space()
    poles = space.poles[np.abs(space.poles) > 1e-9]  # the held output is no state of its own
    distance = np.abs(poles[:, None] - loop.poles()[None])
    assert poles.size == loop.poles().size
    assert distance.min(axis=0).max() < 1e-10 and distance.min(axis=1).max() < 1e-10


def test_state_space_needs_repeated_samples():
    plant = da.Stepper(two_rates(), step=0.05, substeps=5)
    with pytest.raises(AnalysisError, match="samples of blocks differ between steps"):
        plant.state_space()


def lift(gain: float = 80.0, *, delay: int = 0, more=None) -> da.Model:
    """A cabin held by a sampled PID controller against its weight of 20 N."""
    system = da.System("lift", gravity=(0, -10))
    target = system.parameter("target", 1.0)
    cabin = system.add(planar.Particle("cabin", mass=2.0))
    rail = system.add(planar.PinInSlot("rail", system.ground.center, cabin.center, axis=(0, 1)))
    seen = cabin.y
    if delay:
        seen = system.add(da.blocks.Delay("late", seen, samples=delay, sample_time=0.05)).output
    if more:
        seen = more(system, cabin, rail)
    gains = {"proportional": gain, "integral": 60.0, "derivative": 40.0, "filter_time": 0.02}
    pid = system.add(da.blocks.SampledPID("pid", target, seen, sample_time=0.05, **gains))
    system.add(planar.Force("drive", cabin.center, (0, pid.output)))
    return system.build()


@pytest.mark.few(2)
@pytest.mark.parametrize(("gain", "delay"), [(80.0, 0), (200.0, 0), (400.0, 0), (80.0, 3)])
def test_equilibrium_is_the_fixed_point_of_samples(gain, delay):
    model = lift(gain, delay=delay)
    motion = da.solve_equilibrium(model, parameters={"target": 1.5})
    assert motion.status.success
    values = [motion[n].item() for n in ("cabin.y", "pid.output", "pid.integral")]
    assert np.allclose(values, [1.5, 20.0, 20.0], rtol=1e-9)
    gradient = da.sensitivity(motion, [da.Final("cabin.y"), da.Final("pid.integral")])
    assert np.allclose(gradient.sel(parameter="target"), [1.0, 0.0], atol=1e-9)
    plant = da.Stepper(model, step=0.05)
    first = plant.reset(motion=motion)
    state = plant.state
    for _ in range(3):
        plant.step()
    assert np.allclose(plant.state, state, atol=1e-8) and first.size == 0
    plant.reset(motion=motion)
    space = plant.state_space()
    assert motion.statistics["stable"] == space.stable
    if not space.stable:
        growth = np.log(np.abs(space.poles).max()) / 0.05
        assert f"rates up to {growth:.3g} 1/s; see Stepper.state_space" in motion.warnings[0]


def test_equilibria_without_a_fixed_point():
    def counter(system, cabin, rail):
        count = system.add(da.blocks.SampledState("count", sample_time=0.1))
        count.next = count.value + 1
        return cabin.y

    def converter(system, cabin, rail):
        adc = da.blocks.Quantizer("adc", cabin.y, resolution=1e-3, sample_time=0.05)
        return system.add(adc).output

    def force(system, cabin, rail):
        sensor = da.blocks.ZeroOrderHold(
            "sensor", Expression(rail.multiplier[0], "force"), sample_time=0.05
        )
        system.add(sensor)
        return cabin.y

    with pytest.raises(AnalysisError, match=r"count\.value changes at every sample"):
        da.solve_equilibrium(lift(more=counter))
    motion = da.solve_equilibrium(lift(more=converter))
    assert not motion.status.success and "adc quantises" in motion.status.message
    with pytest.raises(UnsupportedError, match="sensor samples forces of joints"):
        da.solve_equilibrium(lift(more=force))


def test_linearize_states_that_outputs_are_held():
    (text,) = da.linearize(lift()).warnings
    assert "outputs of pid are held" in text and "Stepper.state_space" in text


# gradients -------------------------------------------------------------------------------
@pytest.mark.thorough
@pytest.mark.parametrize("method", ["direct", "adjoint"])
def test_gradients_through_two_rates(method):
    """A quantiser passes none, so that its resolution is replaced by a hold."""

    def model():
        system = pendulum()
        rod = system.elements["rod"]
        gain = system.parameter("gain", 30.0)
        hold = da.blocks.ZeroOrderHold("hold", rod.angle, sample_time=FAST)
        late = system.add(da.blocks.Delay("late", system.add(hold).output, sample_time=FAST))
        timing = {"sample_time": SLOW, "first_sample": PHASE}
        gains = {"proportional": gain, "integral": 9.0, "derivative": 2.0}
        pid = da.blocks.SampledPID("pid", 0.2, late.output, **gains, **timing)
        system.add(planar.Torque("motor", rod, system.add(pid).output))
        return system.build()

    built, h = model(), 1e-4
    options = {"integrator": da.DormandPrince(rtol=1e-11, atol=1e-13)}
    response = da.Final("rod.angle")
    motion = da.solve_dynamics(built, END, **options)
    gradient = da.sensitivity(motion, response, method=method).item()
    up, down = (
        da.solve_dynamics(built, END, parameters={"gain": 30.0 + s * h}, **options) for s in (1, -1)
    )
    difference = (up["rod.angle"][-1] - down["rod.angle"][-1]).item() / (2 * h)
    assert gradient == pytest.approx(difference, rel=2e-6)
