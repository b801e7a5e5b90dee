"""Swing-up of a pole on a cart with minimum force, and a four-bar moved from rest to rest.

Trajectory optimisation by direct collocation: the force on the cart over time, for the problem of
Kelly (SIAM Review 2017); then the torque at the crank of a four-bar, a closed loop, together with
the length of its crank for a rocker swing of 0.7 rad. Dots are the plan, lines the simulation under
these controls.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar


def build() -> da.System:
    system = da.System("swing-up", gravity=(0.0, -9.81))
    push = system.parameter("push", 5.0, "N", bounds=(-20.0, 20.0))
    length = system.parameter("length", 0.5, "m", bounds=(0.3, 0.8))
    bob = system.parameter("bob", 0.3, "kg")
    cart = system.add(planar.Body("cart", mass=1.0, inertia=0.1, position=(0, 0), angle=0))
    pole = system.add(planar.Body("pole", mass=bob, inertia=0.0, position=(0, -length), angle=0))
    system.add(planar.Prismatic("rail", system.ground.point(0, 0), cart.center))
    system.add(planar.Revolute("pivot", cart.center, pole.point(0, length)))
    system.add(planar.Force("force", cart.center, (push, 0.0)))
    return system


def four_bar() -> da.System:
    system = da.System("four-bar", gravity=(0.0, -9.81))
    torque = system.parameter("torque", 0.0, "N m", bounds=(-60.0, 60.0))
    length = system.parameter("length", 0.3, "m", bounds=(0.2, 0.45))
    crank = system.add(planar.Bar("crank", length=length, mass=1.0, angle=0.5))
    coupler = system.add(planar.Bar("coupler", length=0.9, mass=2.0, angle=0.3))
    rocker = system.add(planar.Bar("rocker", length=0.7, mass=1.5, angle=1.3))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    system.add(planar.Torque("motor", crank, torque))
    return system


def swung() -> da.TrajectoryResult:
    return da.optimize_trajectory(
        build().build(),
        da.integral("push**2"),
        ["push"],
        2.0,
        end={"cart.x": 1.0, "cart.vx": 0.0, "pole.angle": math.pi, "pole.angular_velocity": 0.0},
        subject_to=[da.Limit(da.maximum("cart.x"), upper=2.0)],
        method=da.DirectCollocation(intervals=50),
    )


def moved(vary=()) -> da.TrajectoryResult:
    ends = {"end": da.final("rocker.angle"), "begin": da.at(0.0, "rocker.angle")}
    swing = da.combined("end - begin", "swing of the rocker", **ends)
    return da.optimize_trajectory(
        four_bar().build(),
        da.integral("torque**2"),
        ["torque"],
        1.0,
        begin={"crank.angle": 0.5, "crank.angular_velocity": 0.0},
        end={"crank.angle": 0.5 + math.pi, "crank.angular_velocity": 0.0},
        subject_to=[da.Limit(swing, lower=0.7)],
        vary=vary,
        method=da.DirectCollocation(intervals=30),
    )


def main(folder=None) -> dict[str, float]:
    up, plain, designed = swung(), moved(), moved(["length"])
    numbers = {
        "force² over time [N² s]": up.fun,
        "distance of plan and run": up.deviation,
        "torque² over time [N² m² s]": plain.fun,
        "torque² with the crank designed": designed.fun,
        "length of the crank [m]": designed.x["length"],
        "swing of the rocker [rad]": float(np.ptp(designed.motion.values("rocker.angle")[[0, -1]])),
        "angle of the pole at the end [rad]": float(up.motion["pole.angle"][-1]),
    }
    print(*(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    if folder:
        picture(folder, up, plain, designed)
    return numbers


def picture(folder, up, plain, designed) -> None:
    figure, axes = plt.subplots(1, 4, figsize=(13, 3.3), width_ratios=(1.3, 1, 1, 1))
    for k, time in enumerate(np.linspace(0, 2, 9)):
        i = int(np.argmin(abs(up.motion.time - time)))
        tip = up.motion["pole.x"].values[i], up.motion["pole.y"].values[i]
        x = up.motion["cart.x"].values[i]
        axes[0].plot([x, tip[0]], [0, tip[1]], "-", color=style.BLUE, alpha=0.2 + 0.1 * k)
        axes[0].plot(*tip, "o", color=style.BLUE, alpha=0.2 + 0.1 * k)
        axes[0].plot(x, 0, "s", color=style.GREY, ms=8, alpha=0.2 + 0.1 * k)
    axes[0].set(title="swing-up in two seconds", xlabel="x [m]", ylabel="y [m]", aspect="equal")
    push = up.control("push")
    fine = np.linspace(0, 2, 400)
    axes[1].plot(fine, push(fine))
    axes[1].plot(push.times, push.values, ".", ms=4)
    axes[1].set(title="force on the cart [N]", xlabel="time [s]")
    axes[2].plot(up.motion.time, up.motion["pole.angle"], label="pole [rad]")
    axes[2].plot(up.motion.time, up.motion["cart.x"], label="cart [m]")
    for name in ("pole.angle", "cart.x"):
        axes[2].plot(up.planned.time, up.planned[name], "k.", ms=3)
    axes[2].set(title="motion", xlabel="time [s]")
    axes[2].legend(fontsize=8)
    for best, label in ((plain, "crank 0.30 m"), (designed, f"crank {designed.x['length']:.2f} m")):
        torque = best.control("torque")
        axes[3].plot(torque.times, torque.values, label=label)
    axes[3].set(title="four-bar: torque [N m]", xlabel="time [s]")
    axes[3].legend(fontsize=8)
    style.save(figure, folder, "swing_up")


if __name__ == "__main__":
    main(*sys.argv[1:])
