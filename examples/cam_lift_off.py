"""Cam whose roller follower lifts off: the contact force at three speeds.

The cam of the other example, with a Hunt-Crossley contact instead of a joint. The force of the
joint changes its sign at the speed at which the follower would lift off. The contact shows the real
motion: the roller lifts off and returns with an impact of many times the spring force.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style
from cam_follower import PITCH_RADIUS, ROLLER, profile

import dalembert as da
from dalembert import planar

SPEEDS = (20 * math.pi, 42 * math.pi, 54 * math.pi)
"""Below lift-off, just above it, and far above it."""


def build() -> da.System:
    system = da.System("cam that loses its follower", gravity=(0.0, -9.81))
    speed = system.parameter("speed", SPEEDS[0], "rad/s")
    stiffness = system.parameter("stiffness", 1e9, "N/m^1.5", description="of steel on steel")
    k = system.parameter("k", 4000.0, "N/m", bounds=(1000, 20000))

    shaft = {"position": (0, 0), "angle": 0.0, "angular_velocity": speed}
    cam = system.add(planar.Body("cam", mass=1.2, inertia=1e-3, **shaft))
    follower = system.add(
        planar.Body(
            "follower",
            mass=0.4,
            inertia=1e-4,
            position=(0, PITCH_RADIUS),
            velocity=(0, 0),
            points={"stem": (0, 0.035), "top": (0, 0.06)},
        )
    )
    system.add(planar.Revolute("shaft", system.ground.center, cam.center))
    stem = follower.point("stem")
    system.add(planar.Prismatic("guide", system.ground.center, stem, axis=(0, 1)))
    system.add(planar.RotationalDriver("motor", system.ground, cam, speed * da.t))
    top, above = follower.point("top"), system.ground.point(0, 0.16)
    system.add(planar.Spring("spring", top, above, stiffness=k, free_length=0.075))
    kit = planar.contact
    system.add(
        planar.Contact(
            "contact",
            kit.Profile(cam, da.SplineCurve(profile(60))),
            kit.Circle(follower.center, ROLLER),
            law=kit.HuntCrossley(stiffness=stiffness, damping=2.0),
        )
    )
    return system


def runs(model: da.Model) -> list[da.Motion]:
    """Two turns at each speed; the second has forgotten how it started."""
    integrator = da.DormandPrince(rtol=1e-7, atol=1e-9)
    return [
        da.solve_dynamics(
            model,
            4 * math.pi / speed,
            integrator=integrator,
            parameters={"speed": speed},
            outputs=721,
        )
        for speed in SPEEDS
    ]


def main(folder=None) -> dict[str, float]:
    motions = runs(build().build())
    numbers = {}
    for speed, motion in zip(SPEEDS, motions, strict=True):
        later = motion.time > 2 * math.pi / speed
        flown = float(np.mean(motion["contact.gap"].values[later] > 0))
        numbers[f"largest force at {speed:.0f} rad/s"] = float(
            motion["contact.force"].values[later].max()
        )
        numbers[f"share of the turn in flight at {speed:.0f} rad/s"] = flown
    print(*(f"{name}: {value:.4g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, upper, lower) = plt.subplots(
            1, 3, figsize=(11, 3.6), width_ratios=(0.8, 1, 1)
        )
        late = motions[-1]
        gap = late["contact.gap"].values
        style.draw(left, late, float(late.time[np.argmax(gap)]))
        left.set(title=f"in flight at {SPEEDS[-1]:.0f} rad/s", xlabel="x [m]", ylabel="y [m]")
        for speed, motion in zip(SPEEDS, motions, strict=True):
            angle = np.degrees(speed * motion.time) - 360
            upper.plot(angle, 1e3 * (motion["follower.y"] - PITCH_RADIUS), label=f"{speed:.0f}")
            lower.plot(angle, motion["contact.force"], label=f"{speed:.0f} rad/s", lw=1.1)
        upper.set(title="height of the follower [mm]")
        lower.set(title="contact force [N]", ylim=(0, None))
        lower.legend()
        for ax in (upper, lower):
            ax.set(xlabel="cam angle [deg]", xticks=range(0, 361, 60), xlim=(0, 360))
        style.save(figure, folder, "cam_lift_off")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
