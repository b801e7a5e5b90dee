"""Book example 6.2: conditioning of the choice of the independent speed, and a run that changes it.

Slider, link and crank with a spring: nine coordinates, eight constraints, one independent speed u.
The others follow from w = -W^-1 U u, so det W must not vanish. With the crank's angle as u it never
does (figure 6.4); with the angle of the link or the displacement of the slider it does twice in
every turn. The last panel shows a run with automatic choice: it monitors the largest ratio of a
dependent to an independent speed, in units of energy, and changes u before this ratio grows.
"""

import math
import sys

import casadi as ca
import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

A, B, L1, L2, L3 = 2.0, 1.0, 0.8, 1.0, 0.5
CHOICES = {"crank.angle": "$θ_3$, the book's", "link.angle": "$θ_2$", "slider.x": "$x_1$"}


def build() -> da.System:
    system = da.System("partition conditioning")
    crank = system.add(
        planar.Bar("crank", length=L3, mass=0.8, angle=math.pi / 2, angular_velocity=5.0)
    )
    link = system.add(planar.Bar("link", length=L2, mass=1.0, angle=0.6))
    slider = system.add(planar.Body("slider", mass=2.0, inertia=0.1, position=(1.2, 0.4), angle=0))
    foot = slider.point(0, -0.4)
    system.add(planar.Prismatic("A", system.ground.center, foot))
    system.add(planar.Revolute("B", slider.point(0, L1 - 0.4), link.start))
    system.add(planar.Revolute("D", link.end, crank.end))
    system.add(planar.Revolute("E", system.ground.point(A, B), crank.start))
    system.add(planar.Spring("spring", system.ground.center, foot, stiffness=20.0, free_length=0.9))
    return system


def determinants(model, motion) -> dict[str, np.ndarray]:
    """|det W| along a motion, with one coordinate's speed independent."""
    e = model.equations
    jacobian = ca.Function("C", [e.t, e.y, e.p], [ca.densify(e.jacobian)])
    along = [jacobian(0, y, model.nominal).full() for y in motion.trajectory.y.T]
    found = {}
    for name in CHOICES:
        k = model.guesses.names.index(name)
        found[name] = np.array([abs(np.linalg.det(np.delete(c, k, axis=1))) for c in along])
    return found


def watched(motion) -> np.ndarray:
    """What the run watched at every step, with the speed that was independent then."""
    record = motion.record
    steps, n = record.steps, motion.trajectory.y.shape[0]
    variants = record.kernel.variants
    return np.array(
        [
            float(variants[mode].conditioning(t, x[:n], motion.parameters)[1])
            * variants[mode].formulation.limit
            for mode, t, x in zip(steps.mode, steps.t, steps.x.T, strict=False)
        ]
    )


def main(folder=None) -> dict[str, float]:
    model = build().build()
    motion = da.solve_dynamics(
        model,
        2.0,
        step=0.002,
        formulation=da.VelocityPartitioning(),
        stabilization=da.Stabilization(),
    )
    turn = motion["crank.angle"].values - math.pi / 2
    once = np.abs(turn) <= 2 * math.pi
    found, number = determinants(model, motion), watched(motion)
    numbers = {f"smallest det W, {name}": float(det[once].min()) for name, det in found.items()}
    numbers |= {
        "largest det W, crank.angle": float(found["crank.angle"][once].max()),
        "changes of partition": float(motion.statistics["variant changes"]),
        "largest number watched": float(number.max()),
        "velocity violation [m/s]": float(motion.data.velocity_violation.max()),
        "energy error [J]": float(abs(motion["balance_error"]).max()),
    }
    print(*(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    if folder:
        draw(motion, turn, once, found, number, folder)
    return numbers


def draw(motion, turn, once, found, number, folder) -> None:
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(11, 3.2))
    for time in (0.0, 0.25, 0.5):
        style.draw(left, motion, time, alpha=1 - time)
    left.set(title="the mechanism", xlabel="x [m]", ylabel="y [m]")
    angle = np.degrees(np.abs(turn[once]))
    for (name, label), colour in zip(CHOICES.items(), style.COLOURS, strict=False):
        middle.plot(angle, found[name][once], color=colour, label=label)
    middle.set(
        title="det W by the independent speed",
        xlabel="turned by the crank [°]",
        ylabel="|det W|",
        ylim=(0, 1.35),
        xticks=range(0, 361, 90),
    )
    middle.legend(loc="upper center", ncols=3)
    right.plot(motion.time[:-1], number, color=style.GREEN)
    for k in np.flatnonzero(np.diff(motion.record.steps.mode)):
        right.axvline(motion.time[k + 1], color=style.GREY, lw=0.7, zorder=0)
    right.set(title="number watched, and exchanges", xlabel="time [s]", ylim=(0, 1.7))
    style.save(figure, folder, "partition_conditioning")


if __name__ == "__main__":
    main(*sys.argv[1:])
