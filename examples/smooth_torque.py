"""A plunger pump with a spring that smooths the motor torque: optimal stiffness and free length."""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar


def build() -> da.System:
    system = da.System("smooth torque", gravity=(0.0, -9.81))
    k = system.parameter("k", 100.0, "N/m", bounds=(0, 20000))
    free = system.parameter("free", 0.35, "m", bounds=(0.2, 0.6))
    foot = system.parameter("foot", -0.6, "m", bounds=(-0.8, -0.45))
    r, l = system.parameter("r", 0.06, "m"), system.parameter("l", 0.22, "m")
    m = system.parameter("m", 9.0, "kg")
    speed = system.parameter("speed", 6 * math.pi, "rad/s")

    crank = system.add(planar.Bar("crank", length=r, mass=1.5, angle=0.0))
    rod = system.add(planar.Bar("rod", length=l, mass=1.2, angle=-1.3))
    plunger = system.add(
        planar.Body("plunger", mass=m, inertia=0.02, position=(0, -0.2), angle=0.0)
    )
    system.add(planar.Revolute("O", system.ground.center, crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, plunger.center))
    system.add(planar.Prismatic("guide", system.ground.center, plunger.center, axis=(0, 1)))
    system.add(planar.RotationalDriver("motor", system.ground, crank, speed * da.t))
    system.add(
        planar.Spring(
            "spring", system.ground.point(0, foot), plunger.center, stiffness=k, free_length=free
        )
    )
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    turn = da.InverseDynamics(duration=1 / 3, outputs=241)
    best = da.optimize(model, da.rms("motor.effort"), vary=["k", "free", "foot"], analysis=turn)
    before, after = best.history[0].objective, best.fun
    print(best.message, f"after {len(best.history) - 1} iterations")
    print(
        f"motor torque {before:.3f} N m rms before, {after:.3f} N m after, with",
        ", ".join(f"{name} = {value:.5g}" for name, value in best.x.items()),
    )
    if folder:
        figure, (left, middle, right) = plt.subplots(
            1, 3, figsize=(11, 3.8), width_ratios=(0.6, 1.2, 1)
        )
        style.draw(left, best.motion, 0.05)
        left.set(title="pump and spring", xlabel="x [m]", ylabel="y [m]")
        angle = np.degrees(best.motion["crank.angle"])
        middle.plot(angle, best.initial["motor.effort"], color=style.GREY, label="before")
        middle.plot(angle, best.motion["motor.effort"], color=style.BLUE, label="after")
        middle.set(title="motor torque [N m]", xlabel="crank angle [deg]", xticks=range(0, 361, 90))
        middle.legend()
        right.plot(np.minimum.accumulate([design.objective for design in best.history]), marker=".")
        right.set(title="rms torque [N m]", xlabel="iteration", ylim=(0, None))
        style.save(figure, folder, "smooth_torque")
    return {"before": before, "after": after, **best.x}


if __name__ == "__main__":
    main(*sys.argv[1:])
