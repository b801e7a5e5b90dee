"""Controlled plants as model files, with their equations written by hand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

import dalembert as da

Rate = Callable[[float, np.ndarray, dict[str, Any]], list]
G = 9.81


@dataclass(frozen=True)
class Plant:
    """A model file and its equations ``ẋ = f(t, x, p)``, analytic in ``x`` and ``p``.

    Attributes
    ----------
    text : tables of the model file
    states : measures that are the states of ``rate``
    start : states at the start, functions of the parameters
    duration : of the motion [s]
    sizes : magnitudes of the states
    """

    text: str
    states: tuple[str, ...]
    rate: Rate
    start: Callable[[dict[str, Any]], list]
    parameters: dict[str, float]
    duration: float
    sizes: tuple[float, ...]

    def model(self, folder: Path) -> da.Model:
        path = folder / "plant.toml"
        listed = "".join(f"{name} = {value!r}\n" for name, value in self.parameters.items())
        head = "format = 1\ngravity = [0, -9.81]\n[parameters]\n"
        path.write_text(head + listed + self.text, encoding="utf-8")
        return da.load_model(path).build()

    def end(self, changes: dict[str, complex] | None = None) -> np.ndarray:
        """States at the end by SciPy; complex for complex parameters."""
        p = self.parameters | (changes or {})
        kind = complex if changes else float
        done = solve_ivp(
            lambda t, x: np.array(self.rate(t, x, p), dtype=kind),
            (0, self.duration),
            np.array(self.start(p), dtype=kind),
            method="DOP853",
            rtol=1e-12,
            atol=1e-13 * np.array(self.sizes).min(),
        )
        assert done.success
        return done.y[:, -1]

    def slope(self, name: str) -> np.ndarray:
        """Derivatives of the states at the end by complex steps."""
        step = 1e-25 * self.parameters[name]
        changed = self.end({name: self.parameters[name] + 1j * step})
        return changed.imag / step

    def rest(self, near: np.ndarray) -> np.ndarray:
        """Equilibrium at time zero."""
        sizes = np.array(self.sizes)

        def residual(x: np.ndarray) -> np.ndarray:
            return np.array(self.rate(0.0, x * sizes, self.parameters), dtype=float) / sizes

        return fsolve(residual, near / sizes, xtol=1e-14) * sizes

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """``∂f/∂x`` at time zero by complex steps."""
        columns = []
        for k, size in enumerate(self.sizes):
            moved = x.astype(complex)
            moved[k] += 1e-25j * size
            rates = np.array(self.rate(0.0, moved, self.parameters), dtype=complex)
            columns.append(rates.imag / (1e-25 * size))
        return np.array(columns).T


def _pendulum(t, x, p):
    """PID controller of the angle of a physical pendulum."""
    angle, rate, integral, filtered = x
    wish = p["kp"] * (0.6 - angle) + integral + 6.0 * (-angle - filtered) / 0.015
    inertia = p["mass"] * 0.7**2 + 0.05
    turn = (wish - p["mass"] * G * 0.7 * np.cos(angle)) / inertia
    return [rate, turn, 20.0 * (0.6 - angle), (-angle - filtered) / 0.015]


PENDULUM = Plant(
    """
[bodies.bar]
type = "Body"
mass = "mass"
inertia = 0.05
position = [0.7, 0]
[blocks.pid]
type = "PID"
setpoint = 0.6
measured = "bar.angle"
proportional = "kp"
integral = 20
derivative = 6
filter_time = 0.015
[joints.hinge]
type = "Revolute"
connect = ["ground", {body = "bar", at = [-0.7, 0]}]
[forces.drive]
type = "Torque"
connect = ["bar"]
value = "pid.output"
""",
    ("bar.angle", "bar.angular_velocity", "pid.integral", "pid.filtered"),
    _pendulum,
    lambda p: [0.0, 0.0, 0.0, 0.0],
    {"kp": 30.0, "mass": 1.3},
    1.5,
    (1.0, 1.0, 10.0, 1.0),
)


def _filters(t, x, p):
    """A mass on a spring in a loop of lead–lag, low-pass, transfer function and state space."""
    place, speed, lead, low1, low2, a1, a2, b1, d1, d2 = x
    w = 25.0
    error = 0.4 - place
    leading = p["gain"] * (lead + 0.2 / 0.04 * (error - lead))
    # (2 s + 1)/(s² + 3 s + 4) in the form of controllable states
    shaped = 1.0 * a1 + 2.0 * a2
    mixed = 0.5 * b1 + 0.1 * shaped
    delayed = _delayed(d1, d2, mixed)
    force = delayed - p["spring"] * place - 0.3 * speed
    return [
        speed,
        force / 1.5,
        (error - lead) / 0.04,
        w * low2,
        w * (leading - low1 - np.sqrt(2.0) * low2),
        a2,
        low1 - 4.0 * a1 - 3.0 * a2,
        -2.0 * b1 + 3.0 * shaped,
        d2 / 0.05,
        (mixed - d1 - 0.5 * d2) * 12.0 / 0.05,
    ]


def _delayed(d1, d2, u):
    """Padé of order two, (1 − q/2 + q²/12)/(1 + q/2 + q²/12) with q = sT."""
    curved = 12.0 * (u - d1 - 0.5 * d2)
    return d1 - 0.5 * d2 + curved / 12.0


FILTERS = Plant(
    """
[bodies.cart]
type = "Particle"
mass = 1.5
position = [0.1, 0]
[joints.rail]
type = "PinInSlot"
connect = ["ground", "cart"]
[blocks.lead]
type = "LeadLag"
input = "0.4 - cart.x"
gain = "gain"
lead = 0.2
lag = 0.04
[blocks.low]
type = "LowPass"
input = "lead.output"
cutoff = 25
order = 2
[blocks.shape]
type = "TransferFunction"
input = "low.output"
numerator = [2, 1]
denominator = [1, 3, 4]
[blocks.mix]
type = "StateSpace"
inputs = ["shape.output"]
A = [[-2]]
B = [[3]]
C = [[0.5]]
D = [[0.1]]
[blocks.late]
type = "TransportDelay"
input = "mix.output1"
delay = 0.05
order = 2
[forces.push]
type = "Force"
connect = ["cart"]
vector = ["late.output - spring*cart.x - 0.3*cart.vx", 0]
""",
    ("cart.x", "cart.vx"),
    _filters,
    lambda p: [0.1, *[0.0] * 9],
    {"gain": 5.0, "spring": 20.0},
    1.5,
    (1.0,) * 10,
)


def _motor(t, x, p):
    """A DC motor with a gear that lifts an arm, with feedback of angle and current."""
    angle, rate, current = x
    voltage = 40.0 * (0.5 - angle) - 0.2 * current
    inertia = 0.4 + 1.2 * 0.3**2 + 3e-5 * p["ratio"] ** 2
    torque = p["ratio"] * (0.05 * current - 1e-5 * p["ratio"] * rate)
    return [
        rate,
        (torque - 1.2 * G * 0.3 * np.cos(angle) - 0.5 * rate) / inertia,
        (voltage - p["resistance"] * current - 0.05 * p["ratio"] * rate) / 2e-3,
    ]


MOTOR = Plant(
    """
[bodies.arm]
type = "Body"
mass = 1.2
inertia = 0.4
position = [0.3, 0]
[joints.hinge]
type = "Revolute"
connect = ["ground", {body = "arm", at = [-0.3, 0]}]
[forces.motor]
type = "DCMotor"
joint = "hinge"
voltage = "40*(0.5 - arm.angle) - 0.2*motor.current"
constant = 0.05
resistance = "resistance"
inductance = 2e-3
ratio = "ratio"
inertia = 3e-5
damping = 1e-5
[forces.rub]
type = "Torque"
connect = ["arm"]
value = "-0.5*arm.angular_velocity"
""",
    ("arm.angle", "arm.angular_velocity", "motor.current"),
    _motor,
    lambda p: [0.0, 0.0, 0.0],
    {"ratio": 20.0, "resistance": 0.8},
    0.5,
    (1.0, 1.0, 10.0),
)

SUPPLY, BULK, DEAD = 1e7, 1.4e9, 1e-4
AREA_A, AREA_B = 2e-3, 1e-3


def _cylinder(t, x, p):
    """A servo cylinder against a spring; the valve opens by the error of position."""
    place, speed, a, b = x
    u = p["gain"] * (0.3 - place)
    ahead = u.real >= 0
    gain = 1e-7 * (u if ahead else -u)

    def flow(source, sink):
        drop = source - sink
        return gain * drop / (drop**2 + (1e-4 * SUPPLY) ** 2) ** 0.25

    flow_a = flow(SUPPLY if ahead else 0.0, a)
    flow_b = flow(0.0 if ahead else SUPPLY, b)
    leak = 1e-12 * (a - b)
    rate_a = BULK / (DEAD + AREA_A * place) * (flow_a - AREA_A * speed - leak)
    rate_b = BULK / (DEAD + AREA_B * (0.5 - place)) * (flow_b + AREA_B * speed + leak)
    force = AREA_A * a - AREA_B * b - 200.0 * speed - p["stiffness"] * place - 3000.0
    return [speed, force / 50.0, rate_a, rate_b]


CYLINDER = Plant(
    """
[bodies.ram]
type = "Particle"
mass = 50
position = [1.2, 0]
[joints.rail]
type = "PinInSlot"
connect = ["ground", "ram"]
[forces.cylinder]
type = "HydraulicCylinder"
connect = ["ground", "ram"]
opening = "gain*(0.3 - (ram.x - 1))"
area = 2e-3
rod_side_area = 1e-3
stroke = 0.5
retracted_length = 1
rated_flow = 2e-4
rated_pressure = 4e6
leakage = 1e-12
damping = 200
start_a = 2e6
start_b = 3e6
[forces.load]
type = "Force"
connect = ["ram"]
vector = ["-3000 - stiffness*(ram.x - 1)", 0]
""",
    ("ram.x", "ram.vx", "cylinder.pressure_a", "cylinder.pressure_b"),
    _cylinder,
    lambda p: [0.2, 0.0, 2e6, 3e6],
    {"gain": 8.0, "stiffness": 2e4},
    0.15,
    (1.0, 1.0, 1e6, 1e6),
)


def _belt(t, x, p):
    """A sledge with bristles, pulled by a spring whose end moves steadily: stick and slip."""
    place, speed, bristle = x
    small = 1e-6 * 0.02
    size = np.sqrt(speed**2 + small**2) - small
    limit = p["coulomb"] + 1.5 * np.exp(-((speed / 0.02) ** 2))
    rate = 1e4 * (speed - size / limit * bristle)
    friction = bristle + 80.0 / 1e4 * rate + 0.4 * speed
    return [speed, (p["spring"] * (0.1 * t - place) - friction) / 1.0, rate]


BELT = Plant(
    """
[bodies.sledge]
type = "Body"
mass = 1
inertia = 1
[joints.rail]
type = "Prismatic"
connect = ["ground", "sledge"]
[forces.rub]
type = "BristleFriction"
joint = "rail"
coulomb = "coulomb"
static = "coulomb + 1.5"
stiffness = 1e4
damping = 80
viscous = 0.4
stribeck_speed = 0.02
[forces.pull]
type = "Force"
connect = ["sledge"]
vector = ["spring*(0.1*t - sledge.x)", 0]
""",
    ("sledge.x", "sledge.vx", "rub.deflection"),
    _belt,
    lambda p: [0.0, 0.0, 0.0],
    {"coulomb": 2.0, "spring": 40.0},
    1.5,
    (0.1, 0.1, 1.0),
)

PLANTS = {
    "pid": PENDULUM,
    "filters": FILTERS,
    "motor": MOTOR,
    "cylinder": CYLINDER,
    "bristles": BELT,
}
