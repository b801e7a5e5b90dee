"""A walking four-bar: its lengths are optimised so that the coupler point follows a given path.

The path is 48 points of a foot with a straight stance phase, passed in one turn of the crank. The
mean square distance to it is minimised over nine parameters, with Grashof's limits so that the
crank makes full turns.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

# the wanted path [mm], every 7.5 degrees of the crank or 0.1 s
# fmt: off
FOOT = np.array([
    (80.00, 195.96), (105.13, 194.20), (127.44, 189.55), (145.24, 183.46),
    (158.17, 177.29), (166.73, 171.92), (171.71, 167.68), (173.85, 164.58),
    (173.81, 162.48), (172.06, 161.16), (169.00, 160.42), (164.90, 160.09),
    (160.00, 160.00), (154.48, 160.05), (148.49, 160.16), (142.15, 160.28),
    (135.55, 160.36), (128.78, 160.39), (121.89, 160.37), (114.94, 160.32),
    (107.95, 160.24), (100.96, 160.15), (93.97, 160.07), (86.98, 160.02),
    (80.00, 160.00), (73.02, 160.02), (66.03, 160.07), (59.04, 160.15),
    (52.05, 160.24), (45.06, 160.32), (38.11, 160.37), (31.22, 160.39),
    (24.45, 160.36), (17.85, 160.28), (11.51, 160.16), (5.52, 160.05),
    (0.00, 160.00), (-4.90, 160.09), (-9.00, 160.42), (-12.06, 161.16),
    (-13.81, 162.48), (-13.85, 164.58), (-11.71, 167.68), (-6.73, 171.92),
    (1.83, 177.29), (14.76, 183.46), (32.56, 189.55), (54.87, 194.20),
])
# fmt: on


def target(column: int) -> da.laws.Table:
    """One coordinate of the wanted path as a periodic law of time."""
    closed = np.vstack([FOOT, FOOT[:1]])[:, column] / 1000
    return da.laws.Table(np.arange(49) / 10, closed, periodic=True)


def build() -> da.System:
    system = da.System("walking leg")
    l0 = system.parameter("l0", 0.090, "m", bounds=(0.05, 0.12))
    l1 = system.parameter("l1", 0.030, "m", bounds=(0.02, 0.06))
    l2 = system.parameter("l2", 0.080, "m", bounds=(0.06, 0.15))
    l3 = system.parameter("l3", 0.085, "m", bounds=(0.06, 0.15))
    a = system.parameter("a", 0.15, "m", bounds=(0.08, 0.25))
    b = system.parameter("b", 0.02, "m", bounds=(-0.05, 0.05))
    phase = system.parameter("phase", 0.3, "rad", bounds=(-1.5, 1.5))
    x = system.parameter("x", 0.01, "m", bounds=(-0.05, 0.05))
    y = system.parameter("y", -0.01, "m", bounds=(-0.05, 0.05))

    crank = system.add(planar.Bar("crank", length=l1, mass=0.03, angle=phase))
    coupler = system.add(
        planar.Bar("coupler", length=l2, mass=0.1, angle=1.0, points={"foot": (a - l2 / 2, b)})
    )
    rocker = system.add(planar.Bar("rocker", length=l3, mass=0.1, angle=1.5))
    wanted = system.add(planar.Particle("wanted", position=FOOT[0] / 1000))
    system.add(planar.Revolute("O1", system.ground.point(x, y), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(x + l0, y), rocker.start))
    system.add(
        planar.RotationalDriver("motor", system.ground, crank, phase + 2 * math.pi * da.t / 4.8)
    )
    system.add(planar.CoordinateDriver("wanted_x", wanted.center, target(0), direction=(1, 0)))
    system.add(planar.CoordinateDriver("wanted_y", wanted.center, target(1), direction=(0, 1)))
    return system


def task(model: da.Model) -> dict:
    """What ``optimize`` is asked: objective, limits and analysis."""
    error = da.mean(
        "((coupler.foot.x - wanted.x)**2 + (coupler.foot.y - wanted.y)**2)*1e6",
        name="mean square error [mm^2]",
    )
    shortest = (
        da.final("l2 + l3 - l0 - l1"),
        da.final("l0 - l1 + l2 - l3"),
        da.final("l0 - l1 - l2 + l3"),
    )
    limits = [da.Limit(response, lower=0.005) for response in shortest]
    return {
        "minimize": error,
        "subject_to": limits,
        "analysis": da.Kinematics(duration=4.8, outputs=97),
    }


def main(folder=None) -> dict[str, float]:
    model = build().build()
    best = da.optimize(model, **task(model), max_iterations=200, tolerance=1e-12)
    before, after = (math.sqrt(best.history[k].objective) for k in (0, -1))
    print(best.message, f"after {len(best.history) - 1} iterations, {best.runs} runs")
    print(f"distance to the path: {before:.2f} mm rms before, {after:.4f} mm after")
    print(", ".join(f"{name} = {value:.5f}" for name, value in best.x.items()))
    if folder:
        figure, axes = plt.subplots(1, 3, figsize=(11, 3.7), width_ratios=(1, 1, 0.9))
        for ax, motion, title in zip(
            axes, (best.initial, best.motion), ("before", "after"), strict=False
        ):
            ax.plot(*FOOT.T / 1000, "o", ms=3, color=style.GREY, label="wanted path")
            ax.plot(
                motion["coupler.foot.x"],
                motion["coupler.foot.y"],
                color=style.PINK,
                label="path of the foot",
            )
            style.draw(ax, motion, 0.5)
            ax.set(title=title, xlabel="x [m]", ylabel="y [m]")
        axes[0].legend(loc="center right", bbox_to_anchor=(1, 0.42))
        errors = np.sqrt([design.objective for design in best.history])
        axes[2].semilogy(np.minimum.accumulate(errors), marker=".")
        axes[2].set(title="distance to the path [mm rms]", xlabel="iteration")
        style.save(figure, folder, "path_optimization")
    return {"before": before, "after": after, "success": best.success, **best.x}


if __name__ == "__main__":
    main(*sys.argv[1:])
