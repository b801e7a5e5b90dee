"""A ball hits a stack of crates: shapes, groups and contact forces of a model file.

The stack stands until the ball arrives. Circles, rectangles, a polygon and a capsule touch each
other; crates have more friction than the ball.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert.io import load

FILE = Path(__file__).with_suffix(".toml")


def solve(duration: float = 0.7, step: float = 2e-3) -> da.Motion:
    return da.solve_nonsmooth(load(FILE).build(), duration, step=step)


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
