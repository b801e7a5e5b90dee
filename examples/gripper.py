"""Synthesis of a gripper: a slider opens two fingers by links, with a constant force ratio.

The model is the upper half. The slider moves by 20 mm; the tip of the finger must move linearly
from 10 to 40 mm (function generation, driven by a slider). Then the ratio of slider force and tip
force is constant: by virtual work it is the ratio of their speeds, 30 over 20. The variables are
the positions of all pins and of the tip.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

STROKE, OPEN, CLOSED = 0.02, 0.04, 0.01
START = {"pivot_x": 0.03, "pivot_y": 0.045, "pin_x": 0.035, "pin_y": 0.01, "slider_y": 0.008}


def build() -> da.System:
    """In the position in the middle: the slider at the origin, the tip half open."""
    system = da.System("gripper")
    value = {n: system.parameter(n, v, "m", (v - 0.008, v + 0.008)) for n, v in START.items()}
    tip_x = system.parameter("tip_x", 0.09, "m", (0.07, 0.12))
    tip_y = (OPEN + CLOSED) / 2
    px, py, qx, qy = (value[n] for n in ("pivot_x", "pivot_y", "pin_x", "pin_y"))
    slider = system.add(planar.Body("slider", position=(0.0, 0.0), angle=0.0))
    finger = system.add(
        planar.Body(
            "finger",
            position=(px, py),
            angle=0.0,
            points={"pin": (qx - px, qy - py), "tip": (tip_x - px, tip_y - py)},
        )
    )
    link = system.add(
        planar.Body(
            "link",
            position=(0.0, value["slider_y"]),
            angle=0.0,
            points={"end": (qx, qy - value["slider_y"])},
        )
    )
    ground = system.ground
    system.add(planar.Prismatic("guide", ground.point(0, 0), slider.center, axis=(1, 0)))
    system.add(planar.Revolute("pivot", ground.point(px, py), finger.center))
    system.add(planar.Revolute("ear", slider.point(0.0, value["slider_y"]), link.center))
    system.add(planar.Revolute("pin", link.points["end"], finger.points["pin"]))
    law = -STROKE / 2 + STROKE * da.t
    system.add(planar.CoordinateDriver("push", slider.center, law, direction=(1, 0)))
    return system


RATIO = "finger.tip.vy/slider.vx"
"""Of the speeds: the force on the slider over that at the tip."""


def main(folder=None) -> dict[str, float]:
    model = build().build()
    stroke = da.Kinematics(1.0, outputs=41)
    even = f"(finger.tip.y - ({CLOSED} + {OPEN - CLOSED}*t))/{OPEN - CLOSED}"
    best = da.optimize(
        model,
        da.rms(even, name="miss"),
        subject_to=[da.Limit(da.final("pin_y - slider_y"), lower=0.003)],
        analysis=stroke,
    )
    numbers = {
        "miss before": best.history[0].objective,
        "miss": best.fun,
        "ratio, least": float(abs(best.motion.values(RATIO)).min()),
        "ratio, largest": float(abs(best.motion.values(RATIO)).max()),
        **{f"{n} [mm]": 1e3 * v for n, v in best.x.items()},
    }
    print(*(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    print(best.message)
    if folder:
        picture(folder, best)
    return numbers


def picture(folder, best: da.OptimizationResult) -> None:
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(11, 3.6))
    motion = best.motion
    for k, alpha in ((0, 1.0), (20, 0.5), (40, 0.3)):
        at = {
            name: 1e3 * np.array([motion.values(f"{name}.{a}")[k] for a in "xy"])
            for name in ("finger", "finger.pin", "finger.tip", "link")
        }
        x = 1e3 * motion.values("slider.x")[k]
        for side in (1, -1):
            s = np.array([1, side])
            arm = np.array([at["finger.pin"] * s, at["finger"] * s, at["finger.tip"] * s])
            left.fill(*arm.T, fc=(style.BLUE, 0.25 * alpha), ec=(style.BLUE, alpha))
            rod = np.array([at["link"] * s, at["finger.pin"] * s])
            left.plot(*rod.T, "o-", color=style.ORANGE, alpha=alpha, ms=4)
            left.plot(*(at["finger"] * s), "o", color="0.3")
        height = at["link"][1]
        left.plot([x, x], [-height, height], color=style.GREY, lw=4, alpha=alpha)
    left.set(title="gripper", xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
    for label, run in (("before", best.initial), ("after", best.motion)):
        way = 1e3 * (run.values("slider.x") + STROKE / 2)
        middle.plot(way, 1e3 * run.values("finger.tip.y"), label=label)
        right.plot(way, abs(run.values(RATIO)))
    middle.set(title="half opening [mm]", xlabel="way of the slider [mm]")
    right.set(title="slider force over grip force", xlabel="way of the slider [mm]")
    right.set_ylim(0, None)
    middle.legend()
    style.save(figure, folder, "gripper")


if __name__ == "__main__":
    main(*sys.argv[1:])
