"""Disc cam with a translating roller follower: contact force and required spring.

The lift over the cam angle is rise (3-4-5 polynomial, 120 deg) - dwell 60 deg - return 120 deg -
dwell 60 deg. The centre of the roller follows the pitch curve, and the cam is the offset curve at
one roller radius inside it. The model uses 120 points of the cam, as in manufacturing.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

LIFT, PITCH_RADIUS, ROLLER = 0.015, 0.042, 0.010
RISE, DWELL = math.radians(120), math.radians(60)


def lift(angle):
    """Lift and its derivative by the cam angle."""
    angle = np.mod(angle, 2 * np.pi)
    back = angle > RISE + DWELL
    x = np.clip(np.where(back, 1 - (angle - RISE - DWELL) / RISE, angle / RISE), 0, 1)
    s = x**3 * (10 - 15 * x + 6 * x**2)
    slope = 30 * x**2 * (1 - x) ** 2 / RISE * np.where(back, -1, 1)
    return LIFT * s, LIFT * slope


def profile(count: int = 120) -> np.ndarray:
    """Points of the cam in its own frame, anticlockwise."""
    angle = (
        -2 * np.pi * (np.arange(count) + 0.25) / count
    )  # the cam turns the other way under the follower
    (s, slope), place = lift(angle), np.pi / 2 - angle
    radial = np.array([np.cos(place), np.sin(place)])
    across = np.array([-radial[1], radial[0]])
    centre = (PITCH_RADIUS + s) * radial
    tangent = -slope * radial + (PITCH_RADIUS + s) * across
    normal = np.array([tangent[1], -tangent[0]]) / np.linalg.norm(tangent, axis=0)
    return (centre - ROLLER * normal).T


def build() -> da.System:
    system = da.System("cam and follower", gravity=(0.0, -9.81))
    mass = system.parameter("mass", 0.4, "kg")
    k = system.parameter("k", 4000.0, "N/m", bounds=(1000, 10000))
    free = system.parameter("free", 0.075, "m")
    roller = system.parameter("roller", ROLLER, "m")
    speed = system.parameter("speed", 20 * math.pi, "rad/s")

    cam = system.add(planar.Body("cam", mass=1.2, inertia=1e-3, position=(0, 0), angle=0.0))
    follower = system.add(
        planar.Body(
            "follower",
            mass=mass,
            inertia=1e-4,
            position=(0, PITCH_RADIUS),
            points={"stem": (0, 0.035), "top": (0, 0.06)},
        )
    )
    system.add(planar.Revolute("shaft", system.ground.center, cam.center))
    system.add(planar.Prismatic("guide", system.ground.center, follower.point("stem"), axis=(0, 1)))
    system.add(
        planar.PointOnCurve(
            "contact", cam, follower.center, curve=da.SplineCurve(profile()), radius=roller
        )
    )
    system.add(planar.RotationalDriver("motor", system.ground, cam, speed * da.t))
    system.add(
        planar.Spring(
            "spring",
            follower.point("top"),
            system.ground.point(0, 0.16),
            stiffness=k,
            free_length=free,
        )
    )
    return system


def main(folder=None) -> dict[str, float]:
    motion = da.solve_inverse_dynamics(build().build(), 0.1, outputs=361)
    angle = 20 * math.pi * motion.time
    numbers = {
        "lift error": float(abs(motion["follower.y"].values - PITCH_RADIUS - lift(angle)[0]).max()),
        "smallest contact force": float(motion["contact.force_norm"].min()),
        "largest torque": float(abs(motion["motor.effort"]).max()),
    }
    print(*(f"{name}: {value:.4g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, upper, lower) = plt.subplots(
            1, 3, figsize=(11, 3.6), width_ratios=(0.8, 1, 1)
        )
        style.draw(left, motion, 0.02)
        left.set(title="cam, roller and spring", xlabel="x [m]", ylabel="y [m]")
        upper.plot(np.degrees(angle), 1e3 * (motion["follower.y"] - PITCH_RADIUS))
        upper.set(title="lift [mm]")
        lower.plot(np.degrees(angle), motion["contact.force_norm"], label="contact force [N]")
        lower.plot(
            np.degrees(angle), motion["spring.force"] * -1, label="spring force [N]", ls="--"
        )
        lower.set(title="forces", ylim=(0, None))
        lower.legend()
        for ax in (upper, lower):
            ax.set(xlabel="cam angle [deg]", xticks=range(0, 361, 60))
        style.save(figure, folder, "cam_follower")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
