"""Slider-crank with clearance (play) in the pin: free flight and impacts of the journal.

Data of Flores and Ambrosio (2004): crank 50 mm at 5000 rpm, connecting rod 120 mm, journal of 10
mm, radial clearance of 0.5 mm, steel, restitution 0.9 by the law of Lankarani and Nikravesh.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

SPEED = 5000 * 2 * math.pi / 60
JOURNAL, PLAY = 0.010, 0.5e-3
YOUNG, POISSON = 207e9, 0.3


def build(ideal: bool = False, play: float = PLAY) -> da.System:
    system = da.System("slider-crank with play")
    play = system.parameter("play", play, "m", bounds=(1e-5, 1e-3))
    turning = {"angle": 0.0, "angular_velocity": SPEED}
    crank = system.add(
        planar.Body(
            "crank",
            mass=0.30,
            inertia=1.0e-4,
            points={"O": (-0.025, 0), "A": (0.025, 0)},
            position=(0.025, 0),
            **turning,
        )
    )
    rod = system.add(
        planar.Body(
            "rod",
            mass=0.21,
            inertia=2.5e-4,
            points={"A": (-0.06, 0), "B": (0.06, 0)},
            position=(0.11, 0),
            angle=0.0,
        )
    )
    slider = system.add(planar.Body("slider", mass=0.14, inertia=1e-4, position=(0.17, 0)))
    system.add(planar.Revolute("O", system.ground.center, crank.point("O")))
    system.add(planar.Revolute("A", crank.point("A"), rod.point("A")))
    system.add(planar.Prismatic("guide", system.ground.center, slider.center, axis=(1, 0)))
    system.add(planar.RotationalDriver("motor", system.ground, crank, SPEED * da.t))
    pin = rod.point("B"), slider.center
    if ideal:
        system.add(planar.Revolute("B", *pin))
        return system
    softness = 2 * (1 - POISSON**2) / YOUNG
    radius = JOURNAL * (JOURNAL + play) / play
    law = planar.contact.LankaraniNikravesh(
        stiffness=4 / (3 * softness) * radius**0.5, restitution=0.9, impact_speed=0.5
    )
    system.add(planar.ClearanceRevolute("B", *pin, radius=JOURNAL, clearance=play, law=law))
    return system


def run(model: da.Model, turns: float = 3) -> da.Motion:
    integrator = da.DormandPrince853(rtol=1e-8, atol=1e-10)
    duration = 2 * math.pi * turns / SPEED
    return da.solve_dynamics(model, duration, integrator=integrator, outputs=3001)


def main(folder=None) -> dict[str, float]:
    motion, ideal = run(build().build()), run(build(ideal=True).build())
    later = motion.time > 4 * math.pi / SPEED
    numbers = {
        "largest acceleration [m/s^2]": float(abs(motion["slider.ax"].values[later]).max()),
        "largest without play [m/s^2]": float(abs(ideal["slider.ax"]).max()),
        "slider off its place [mm]": 1e3 * float(abs(motion["slider.x"] - ideal["slider.x"]).max()),
        "share of time in flight": float(np.mean(motion["B.gap"].values[later] > 0)),
    }
    print(*(f"{name}: {value:.4g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, middle, right) = plt.subplots(
            1, 3, figsize=(11, 3.4), width_ratios=(1.2, 1, 0.8)
        )
        style.draw(left, motion, 0.0015)
        left.set(title="slider-crank", xlabel="x [m]", ylabel="y [m]")
        angle = np.degrees(SPEED * motion.time) - 720
        middle.plot(angle, 1e-3 * motion["slider.ax"], label="with play")
        middle.plot(angle, 1e-3 * ideal["slider.ax"], label="without")
        middle.set(title="acceleration of the slider [km/s²]", xlabel="crank angle [deg]")
        middle.set(xlim=(0, 360), xticks=range(0, 361, 90), ylim=(-100, 100))
        middle.legend()
        x, y = 1e3 * motion["B.eccentricity"].values[later].T
        right.plot(x, y, lw=0.7)
        circle = np.linspace(0, 2 * np.pi, 181)
        right.plot(1e3 * PLAY * np.cos(circle), 1e3 * PLAY * np.sin(circle), color="0.3", lw=1)
        right.set(title="journal in its play [mm]", aspect="equal")
        style.save(figure, folder, "slider_crank_with_play")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
