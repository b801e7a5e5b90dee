"""A chain hoist: a sprocket lifts a load by a roller chain, with a polygon effect.

Rollers rest on the root of the sprocket between its teeth, all rigid; a lighter load keeps the
other strand taut. A turn of a sprocket of z teeth lifts by z pitches. The strand leaves a sprocket
of radius R at angles ``|θ| ≤ π/z``, so that the lifting speed varies between ``ω R cos (π/z)`` and
``ω R``, and the mean moment is ``(m₁ − m₂) g z p/2π`` and what impacts of rollers dissipate.
"""

import math
import sys
from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

PITCH, ROLLER, TEETH = 12.7e-3, 7.92e-3, 8
RADIUS = PITCH / (2 * math.sin(math.pi / TEETH))
LOAD, OTHER, MASS, G = 4.0, 2.0, 0.009, 9.81
"""Loads and mass of a link [kg]."""
SPEED, RAMP, END = 4.0, 0.03, 0.8
"""Angular velocity [rad/s], time of the start, end of the run [s]."""
HANGING = 8, 3
"""Links of the strands of the load and of the other one at the start."""
CLEARANCE = 1e-4


def tooth(k: int) -> list[tuple[float, float]]:
    """Corners of the tooth between two seats, anticlockwise."""
    middle = (k + 0.5) * 2 * math.pi / TEETH
    c, s = math.cos(middle), math.sin(middle)
    half = (PITCH - ROLLER) / 2 - CLEARANCE
    base, height = RADIUS * math.cos(math.pi / TEETH), 0.3 * PITCH
    corners = (RADIUS / 2, -half), (base, -half), (base + height, -0.35 * half)
    upper = [(x, -y) for x, y in corners[::-1]]
    return [(x * c - y * s, x * s + y * c) for x, y in (*corners, *upper)]


def pins() -> np.ndarray:
    """(n, 2) pins of the chain, from the load over the sprocket to the other load."""
    seats = np.arange(TEETH // 2 + 1) * 2 * math.pi / TEETH
    over = RADIUS * np.column_stack([np.cos(seats), np.sin(seats)])
    strands = [
        np.column_stack([np.full(n, side * RADIUS), -PITCH * np.arange(1, n + 1)])
        for n, side in zip(HANGING, (1, -1), strict=True)
    ]
    return np.vstack([strands[0][::-1], over, strands[1]])


def build() -> da.System:
    system = da.System("chain hoist", gravity=(0.0, -G))
    speed = system.parameter("speed", SPEED, "rad/s", bounds=(0.5, 10.0))
    load = system.parameter("load", LOAD, "kg", bounds=(2.5, 20.0))
    damping = system.parameter("damping", 1e-3, "N m s/rad")
    sprocket = planar.Body("sprocket", mass=0.5, inertia=5e-4, position=(0, 0), angle=0.0)
    system.add(sprocket)
    system.add(planar.Revolute("axle", system.ground.center, sprocket.center))
    law = speed * (da.t + RAMP * (da.exp(-da.t / RAMP) - 1))
    system.add(planar.RotationalDriver("motor", system.ground, sprocket, law))
    places, links = pins(), []
    for k, (here, there) in enumerate(pairwise(places)):
        lean, middle = math.atan2(*(there - here)[::-1]), tuple((here + there) / 2)
        link = planar.Bar(f"link{k}", length=PITCH, mass=MASS, position=middle, angle=lean)
        links.append(system.add(link))
    for k, (one, other) in enumerate(pairwise(links)):
        system.add(planar.Revolute(f"pin{k + 1}", one.end, other.start))
        bend = {"stiffness": 0.0, "damping": damping}
        system.add(planar.TorsionSpring(f"bend{k + 1}", one, other, **bend))
    hung = ("load", load, links[0].start, places[0]), ("other", OTHER, links[-1].end, places[-1])
    for name, mass, end, place in hung:
        weight = system.add(planar.Particle(name, mass=mass, position=tuple(place)))
        system.add(planar.Revolute(f"{name}_pin", end, weight.center))
    kit = planar.contact
    shapes = {
        "sprocket": [
            kit.Circle(sprocket.center, RADIUS - ROLLER / 2),
            *(kit.Polygon(sprocket, tooth(k)) for k in range(TEETH)),
        ],
        "rollers": [kit.Circle(link.start, ROLLER / 2) for link in links],
    }
    apart = kit.Pair(("rollers", "rollers"), touching=False)
    system.add(planar.Collisions("contacts", shapes, pairs=[apart]))
    return system


def solve(end: float = END) -> da.Motion:
    return da.solve_nonsmooth(build().build(), end, step=1e-3)


def strand(angle: np.ndarray) -> np.ndarray:
    """Angle of the last roller on the sprocket to the horizontal [rad]."""
    step = 2 * math.pi / TEETH
    return (angle + step / 2) % step - step / 2


def picture(motion: da.Motion, folder) -> None:
    """The hoist at the start and at the end, and the lifting speed by the angle."""
    figure, axes = plt.subplots(1, 3, figsize=(10, 4), width_ratios=(1, 1, 2.2))
    for ax, time in zip(axes, (0.0, motion.time[-1]), strict=False):
        style.draw(ax, motion, time)
        ax.set(title=f"t = {time:.2f} s", xlabel="x [m]", ylabel="y [m]")
        ax.set(xlim=(-0.04, 0.04), ylim=(-0.115, 0.03))
        ax.set_aspect("equal", adjustable="box")
        ax.grid(False)
    angle, speed = motion.values("sprocket.angle"), motion.values("load.vy")
    axes[2].plot(np.degrees(angle), speed / (SPEED * RADIUS), lw=1.2)
    ideal = np.cos(strand(angle)) * motion.values("sprocket.angular_velocity") / SPEED
    axes[2].plot(np.degrees(angle), ideal, color=style.GREY, lw=4, alpha=0.4)
    axes[2].set(
        title="lifting speed over ω R", xlabel="angle of the sprocket [°]", ylim=(0.85, 1.02)
    )
    style.save(figure, folder, "chain_hoist")


def main(folder=None, end: float = END) -> dict[str, float]:
    motion = solve(end)
    print(motion)
    angle, height = motion.values("sprocket.angle"), motion.values("load.y")
    pitch = 2 * math.pi / TEETH
    steady = angle > angle[-1] - pitch
    off = motion.values("load.vy") / (SPEED * RADIUS) - np.cos(strand(angle))
    moment = np.abs(motion.values("motor.moment")[steady]).mean()
    work, lost = (LOAD - OTHER) * G * PITCH, np.ptp(motion.data["dissipated_energy"].values[steady])
    numbers = {
        "finished": float(motion.status.success),
        "lift in a pitch of the sprocket [p]": np.ptp(height[steady]) / PITCH,
        "deviation of the speed [ω R]": np.abs(off[steady]).max(),
        "mean moment [(m₁ − m₂) g z p/2π]": moment * pitch / work,
        "energy dissipated in a pitch [(m₁ − m₂) g p]": lost / work,
        "maximum penetration [m]": float(motion.data["penetration"].max()),
    }
    for name, value in numbers.items():
        print(f"{name:44s} {value:.4g}")
    if folder:
        picture(motion, folder)
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
