"""A Geneva drive with its locking disc, all of rigid convex shapes: pin, slots and lock.

The pin turns the wheel by a quarter while the lock is open; ``tan ψ = r sin θ/(a − r cos θ)`` in a
slot, for the distance a of the axes and r = a/√2. Then the locking disc holds two faces of the
wheel, which has no other restraint. Each arm of the wheel consists of two polygons. Deviations
from the law are those of the clearances.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

APART, PIN, CLEARANCE, SPEED = 0.1, 0.004, 5e-5, 4 * math.pi
REACH, LOCK = APART / math.sqrt(2), 0.055
"""Radius of the pin's path and of the wheel, radius of the lock [m]."""
FACE, OPEN, FACET = (math.radians(degrees) for degrees in (15, 32, 4))
"""Direction in which the lock touches the wheel, half the opening of the lock, arc of a facet."""
START, TURN = -0.4 * math.pi, 2 * math.pi / SPEED


def arm(k: int, side: int) -> list[tuple[float, float]]:
    """Corners of one half of the wheel between two slots, anticlockwise."""
    slot, along = PIN + CLEARANCE, np.array([math.sin(FACE), math.cos(FACE)])
    touch = np.array([APART - LOCK * math.cos(FACE), LOCK * math.sin(FACE)])
    base = touch - touch[1] / along[1] * along
    mouth = (REACH + slot) / math.sqrt(2), (REACH - slot) / math.sqrt(2)
    corners = np.array([(slot * math.sqrt(2), 0), base, touch + 0.025 * along, mouth])
    corners = (corners * [1, side])[::side]
    c, s = math.cos(k * math.pi / 2), math.sin(k * math.pi / 2)
    return [tuple(corner) for corner in corners @ np.array([[c, s], [-s, c]])]


def lock(low: float, high: float) -> list[tuple[float, float]]:
    """Corners of a sector of the locking disc."""
    angles = np.linspace(low, high, round((high - low) / FACET) + 1)
    radius = LOCK - CLEARANCE
    return [(0.0, 0.0), *((radius * math.cos(a), radius * math.sin(a)) for a in angles)]


def build() -> da.System:
    system = da.System("Geneva drive")
    speed = system.parameter("speed", SPEED, "rad/s", bounds=(1.0, 30.0))
    friction = system.parameter("friction", 0.1, bounds=(0.0, 0.3))
    inertia = system.parameter("inertia", 2e-4, "kg m^2", bounds=(1e-5, 1e-2))
    turning = {"angle": START, "angular_velocity": speed, "position": (0, 0)}
    crank = system.add(
        planar.Body("crank", mass=1.0, inertia=1e-3, points={"pin": (REACH, 0)}, **turning)
    )
    at = {"position": (APART, 0), "angle": math.pi}
    wheel = system.add(planar.Body("wheel", mass=0.3, inertia=inertia, **at))
    system.add(planar.Revolute("A", system.ground.center, crank.center))
    system.add(planar.Revolute("B", system.ground.point(APART, 0), wheel.center))
    law = START + speed * da.t
    system.add(planar.RotationalDriver("motor", system.ground, crank, law))
    kit = planar.contact
    shapes = {
        "pin": [kit.Circle(crank.point("pin"), PIN)],
        "lock": [
            kit.Polygon(crank, lock(low, high))
            for low, high in ((OPEN, math.pi), (math.pi, 2 * math.pi - OPEN))
        ],
        "wheel": [kit.Polygon(wheel, arm(k, side)) for k in range(4) for side in (1, -1)],
    }
    system.add(planar.Collisions("contacts", shapes, friction=friction))
    return system


def solve() -> da.Motion:
    """One turn of the crank."""
    scheme = da.MoreauJean()
    return da.solve_nonsmooth(build().build(), TURN, step=1e-3, integrator=scheme)


def ideal(angle: np.ndarray) -> np.ndarray:
    """Angle of the wheel by that of the crank, locked before and after the slot."""
    within = np.clip(angle, -math.pi / 4, math.pi / 4)
    turned = np.arctan2(REACH * np.sin(within), APART - REACH * np.cos(within))
    return -turned - math.pi / 4


def picture(motion: da.Motion, folder) -> None:
    """The drive while the wheel is locked and while it turns, and the angle of the wheel."""
    figure, axes = plt.subplots(1, 3, figsize=(10, 3.2))
    crank = motion.values("crank.angle")
    for ax, angle, title in zip(axes, (math.pi, -0.3), ("locked", "turning"), strict=False):
        style.draw(ax, motion, float(np.interp(angle, crank, motion.time)))
        ax.set(title=title, xlabel="x [m]", ylabel="y [m]")
        ax.grid(False)
    angle = motion.values("wheel.angle") - math.pi
    axes[2].plot(np.degrees(crank), np.degrees(ideal(crank)), color=style.GREY, lw=4, alpha=0.4)
    axes[2].plot(np.degrees(crank), np.degrees(angle))
    axes[2].set(title="angle of the wheel [°]", xlabel="angle of the crank [°]")
    axes[2].set(xticks=range(-90, 300, 90), yticks=(0, -45, -90))
    style.save(figure, folder, "geneva_drive")


def main(folder=None) -> dict[str, float]:
    motion = solve()
    print(motion)
    crank, angle = motion.values("crank.angle"), motion.values("wheel.angle") - math.pi
    deviation, turning = np.abs(angle - ideal(crank)), np.abs(crank) < math.pi / 4
    speeds = np.gradient(angle, motion.time)
    numbers = {
        "finished": float(motion.status.success),
        "turned [deg]": math.degrees(angle[-1]),
        "deviation in the slot [mrad]": 1e3 * deviation[turning].max(),
        "deviation in the lock [mrad]": 1e3 * deviation[np.abs(crank) > OPEN + FACE].max(),
        "maximum speed over that of the crank": -speeds.min() / SPEED,
        "maximum penetration [m]": float(motion.data["penetration"].max()),
    }
    for name, value in numbers.items():
        print(f"{name:38s} {value:.4g}")
    if folder:
        picture(motion, folder)
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
