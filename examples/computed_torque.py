"""A robot arm that draws a circle: computed torque beside a controller of its joints alone.

The controller is a Python function, called two hundred times a second. It computes the torques of
the wanted accelerations from the inertia of the arm, ``tau = M (q_d'' + K_d e' + K_p e) + h``
(Craig, Introduction to Robotics, 10.5), with ``M`` and ``h`` of two rods. Without these terms the
same gains leave errors of centimetres.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

LENGTH, MASS, GRAVITY = 0.5, 2.0, 9.81
"""Of each rod [m], [kg], [m/s²]."""
CENTRE, RADIUS, TURN = (0.45, 0.25), 0.2, 2.0
"""Circle [m], and time of a turn [s]."""
SAMPLE, DURATION = 5e-3, 3.0
PROPORTIONAL, DERIVATIVE = 400.0, 40.0
"""Gains of accelerations, ``K_p`` [1/s²] and ``K_d`` [1/s]; critically damped."""


def build() -> da.System:
    system = da.System("arm", gravity=(0.0, -GRAVITY))
    upper = planar.Bar("upper", length=LENGTH, mass=MASS, angle=wanted(0.0)[0][0])
    lower = planar.Bar("lower", length=LENGTH, mass=MASS, angle=wanted(0.0)[0].sum())
    system.add(upper)
    system.add(lower)
    system.add(planar.Revolute("shoulder", system.ground.center, upper.start))
    system.add(planar.Revolute("elbow", upper.end, lower.start))
    torques = [system.input(name, unit="N m") for name in ("shoulder_torque", "elbow_torque")]
    system.add(planar.Torque("motor1", upper, torques[0] - torques[1]))
    system.add(planar.Torque("motor2", lower, torques[1]))
    system.output("q1", upper.angle)
    system.output("q2", lower.angle - upper.angle)
    system.output("w1", upper.angular_velocity)
    system.output("w2", lower.angular_velocity - upper.angular_velocity)
    return system


def wanted(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angles of the joints on the circle, their rates and accelerations."""
    h = 1e-3
    before, now, after = (angles(*circle(t + s)) for s in (-h, 0.0, h))
    return now, (after - before) / (2 * h), (after - 2 * now + before) / h**2


def circle(t: float) -> tuple[float, float]:
    phase = 2 * math.pi * t / TURN
    return CENTRE[0] + RADIUS * math.cos(phase), CENTRE[1] + RADIUS * math.sin(phase)


def angles(x: float, y: float) -> np.ndarray:
    """Inverse kinematics of two equal rods, elbow up."""
    elbow = -2 * math.acos(math.hypot(x, y) / (2 * LENGTH))
    return np.array([math.atan2(y, x) - elbow / 2, elbow])


def inertia(q: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """``M`` and ``h`` of two rods."""
    unit, c, s = MASS * LENGTH**2, math.cos(q[1]), math.sin(q[1])
    mass = unit * np.array([[5 / 3 + c, 1 / 3 + c / 2], [1 / 3 + c / 2, 1 / 3]])
    weight = MASS * GRAVITY * LENGTH * np.array([1.5 * math.cos(q[0]), 0.0])
    weight += MASS * GRAVITY * LENGTH * 0.5 * math.cos(q[0] + q[1])
    swing = unit * s / 2 * np.array([-w[1] * (2 * w[0] + w[1]), w[0] ** 2])
    return mass, swing + weight


def run(model: da.Model, computed: bool) -> da.Motion:
    def controller(t: float, y: dict[str, float]) -> np.ndarray:
        q, w = np.array([y["q1"], y["q2"]]), np.array([y["w1"], y["w2"]])
        place, rate, acceleration = wanted(t)
        reaction = PROPORTIONAL * (place - q) + DERIVATIVE * (rate - w)
        mass, bias = inertia(q, w)
        if computed:
            return mass @ (acceleration + reaction) + bias
        return inertia(np.array([0.0, math.pi / 2]), 0 * w)[0].diagonal() * reaction

    options = {"controller": controller, "sample_time": SAMPLE, "step": SAMPLE}
    return da.solve_dynamics(model, DURATION, **options)


def distances(motion: da.Motion) -> np.ndarray:
    """Distance of the tip from its place on the circle [m]."""
    x, y = np.array([circle(t) for t in motion.time]).T
    return np.hypot(motion["lower.end.x"] - x, motion["lower.end.y"] - y).values


def main(folder=None) -> dict[str, float]:
    model = build().build()
    motions = {"joints alone": run(model, False), "computed torque": run(model, True)}
    settled = motions["computed torque"].time > 1.0
    numbers = {f"error, {n}": float(distances(m)[settled].max()) for n, m in motions.items()}
    for name, value in numbers.items():
        print(f"{name}: {value:.6f}")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.6))
        style.draw(left, motions["computed torque"], 0.0)
        for (name, motion), colour in zip(motions.items(), (style.GREY, style.BLUE), strict=True):
            left.plot(motion["lower.end.x"], motion["lower.end.y"], color=colour, lw=1)
            right.semilogy(motion.time[1:], distances(motion)[1:], color=colour, label=name)
        left.set(title="path of the tip", xlabel="x [m]", ylabel="y [m]")
        right.set(title="distance from the circle", xlabel="time [s]", ylabel="m")
        right.legend()
        style.save(figure, folder, "computed_torque")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
