"""Sewing machine, after the book's figure 1.7: needle bar and take-up lever from one crank.

The book prints no dimensions; these are of a household machine. As there, the frame is a body of
its own: 6 bodies with 18 coordinates, 6 revolute and 1 translational joint and the ground give 17
equations, and one rotational driver turns body 4, the crank.
"""

import math
import sys

import matplotlib.pyplot as plt
import style

import dalembert as da
from dalembert import planar


def build() -> da.System:
    system = da.System("sewing machine")
    r = system.parameter("r", 0.015, "m", bounds=(0.012, 0.018))
    link = system.parameter("link", 0.045, "m", bounds=(0.035, 0.06))
    pin = system.parameter("pin", 0.011, "m", bounds=(0.008, 0.014))
    advance = system.parameter("advance", 0.9, "rad")
    lever = system.parameter("lever", 0.026, "m", bounds=(0.022, 0.03))
    arm = system.parameter("arm", 0.03, "m", bounds=(0.025, 0.035))
    speed = system.parameter("speed", 40 * math.pi, "rad/s")

    frame = system.add(
        planar.Body(
            "frame",
            mass=6.0,
            inertia=0.1,
            position=(0, 0),
            angle=0.0,
            points={"shaft": (0, 0), "rocker_pivot": (-0.026, 0.03), "needle_guide": (0, -0.045)},
        )
    )
    needle_bar = system.add(
        planar.Body(
            "needle_bar",
            mass=0.06,
            inertia=1e-4,
            position=(0, -0.06),
            angle=0.0,
            points={"pin": (0, 0), "needle": (0, -0.06)},
        )
    )
    needle_link = system.add(planar.Bar("needle_link", length=link, mass=0.02, angle=-1.5))
    crank = system.add(
        planar.Body(
            "crank",
            mass=0.15,
            inertia=5e-5,
            position=(0, 0),
            angle=-math.pi / 2,
            points={
                "shaft": (0, 0),
                "needle_pin": (r, 0),
                "lever_pin": (pin * da.cos(advance), pin * da.sin(advance)),
            },
        )
    )
    take_up = system.add(
        planar.Body(
            "take_up",
            mass=0.03,
            inertia=2e-5,
            position=(0, 0.02),
            angle=2.3,
            points={"pin": (0, 0), "rocker_pin": (lever, 0), "eye": (0.06, 0.012)},
        )
    )
    rocker = system.add(planar.Bar("rocker", length=arm, mass=0.015, angle=0.5))

    system.add(planar.Weld("G", system.ground.center, frame.point("shaft")))
    system.add(planar.Revolute("R1", frame.point("shaft"), crank.point("shaft")))
    system.add(planar.Revolute("R2", crank.point("needle_pin"), needle_link.start))
    system.add(planar.Revolute("R3", needle_link.end, needle_bar.point("pin")))
    system.add(
        planar.Prismatic("T", frame.point("needle_guide"), needle_bar.point("pin"), axis=(0, 1))
    )
    system.add(planar.Revolute("R4", crank.point("lever_pin"), take_up.point("pin")))
    system.add(planar.Revolute("R5", take_up.point("rocker_pin"), rocker.end))
    system.add(planar.Revolute("R6", frame.point("rocker_pivot"), rocker.start))
    system.add(planar.RotationalDriver("motor", frame, crank, speed * da.t - math.pi / 2))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    count = model.diagnosis
    motion = da.solve_kinematics(model, 0.05, outputs=361)
    needle, eye = motion["needle_bar.needle.y"], motion["take_up.eye.y"]
    numbers = {
        "coordinates": count.coordinates,
        "equations": count.joint_equations,
        "degrees of freedom": count.gruebler,
        "needle stroke": float(needle.max() - needle.min()),
        "eye stroke": float(eye.max() - eye.min()),
    }
    print(*(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4.2), width_ratios=(1, 1.5))
        for point, colour in (("take_up.eye", style.PINK), ("needle_bar.needle", style.ORANGE)):
            left.plot(motion[f"{point}.x"], motion[f"{point}.y"], color=colour, lw=1)
        style.draw(left, motion, 0.006)
        left.set(
            title="mechanism and paths", xlabel="x [m]", ylabel="y [m]", xticks=(-0.05, 0, 0.05)
        )
        angle = 360 * motion.time / motion.time[-1]
        right.plot(angle, 1e3 * needle, color=style.ORANGE, label="needle point")
        right.plot(angle, 1e3 * eye, color=style.PINK, label="thread eye of the take-up lever")
        right.set(
            title="heights [mm]",
            xlabel="crank angle from the lowest needle position [deg]",
            xticks=range(0, 361, 90),
        )
        right.legend(loc="center right")
        style.save(figure, folder, "sewing_machine")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
