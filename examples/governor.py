"""Centrifugal governor: balls on two arms lift a sleeve until speed and weight balance.

The arms are hinged on the spindle, two massless links carry the sleeve, and a spring and a damper
press it down. A motor accelerates the spindle to a constant speed; the sleeve settles where the
moments about the hinges balance. The gradient is the rise of the sleeve per speed.
"""

import math
import sys

import numpy as np
import style

import dalembert as da
from dalembert import spatial

G, ARM, LINK, HIGH, BALL, SLEEVE, STIFFNESS, FREE = 9.81, 0.2, 0.12, 0.12, 0.8, 1.5, 300.0, 0.25
SPEEDS, RISE, START = (12.0, 15.0, 18.0), 4.0, math.radians(30)
SPEED = SPEEDS[1]


def sleeve_depth(angle):
    """Of the sleeve below the hinges, the arms at an angle from the vertical."""
    return HIGH * np.cos(angle) + np.sqrt(LINK**2 - (HIGH * np.sin(angle)) ** 2)


def build() -> da.System:
    system = da.System("governor", gravity=(0.0, 0.0, -G))
    speed = system.parameter("speed", SPEED, "rad/s", bounds=(10.0, 25.0))
    stiffness = system.parameter("stiffness", STIFFNESS, "N/m")

    def body(name, mass, inertia, rotation, **more):
        made = spatial.Body(name, mass=mass, inertia=inertia, rotation=rotation, **more)
        return system.add(made)

    upright, up = da.rotation.identity(), (0, 0, 1)
    spindle = body("spindle", 1.0, (0.01, 0.01, 0.002), upright, position=(0, 0, 0))
    depth = float(sleeve_depth(START))
    sleeve = body("sleeve", SLEEVE, (0.002,) * 3, upright, position=(0, 0, -depth))
    shaft = spatial.Revolute(
        "shaft", system.ground.frame(axis=up, x=(1, 0, 0)), spindle.frame(axis=up, x=(1, 0, 0))
    )
    system.add(shaft)
    system.add(
        spatial.Prismatic(
            "guide", spindle.frame(axis=up, x=(1, 0, 0)), sleeve.frame(axis=up, x=(1, 0, 0))
        )
    )
    for name, side in (("left", -1), ("right", 1)):
        arm = body(
            f"{name}_arm",
            BALL,
            (1e-3,) * 3,
            da.rotation.axis_angle((0, 1, 0), -side * START),
            center_of_mass=(0, 0, -ARM),
            position=(0, 0, 0),
            points={"ball": (0, 0, -ARM), "middle": (0, 0, -HIGH)},
        )
        hinges = (one.frame(axis=(0, 1, 0), x=(1, 0, 0)) for one in (spindle, arm))
        system.add(spatial.Revolute(f"{name}_hinge", *hinges))
        system.add(
            spatial.RigidLink(f"{name}_link", arm.points["middle"], sleeve.center, length=LINK)
        )
    system.add(
        spatial.Spring(
            "spring",
            spindle.center,
            sleeve.center,
            stiffness=stiffness,
            damping=40.0,
            free_length=FREE,
        )
    )
    angle = speed * (da.t - (1 - da.exp(-RISE * da.t)) / RISE)
    system.add(spatial.RotationalDriver("motor", shaft, angle))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    runs = {
        speed: da.solve_dynamics(model, 9.0, step=2e-3, outputs=901, parameters={"speed": speed})
        for speed in SPEEDS
    }
    numbers = {
        f"height of the sleeve at {speed:g} rad/s [m]": float(run["sleeve.z"][-1])
        for speed, run in runs.items()
    }
    height = da.final("sleeve.z")
    slope = da.sensitivity(runs[SPEED], height, method="adjoint").sel(parameter="speed")
    numbers["rise per speed [m s/rad]"] = float(slope.squeeze())
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, left, right = style.beside()
        style.space(left, runs[SPEED], 9.0, trace="left_arm.ball")
        left.set_title("settled, and path of a ball")
        for speed, run in runs.items():
            right.plot(run.time, 1e3 * run["sleeve.z"], label=f"{speed:g} rad/s")
        right.set(xlabel="time [s]", ylabel="sleeve [mm]", title="rise of the sleeve")
        right.legend()
        style.save(figure, folder, "governor")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
