"""Driven mechanisms with states, contacts and massless bodies, against hand-written equations."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar
from dalembert.errors import AnalysisError, ModelError

contact = planar.contact
SETTINGS = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13, "max_step": 2e-3}
G = 10.0


def integrated(rates, span: float, start: list[float], t: np.ndarray) -> np.ndarray:
    return solve_ivp(rates, (0, span), start, t_eval=t, **SETTINGS).y


def lift(system: da.System, mass: float = 2.0, low: float = 0.1) -> planar.Particle:
    """A particle whose height is driven."""
    body = system.add(planar.Particle("body", mass=mass, position=(0, 0.3)))
    system.add(planar.PinInSlot("rail", system.ground.center, body.center, axis=(0, 1)))
    law = low + 0.2 * da.cos(4 * da.t)
    system.add(planar.CoordinateDriver("drive", body.center, law, direction=(0, 1)))
    return body


def lag(system: da.System, quantity, time: float = 0.1):
    state = system.add(da.blocks.State("z", start=0.0))
    state.rate = (quantity - state.value) / time
    return state


def height(t, low=0.1):
    return low + 0.2 * np.cos(4 * t), -0.8 * np.sin(4 * t), -3.2 * np.cos(4 * t)


def test_compliant_contact_of_a_driven_body():
    system = da.System("pressed", gravity=(0, -G))
    body = lift(system)
    law = contact.HuntCrossley(stiffness=1e4, damping=0.3, exponent=1.5)
    shapes = contact.HalfPlane(system.ground.center), contact.Circle(body.center, 0.05)
    system.add(planar.Contact("floor", *shapes, law=law))
    state = lag(system, body.y)
    system.add(planar.Force("push", body.center, (0, 7 * state.value)))
    motion = da.solve_inverse_dynamics(system.build(), 2.0, step=0.01)
    assert motion.status.success and not motion.warnings
    t = np.asarray(motion.time)

    def normal(t):
        y, v, _ = height(t)
        return 1e4 * np.maximum(0.05 - y, 0.0) ** 1.5 * np.maximum(0, 1 - 0.3 * v)

    z = integrated(lambda t, z: [(height(t)[0] - z[0]) / 0.1], 2.0, [0.0], t)[0]
    effort = 2 * height(t)[2] + 2 * G - normal(t) - 7 * z
    np.testing.assert_allclose(motion["drive.effort"], effort, atol=1e-7 * np.abs(effort).max())
    np.testing.assert_allclose(motion["z.value"], z, atol=1e-7)


@pytest.mark.few(2)
@pytest.mark.parametrize("low", [0.1, 0.3])
@pytest.mark.parametrize("many", [False, True])
def test_rigid_contacts_do_not_change_a_driven_motion(many, low):
    """As without states: they are ignored, with a warning where bodies would overlap."""
    system = da.System("pressed", gravity=(0, -G))
    body = lift(system, low=low)
    shapes = [contact.HalfPlane(system.ground.center), contact.Circle(body.center, 0.05)]
    if many:
        system.add(planar.Collisions("floor", shapes, restitution=0.5))
    else:
        system.add(planar.Contact("floor", *shapes, law=contact.Restitution(0.5)))
    state = lag(system, body.y)
    system.add(planar.Force("push", body.center, (0, 7 * state.value)))
    motion = da.solve_inverse_dynamics(system.build(), 2.0, step=0.01)
    assert motion.status.success
    t = np.asarray(motion.time)
    z = integrated(lambda t, z: [(height(t, low)[0] - z[0]) / 0.1], 2.0, [0.0], t)[0]
    effort = 2 * height(t)[2] + 2 * G - 7 * z
    np.testing.assert_allclose(motion["drive.effort"], effort, atol=1e-6)
    overlaps = [w for w in motion.warnings if "ignores rigid contacts" in w]
    assert bool(overlaps) == (low < 0.2) and len(motion.warnings) == len(overlaps)


@pytest.mark.parametrize("massless", [False, True])
def test_massless_links_and_a_massless_mechanism(massless):
    """The driver of a slider crank with massless links; or of a massless slider with a spring."""
    system = da.System("massless", gravity=(0, -G))
    if massless:
        body = lift(system, mass=0.0, low=0.4)
        spring = {"stiffness": 50.0, "free_length": 0.05}
        system.add(planar.Spring("spring", system.ground.center, body.center, **spring))
        state = lag(system, body.y)
        system.add(planar.Force("push", body.center, (0, 7 * state.value)))

        def place(t):
            return height(t, 0.4)

        def effort(t, z):
            return 50 * (place(t)[0] - 0.05) - 7 * z

        quantity = 0
    else:
        crank = system.add(planar.Bar("crank", length=0.3, mass=0.0, angle=0.5))
        rod = system.add(planar.Bar("rod", length=1.0, mass=0.0, angle=-0.1))
        slider = system.add(planar.Particle("slider", mass=2.0, position=(1.2, 0)))
        system.add(planar.Revolute("O", system.ground.center, crank.start))
        system.add(planar.Revolute("A", crank.end, rod.start))
        system.add(planar.Revolute("B", rod.end, slider.center))
        system.add(planar.PinInSlot("rail", system.ground.center, slider.center))
        system.add(planar.RotationalDriver("drive", system.ground, crank, 0.5 + 3 * da.t))
        state = lag(system, slider.vx)
        system.add(planar.Force("push", slider.center, (-7 * state.value, 0)))

        def place(t):
            """x, ẋ, ẍ of the slider, x = a c + √(1 − a² s²)."""
            a, s, c = 0.3, np.sin(0.5 + 3 * t), np.cos(0.5 + 3 * t)
            root = np.sqrt(1 - a**2 * s**2)
            first = -a * s - a**2 * s * c / root
            second = -a * c - a**2 * (c**2 - s**2) / root - a**4 * s**2 * c**2 / root**3
            return a * c + root, 3 * first, 9 * second

        def effort(t, z):
            _, v, a = place(t)
            return (2 * a + 7 * z) * v / 3

        quantity = 1
    motion = da.solve_inverse_dynamics(system.build(), 1.0, step=0.01)
    assert motion.status.success and not motion.warnings
    t = np.asarray(motion.time)
    z = integrated(lambda t, z: [(place(t)[quantity] - z[0]) / 0.1], 1.0, [0.0], t)[0]
    np.testing.assert_allclose(motion["z.value"], z, atol=1e-7)
    np.testing.assert_allclose(motion["drive.effort"], effort(t, z), atol=1e-6)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"coordinates": da.JointCoordinates()},
        {"formulation": da.KKT()},
        {"integrator": da.Radau(rtol=1e-9, atol=1e-11)},
    ],
    ids=["default", "joint coordinates", "KKT", "Radau"],
)
def test_a_pendulum_on_a_driven_massless_crank_over_a_floor(options):
    """One freedom is driven, the other free with a filtered brake and a compliant contact."""
    system = da.System("pendulum", gravity=(0, -G))
    crank = system.add(planar.Bar("crank", length=0.3, mass=0.0, angle=0.5))
    bob = system.add(planar.Bar("bob", length=0.6, mass=2.0, angle=-1.0))
    system.add(planar.Revolute("O", system.ground.center, crank.start))
    system.add(planar.Revolute("A", crank.end, bob.start))
    system.add(planar.RotationalDriver("drive", system.ground, crank, 0.5 + 3 * da.t))
    state = lag(system, bob.angular_velocity)
    system.add(planar.Torque("brake", bob, -0.5 * state.value))
    shapes = contact.HalfPlane(system.ground.point(0, -0.5)), contact.Circle(bob.end, 0.02)
    law = contact.HuntCrossley(stiffness=1e4, damping=0.3)
    system.add(planar.Contact("floor", *shapes, law=law))
    options = {"integrator": da.DormandPrince(rtol=1e-10, atol=1e-12)} | options
    motion = da.solve_dynamics(system.build(), 2.0, outputs=101, **options)
    assert motion.status.success
    m, l, crank_length, spin = 2.0, 0.6, 0.3, 3.0

    def turning(t, x):
        angle, speed, z = x
        phase = 0.5 + spin * t
        ax, ay = -crank_length * spin**2 * np.array([np.cos(phase), np.sin(phase)])
        depth = max(-(crank_length * np.sin(phase) + l * np.sin(angle) - 0.02 + 0.5), 0.0)
        sinking = crank_length * spin * np.cos(phase) + l * speed * np.cos(angle)
        normal = 1e4 * depth**1.5 * max(0.0, 1 - 0.3 * sinking)
        moment = (-m * G / 2 + normal) * l * np.cos(angle) - 0.5 * z
        moment -= m * l / 2 * (np.cos(angle) * ay - np.sin(angle) * ax)
        return moment / (m * l**2 / 3), normal, ax, ay

    t = np.asarray(motion.time)
    x = integrated(
        lambda t, x: [x[1], turning(t, x)[0], (x[1] - x[2]) / 0.1], 2.0, [-1.0, 0.0, 0.0], t
    )
    np.testing.assert_allclose(motion["bob.angle"], x[0], atol=1e-7)
    np.testing.assert_allclose(motion["z.value"], x[2], atol=1e-6)
    efforts = []
    for time, (angle, speed, z) in zip(t, x.T, strict=True):
        second, normal, ax, ay = turning(time, (angle, speed, z))
        phase, half = 0.5 + spin * time, l / 2
        cx = ax - half * (np.sin(angle) * second + np.cos(angle) * speed**2)
        cy = ay + half * (np.cos(angle) * second - np.sin(angle) * speed**2)
        forces = m * cx, m * (cy + G) - normal
        efforts.append(crank_length * (np.cos(phase) * forces[1] - np.sin(phase) * forces[0]))
    np.testing.assert_allclose(motion["drive.effort"], efforts, atol=1e-5)


def follower(rate) -> da.Model:
    """A particle that follows a state, and another one on a spring between them."""
    system = da.System("follower", gravity=(0, -G))
    body = system.add(planar.Particle("body", mass=2.0, position=(0, 0.3)))
    system.add(planar.PinInSlot("rail", system.ground.center, body.center, axis=(0, 1)))
    other = system.add(planar.Particle("other", mass=1.0, position=(1, 0.3)))
    system.add(planar.PinInSlot("rail2", system.ground.point(1, 0), other.center, axis=(0, 1)))
    state = system.add(da.blocks.State("z", start=0.3, unit="m"))
    state.rate = (da.sin(3 * da.t) - state.value) / 0.2 + rate(other)
    system.add(planar.CoordinateDriver("drive", body.center, state.value, direction=(0, 1)))
    spring = {"stiffness": 40.0, "free_length": 1.0}
    system.add(planar.Spring("spring", body.center, other.center, **spring))
    return system.build()


@pytest.mark.parametrize("gain", [0.0, 0.5])
def test_drivers_follow_states(gain):
    """Speeds and accelerations of the law are those of the state; energy of the driver is input."""
    motion = da.solve_dynamics(follower(lambda other: gain * other.y), 1.0, outputs=101)
    assert motion.status.success and not motion.warnings

    def force(x):
        length = np.hypot(1, x[1] - x[0])
        return 40 * (length - 1) * (x[1] - x[0]) / length

    def rate(t, x):
        return (np.sin(3 * t) - x[0]) / 0.2 + gain * x[1]

    t = np.asarray(motion.time)
    x = integrated(lambda t, x: [rate(t, x), x[2], -G - force(x)], 1.0, [0.3, 0.3, 0.0], t)
    second = (3 * np.cos(3 * t) - rate(t, x)) / 0.2 + gain * x[2]
    np.testing.assert_allclose(motion["body.y"], x[0], atol=1e-9)
    np.testing.assert_allclose(motion["body.vy"], rate(t, x), atol=1e-8)
    np.testing.assert_allclose(motion["other.y"], x[1], atol=1e-9)
    np.testing.assert_allclose(motion["drive.effort"], 2 * second + 2 * G - force(x), atol=1e-7)
    assert float(abs(motion.data["balance_error"]).max()) < 1e-7


def test_laws_of_states_that_depend_on_speeds_and_kinematics_of_states_are_refused():
    with pytest.raises(ModelError, match=r"drive: its position follows the state z, .* other\.vy"):
        follower(lambda other: 0.5 * other.vy)
    system = da.System("one")
    body = system.add(planar.Particle("body", mass=1.0))
    system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    state = system.add(da.blocks.State("z", start=0.5, unit="m"))
    state.rate = da.sin(5 * da.t)
    system.add(planar.CoordinateDriver("drive", body.center, state.value))
    model = system.build()
    with pytest.raises(AnalysisError, match=r"drive follows z\.value, .* solve_inverse_dynamics"):
        da.solve_kinematics(model, 1.0)
    motion = da.solve_inverse_dynamics(model, 1.0, outputs=11)
    expected = 5 * np.cos(5 * np.asarray(motion.time))
    np.testing.assert_allclose(motion["drive.effort"], expected, atol=1e-9)


@pytest.mark.few(1)
@pytest.mark.parametrize("part", ["free length", "stiffness", "end"])
def test_springs_and_dampers_that_states_change(part):
    """Rates of lengths include those of states, and their energy is balanced."""
    system = da.System("spring")
    body = system.add(planar.Particle("body", mass=1.0, position=(1.0, 0)))
    system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    state = system.add(da.blocks.State("z", start=0.5, unit="m"))
    state.rate = da.sin(5 * da.t) - 0.2 * body.vx
    numbers = {"stiffness": 40.0, "damping": 3.0, "free_length": 0.5}
    end = system.ground.point(0, 0.2)
    if part == "free length":
        numbers["free_length"] = state.value
    elif part == "stiffness":
        numbers["stiffness"] = 40.0 * state.value
    else:
        end = system.ground.point(state.value - 1, 0.2)
    system.add(planar.Spring("spring", end, body.center, **numbers))
    motion = da.solve_dynamics(system.build(), 2.0, outputs=21)

    def rates(t, x):
        place, speed, z = x
        z_rate = np.sin(5 * t) - 0.2 * speed
        foot, moving = (z - 1, z_rate) if part == "end" else (0.0, 0.0)
        along = place - foot
        length = np.hypot(along, 0.2)
        free, k = (z if part == "free length" else 0.5), (40 * z if part == "stiffness" else 40)
        pull = k * (length - free) + 3 * along * (speed - moving) / length
        return [speed, -pull * along / length, z_rate]

    x = integrated(rates, 2.0, [1.0, 0.0, 0.5], np.asarray(motion.time))
    assert motion.status.success and not motion.warnings
    np.testing.assert_allclose(motion["body.x"], x[0], atol=1e-7)
    assert float(abs(motion.data["balance_error"]).max()) < 1e-5
