"""A pole balanced on a cart by a linear quadratic regulator, sampled fifty times a second.

The plant of the regulator is the state-space model of one step of a ``Stepper``; python-control
solves the Riccati equation. The controller is a Python function of the outputs, called once per
sample, with the exact inertia of the tilted pole in between.
"""

import math
import sys

import control
import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

CART, POLE, LENGTH = 1.0, 0.2, 1.0
"""Masses [kg] and length of the pole [m]."""
SAMPLE, DURATION, TILT = 0.02, 4.0, 0.4
"""Sample time, duration [s], and tilt of the pole at the start [rad]."""
WEIGHTS, EFFORT = (1.0, 10.0, 0.1, 0.1), 0.01
"""Of cart, pole, their rates, and of the force."""


def build() -> da.System:
    system = da.System("cart-pole", gravity=(0.0, -9.81))
    tilt = system.parameter("tilt", 0.0, "rad")
    cart = system.add(planar.Body("cart", mass=CART, inertia=0.1, position=(0, 0), angle=0))
    system.add(planar.Prismatic("rail", system.ground.center, cart.center))
    pole = planar.Bar("pole", length=LENGTH, mass=POLE, angle=math.pi / 2 - tilt)
    system.add(pole)
    system.add(planar.Revolute("hinge", cart.center, pole.start))
    push = system.input("push", unit="N", bounds=(-40, 40))
    system.add(planar.Force("drive", cart.center, (push, 0)))
    system.output("x", cart.x)
    system.output("angle", pole.angle - math.pi / 2)
    system.output("speed", cart.vx)
    system.output("rate", pole.angular_velocity)
    return system


def gains(model: da.Model) -> np.ndarray:
    """Feedback of the outputs, which determine the state of the upright plant."""
    plant = da.Stepper(model, step=SAMPLE, substeps=4).state_space()
    weights = plant.C.T @ np.diag(WEIGHTS) @ plant.C
    feedback, _, _ = control.dlqr(plant.control, weights, [[EFFORT]])
    return np.asarray(feedback @ np.linalg.inv(plant.C))[0]


def main(folder=None) -> dict[str, float]:
    model = build().build()
    feedback = gains(model)

    def regulator(t: float, y: dict[str, float]) -> float:
        return float(-feedback @ list(y.values()))

    motion = da.solve_dynamics(
        model,
        DURATION,
        parameters={"tilt": TILT},
        controller=regulator,
        sample_time=SAMPLE,
        step=SAMPLE / 4,
    )
    numbers = {f"gain of {name}": gain for name, gain in zip(model.outputs, feedback, strict=True)}
    numbers["final angle"] = motion["angle"][-1].item()
    numbers["final place"] = motion["x"][-1].item()
    numbers["largest force"] = float(np.abs(motion["push"]).max())
    for name, value in numbers.items():
        print(f"{name}: {value:.6f}")
    if folder:
        figure, (picture, left, right) = plt.subplots(1, 3, figsize=(9.6, 3.0))
        style.draw(picture, motion, 0.0)
        picture.set(title="cart and pole at the start", xlabel="x [m]", ylabel="y [m]")
        left.plot(motion.time, motion["x"], label="cart [m]")
        left.plot(motion.time, motion["angle"], label="tilt [rad]")
        left.set(xlabel="time [s]", title="balance")
        left.legend()
        right.step(motion.time, motion["push"], where="post", color=style.GREEN)
        right.set(xlabel="time [s]", ylabel="force [N]", title="held between samples")
        style.save(figure, folder, "cart_pole_lqr")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
