"""Maximum range of a catapult: optimal position of its axle and instant of release.

The run ends at an event, the release angle of the arm, whose state determines the range. The
gradient includes the change of the instant of release with the parameters.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

G, HEIGHT = 9.81, 2.0
"""Gravity [m/s^2] and height of the axle above the ground [m]."""
START = math.radians(220)
"""Direction of the long arm at the beginning: down to the left."""


def build() -> da.System:
    system = da.System("catapult", gravity=(0.0, -G))
    short = system.parameter("short", 0.9, "m", bounds=(0.2, 1.4))
    system.parameter("release", math.radians(115), "rad", bounds=(1.6, 3.0))
    length, weight = system.parameter("length", 3.0, "m"), system.parameter("weight", 120.0, "kg")
    arm = system.add(planar.Bar("arm", length=length, mass=15.0, angle=START))
    ball = system.add(planar.Particle("ball", mass=3.0, position=(-1.6, -1.3)))
    counter = system.add(planar.Particle("counter", mass=weight, position=(0.7, 0.6)))
    axle = arm.point(short - length / 2, 0)
    system.add(planar.Revolute("axle", system.ground.center, axle))
    system.add(planar.Revolute("tip", arm.end, ball.center))
    system.add(planar.Revolute("hook", arm.start, counter.center))
    system.initial(arm.angle, START)
    return system


def throw(model: da.Model) -> da.Response:
    """Where the ball comes down, from its place and velocity when it is let go."""
    x, y, vx, vy = (model[f"ball.{name}"] for name in ("x", "y", "vx", "vy"))
    flight = (vy + da.sqrt(vy**2 + 2 * G * (y + HEIGHT))) / G
    return da.at_event("let go", x + vx * flight, name="throw [m]")


def flight(motion: da.Motion) -> tuple[np.ndarray, np.ndarray]:
    """Path of the ball after the end of a run."""
    x, y, vx, vy = (float(motion[f"ball.{name}"][-1]) for name in ("x", "y", "vx", "vy"))
    times = np.linspace(0, (vy + math.sqrt(vy**2 + 2 * G * (y + HEIGHT))) / G, 60)
    return x + vx * times, y + vy * times - G * times**2 / 2


def main(folder=None) -> dict[str, float]:
    model = build().build()
    let_go = da.Event("arm.angle - release", terminal=True, direction=-1)
    swing = da.Dynamics(2.0, step=0.005, events={"let go": let_go})
    best = da.optimize(
        model, maximize=throw(model), vary=["short", "release"], analysis=swing, tolerance=1e-12
    )
    before, after = best.history[0].objective, best.fun
    instant = da.sensitivity(best.motion, da.event_time("let go"))
    print(best.message, f"after {len(best.history) - 1} iterations, {best.runs} runs")
    print(f"throw {before:.3f} m before, {after:.3f} m after, with")
    print(f"axle at {best.x['short']:.4f} m, release at {math.degrees(best.x['release']):.2f} deg")
    print(instant.to_pandas().to_string())
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(11, 3.4), width_ratios=(1, 2))
        style.draw(left, best.motion, 0.0, alpha=0.35)
        style.draw(left, best.motion, best.motion.time[-1])
        left.plot(best.motion["ball.x"], best.motion["ball.y"], color=style.PINK, lw=1)
        left.set(title="cocked, and letting go", xlabel="x [m]", ylabel="y [m]")
        for motion, label, colour in (
            (best.initial, f"before: {before:.1f} m", style.GREY),
            (best.motion, f"after: {after:.1f} m", style.BLUE),
        ):
            right.plot(*flight(motion), color=colour, label=label)
        right.axhline(-HEIGHT, color="0.3", lw=0.8)
        right.set(title="flight of the ball", xlabel="x [m]", aspect="equal")
        right.legend()
        style.save(figure, folder, "catapult")
    moves = {f"d(instant)/d({name})": instant.sel(parameter=name).item() for name in best.x}
    return {"before": before, "after": after, **best.x, **moves}


if __name__ == "__main__":
    main(*sys.argv[1:])
