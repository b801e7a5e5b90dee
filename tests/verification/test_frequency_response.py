"""Frequency responses against closed forms, long simulations and python-control."""

import math

import control
import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov

import dalembert as da
from dalembert import planar, spatial, structures

PRECISE = da.DormandPrince853(rtol=1e-11, atol=1e-12)


def quarter_car() -> da.Model:
    """Wheel on a tyre over a road, body on a suspension (Gillespie, 1992)."""
    system = da.System("quarter car")
    road = system.input("road", unit="m")
    push = system.input("push", unit="N")
    touch = system.add(planar.Particle("touch", mass=1.0))
    wheel = system.add(planar.Particle("wheel", mass=40.0, position=(0, 0.3)))
    body = system.add(planar.Particle("body", mass=300.0, position=(0, 0.7)))
    for part in (touch, wheel, body):
        guide = f"guide_{part.name}"
        system.add(planar.PinInSlot(guide, system.ground.center, part.center, axis=(0, 1)))
    system.add(planar.CoordinateDriver("drive", touch.center, road, direction=(0, 1)))
    tyre = {"stiffness": 2e5, "damping": 50.0, "free_length": 0.3}
    system.add(planar.Spring("tyre", touch.center, wheel.center, **tyre))
    strut = {"stiffness": 2e4, "damping": 1.5e3, "free_length": 0.4}
    system.add(planar.Spring("strut", wheel.center, body.center, **strut))
    system.add(planar.Force("force", body.center, (0, push)))
    return system.build()


def by_hand(frequencies: np.ndarray) -> dict[str, np.ndarray]:
    """Amplitudes for a unit road."""
    s = 2j * np.pi * frequencies
    low, high = 2e5 + 50.0 * s, 2e4 + 1.5e3 * s
    wheel, body = np.zeros((2, s.size), complex)
    for k, x in enumerate(s):
        matrix = [[40 * x**2 + low[k] + high[k], -high[k]], [-high[k], 300 * x**2 + high[k]]]
        wheel[k], body[k] = np.linalg.solve(matrix, [low[k], 0])
    force = s**2 + low * (1 - wheel)  # on the massive point of contact
    return {"wheel.y": wheel, "body.y": body, "body.ay": s**2 * body, "drive.effort": force}


def test_road_in_a_driver_law_with_its_derivatives():
    frequencies = np.concatenate([[0.0], np.geomspace(0.1, 100, 40)])
    exact = by_hand(frequencies)
    outputs = list(exact)
    response = da.frequency_response(quarter_car(), frequencies, inputs=["road"], outputs=outputs)
    for name, values in exact.items():
        size = np.abs(values).max()
        np.testing.assert_allclose(response[name].values, values, rtol=0, atol=1e-10 * size)
        relative = np.abs(response[name].values[1:] / values[1:] - 1)
        assert relative.max() < 1e-10


def test_long_simulation():
    """The steady state of a pendulum cart under a small harmonic force."""
    f, amplitude, periods = 0.9, 1e-4, 40

    def build(force) -> da.Model:
        system = da.System("cart and pendulum", gravity=(0, -9.81))
        push = system.input("push", force, unit="N")
        cart = system.add(planar.Particle("cart", mass=2.0))
        system.add(planar.PinInSlot("rail", system.ground.center, cart.center))
        held = {"stiffness": 60.0, "damping": 4.0, "free_length": 1.0}
        system.add(planar.Spring("spring", system.ground.point(-1, 0), cart.center, **held))
        bar = system.add(planar.Bar("bar", length=0.6, mass=1.0, angle=-math.pi / 2))
        system.add(planar.Revolute("pin", cart.center, bar.start))
        turn = {"stiffness": 0.5, "damping": 0.15, "free_angle": -math.pi / 2}
        system.add(planar.TorsionSpring("hinge", system.ground, bar, **turn))
        system.add(planar.Force("force", cart.center, (push, 0)))
        return system.build()

    response = da.frequency_response(
        build(0.0), [f], inputs=["push"], outputs=["bar.angle", "cart.x", "pin.force.x"]
    )
    model = build(amplitude * da.cos(2 * math.pi * f * da.t))
    times = periods / f + np.arange(32) / (32 * f)
    motion = da.solve_dynamics(
        model, times[-1], outputs=np.concatenate([[0.0], times]), integrator=PRECISE
    )
    for name in response.outputs:
        samples = motion[name].values[1:]
        first = 2 * np.mean(samples * np.exp(-2j * np.pi * f * times)) / amplitude
        expected = complex(response[name].values[0])
        assert abs(first / expected - 1) < 1e-4


def test_closed_loop_against_python_control():
    system = da.System("servo")
    target = system.input("target", unit="m")
    body = system.add(planar.Particle("body", mass=2.0))
    system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    gains = {"proportional": 40.0, "integral": 25.0, "derivative": 12.0, "filter_time": 0.02}
    pid = system.add(da.blocks.PID("pid", target, body.x, **gains))
    lag = system.add(da.blocks.LowPass("motor", pid.output, cutoff=30.0, order=2))
    system.add(planar.Force("force", body.center, (lag.output - 3.0 * body.vx, 0)))
    modes = da.linearize(system.build())
    plant = control.tf([1], [2, 3, 0])
    motor = control.tf([30.0**2], [1, math.sqrt(2) * 30.0, 30.0**2])
    s = control.tf([1, 0], [1])
    controller = 40 + 25 / s + 12 * s / (0.02 * s + 1)
    loop = control.feedback(control.minreal(controller * motor * plant, verbose=False), 1)
    expected = np.sort_complex(control.minreal(loop, verbose=False).poles())
    model = modes.state_space(outputs=["body.x"])
    for poles in (model.poles, model.control.poles()):
        np.testing.assert_allclose(np.sort_complex(poles), expected, rtol=1e-12)
    frequencies = np.geomspace(0.05, 20, 9)
    values = model.at(frequencies).values[:, 0, 0]
    own = model.control
    np.testing.assert_allclose(values, own(2j * np.pi * frequencies), rtol=1e-10)
    response = da.frequency_response(modes.model, frequencies, outputs=["body.x"])
    np.testing.assert_allclose(response["body.x"].values, values, rtol=1e-10)


def test_a_plate_on_a_hinge_in_space():
    """Rotation under a torque, 1/(I s² + c s + k)."""
    system = da.System("plate", gravity=(0, 0, 0))
    moment = system.input("moment", unit="N m")
    plate = system.add(spatial.Body("plate", mass=3.0, inertia=(0.2, 0.4, 0.5)))
    frames = system.ground.frame((0, 0, 0)), plate.frame((0, 0, 0))
    system.add(spatial.Revolute("hinge", *frames))
    system.add(spatial.TorsionSpring("spring", *frames, stiffness=8.0, damping=0.1))
    system.add(spatial.Torque("torque", plate, (0, 0, moment)))
    f = np.array([0.0, 0.3, 0.7])
    h = da.frequency_response(
        system.build(), f, outputs=["hinge.angle", "plate.angular_velocity.z"]
    )
    s = 2j * np.pi * f
    exact = 1 / (0.5 * s**2 + 0.1 * s + 8.0)
    np.testing.assert_allclose(h["hinge.angle"].values, exact, rtol=1e-10)
    np.testing.assert_allclose(
        h["plate.angular_velocity.z"].values, s * exact, rtol=1e-10, atol=1e-14
    )


def cantilever(count: int = 16) -> tuple[da.StructuralModel, str]:
    beam = da.Structure("cantilever")
    push, sway = beam.input("push", unit="N"), beam.input("sway", unit="m")
    nodes = [beam.node(f"n{k}", k / count, 0) for k in range(count + 1)]
    section = {"area": 4e-4, "second_moment": 1.333e-8, "modulus": 7e10, "density": 2700.0}
    for k in range(count):
        beam.add(structures.Frame(f"e{k}", nodes[k], nodes[k + 1], **section))
    beam.support(nodes[0], ux=0, uy=sway, rz=0)
    beam.load(nodes[count], fy=push)
    return beam.build(), f"n{count}.uy"


def test_cantilever_of_bernoulli():
    """Receptance of the tip, (cos λ sinh λ − sin λ cosh λ)/(EI β³ (1 + cos λ cosh λ))."""
    model, tip = cantilever()
    frequencies, loss = np.linspace(2.0, 120.0, 25), 0.03
    response = da.frequency_response(
        model, frequencies, inputs=["push", "sway"], outputs=[tip], loss_factor=loss
    )
    rigidity = 7e10 * 1.333e-8 * (1 + 1j * loss)
    beta = ((2 * np.pi * frequencies) ** 2 * 2700.0 * 4e-4 / rigidity) ** 0.25
    c, s, ch, sh = np.cos(beta), np.sin(beta), np.cosh(beta), np.sinh(beta)
    bending = 1 + c * ch
    push = -(c * sh - s * ch) / (rigidity * beta**3 * bending)
    sway = (c + ch) / bending
    h = response[tip].values
    np.testing.assert_allclose(h[:, 0], push, rtol=2e-3)  # of cubic beam elements
    np.testing.assert_allclose(h[:, 1], sway, rtol=2e-3)


def test_white_noise_by_the_lyapunov_equation():
    """Independent noise of two inputs at a lightly damped chain."""
    system = da.System("chain")
    ends, previous = [], system.ground.center
    for k in range(3):
        push = system.input(f"push{k}", unit="N")
        body = system.add(planar.Particle(f"m{k}", mass=1.0 + k, position=(0.5 * (k + 1), 0)))
        system.add(planar.PinInSlot(f"r{k}", system.ground.center, body.center))
        numbers = {"stiffness": 500.0 - 90 * k, "damping": 0.02 + 0.01 * k, "free_length": 0.5}
        system.add(planar.Spring(f"s{k}", previous, body.center, **numbers))
        system.add(planar.Force(f"f{k}", body.center, (push, 0)))
        ends.append(f"m{k}.x")
        previous = body.center
    model = system.build()
    levels = {"push0": 2.0, "push1": 0.5, "push2": 0.1}
    vibration = da.RandomResponse(psd=levels, outputs=[*ends, "m2.vx"]).run(model)
    space = da.linearize(model).state_space(list(levels), [*ends, "m2.vx"])
    intensity = space.B @ np.diag(list(levels.values())) @ space.B.T / 2  # two-sided
    covariance = solve_continuous_lyapunov(space.A, -intensity)
    exact = np.sqrt(np.diag(space.C @ covariance @ space.C.T))
    computed = [vibration.rms(name) for name in space.outputs]
    np.testing.assert_allclose(computed, exact, rtol=1e-9)


def test_coloured_noise():
    """Noise of a first-order filter: σ² = S (1 + c T/m)/(4 c k (1 + c T/m + k T²/m))."""
    system = da.System("oscillator")
    push = system.input("push", unit="N")
    body = system.add(planar.Particle("body", mass=1.0, position=(0.5, 0)))
    system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    spring = {"stiffness": 100.0, "damping": 0.1, "free_length": 0.5}
    system.add(planar.Spring("spring", system.ground.center, body.center, **spring))
    system.add(planar.Force("force", body.center, (push, 0)))
    corner = 1 / (2 * math.pi * 0.2)  # T = 0.2 s
    density = f"4/(1 + (f/{corner!r})**2)"
    vibration = da.RandomResponse(psd={"push": density}, outputs=["body.x"]).run(system.build())
    c, k, time = 0.1, 100.0, 0.2
    exact = 4 * (1 + c * time) / (4 * c * k * (1 + c * time + k * time**2))
    assert vibration.rms("body.x") ** 2 == pytest.approx(exact, rel=1e-9)
