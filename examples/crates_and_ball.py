"""A ball hits a stack of crates: shapes by groups, coefficients of their pairs, contact forces.

The stack stands until the ball arrives. Circles, rectangles, a polygon and a capsule touch each
other; crates have more friction than the ball.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

CRATE = (0.346, 0.2)
"""Width and height [m]."""


def build() -> da.System:
    system = da.System("crates and ball", gravity=(0.0, -9.81))
    speed = system.parameter("speed", 6.0, "m/s", bounds=(0.0, 10.0))
    grip = system.parameter("grip", 0.6, bounds=(0.1, 1.0))
    rows = {"lower": (2.0, 0.0267, 0.1), "middle": (2.0, 0.0267, 0.3), "upper": (1.0, 0.01, 0.5)}
    flight = {"position": (-1.0, 0.35), "velocity": (speed, 0.0)}
    ball = system.add(planar.Body("ball", mass=4.0, inertia=0.02, **flight))
    lower, middle, upper = (
        system.add(planar.Body(name, mass=mass, inertia=inertia, position=(0.0, y)))
        for name, (mass, inertia, y) in rows.items()
    )
    chute = system.ground.point(-1.1, 0.2), system.ground.point(-0.6, 0.15)
    shapes = {
        "balls": [planar.contact.Circle(ball.center, 0.1)],
        "crates": [
            planar.contact.Rectangle(lower.center, CRATE),
            planar.contact.Rectangle(middle.center, CRATE),
            planar.contact.Polygon(upper, [(-0.15, -0.1), (0.15, -0.1), (0.0, 0.15)]),
        ],
        "ground": [
            planar.contact.HalfPlane(system.ground.center),
            planar.contact.Capsule(*chute, 0.05),
        ],
    }
    pairs = [
        planar.contact.Pair(("crates", other), friction=grip, restitution=0.0)
        for other in ("ground", "crates")
    ]
    contacts = {"friction": 0.2, "restitution": 0.1, "pairs": pairs}
    system.add(planar.Collisions("contacts", shapes, **contacts))
    return system


def solve(duration: float = 0.7, step: float = 2e-3) -> da.Motion:
    return da.solve_nonsmooth(build().build(), duration, step=step)


def picture(motion: da.Motion, folder) -> None:
    """Before, during and after the impact, with contact forces."""
    figure, axes = plt.subplots(1, 3, figsize=(11, 2.0))
    for ax, time in zip(axes, (0.06, 0.16, motion.time[-1]), strict=True):
        motion.draw(time, ax)
        ax.set(title=f"t = {time:.2f} s", xlim=(-1.2, 1.9), ylim=(-0.1, 0.9))
        ax.grid(False)
    style.save(figure, folder, "crates_and_ball")


def main(folder=None) -> dict[str, float]:
    """Draw the impact; returns what happened to the stack."""
    motion = solve()
    print(motion)
    energy, hit = motion.data["energy"].values, motion.values("ball.vx") < 3.0
    before = motion.time < motion.time[int(np.argmax(hit))] - 0.01
    still = np.ptp(motion.values("upper.x")[before]) + np.ptp(motion.values("upper.y")[before])
    results = {
        "finished": float(motion.status.success),
        "motion of the stack before the impact [m]": float(still),
        "displacement of the upper crate [m]": float(motion.values("upper.x")[-1]),
        "maximum penetration [m]": float(motion.data["penetration"].max()),
        "energy left [share]": float(energy[-1] / energy[0]),
    }
    for name, value in results.items():
        print(f"{name:44s} {value:.3g}")
    if folder:
        picture(motion, folder)
    return results


if __name__ == "__main__":
    main(*sys.argv[1:])
