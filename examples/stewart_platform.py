"""Stewart platform: the forces in six legs that carry a platform along a prescribed motion.

The platform heaves, sways and pitches. The massless legs are distance drivers whose laws are the
leg lengths of this motion, as formulas of time; inverse dynamics computes their forces. They
satisfy Newton's and Euler's equations of the platform.
"""

import sys

import numpy as np
import style

import dalembert as da
from dalembert import spatial

MASS, INERTIA, HEIGHT, G, PERIOD = 50.0, (1.2, 1.5, 2.4), 0.9, 9.81, 2.0
BASE = np.array([(np.cos(a), np.sin(a), 0) for a in np.radians([-8, 8, 112, 128, 232, 248])])
TOP = np.array(
    [(0.6 * np.cos(a), 0.6 * np.sin(a), -0.05) for a in np.radians([-52, 52, 68, 172, 188, 292])]
)


def wanted(t):
    """Place (3,) and orientation (3, 3) by rows that the platform shall have, of time."""
    turn = 2 * np.pi / PERIOD * t
    place = (0.12 * da.sin(turn), 0.08 - 0.08 * da.cos(turn), HEIGHT + 0.1 * da.sin(2 * turn))
    nod, roll = 0.15 * da.sin(turn), 0.1 - 0.1 * da.cos(turn)
    c, s, u, w = da.cos(nod), da.sin(nod), da.cos(roll), da.sin(roll)
    return place, ((u, 0.0, w), (s * w, c, -s * u), (-c * w, s, c * u))


def leg(foot, top, t):
    """Vector from the foot to the upper end of a leg, of time."""
    place, rows = wanted(t)
    return [
        p + sum(a * x for a, x in zip(row, top, strict=True)) - f
        for p, row, f in zip(place, rows, foot, strict=True)
    ]


def build() -> da.System:
    system = da.System("Stewart platform", gravity=(0.0, 0.0, -G))
    platform = spatial.Body(
        "platform",
        mass=system.parameter("m", MASS, "kg"),
        inertia=INERTIA,
        position=(0, 0, HEIGHT),
        rotation=da.rotation.identity(),
        points={f"P{k}": tuple(top) for k, top in enumerate(TOP)},
    )
    system.add(platform)
    for k, (foot, top) in enumerate(zip(BASE, TOP, strict=True)):
        length = da.sqrt(sum(x**2 for x in leg(foot, top, da.t)))
        ends = system.ground.point(*foot), platform.points[f"P{k}"]
        system.add(spatial.DistanceDriver(f"leg{k}", *ends, length))
    return system


def main(folder=None) -> dict[str, float]:
    motion = da.solve_inverse_dynamics(build().build(), PERIOD, step=0.01)
    forces = np.stack([motion[f"leg{k}.effort"].values for k in range(6)])
    power = sum(motion[f"leg{k}.power"].values for k in range(6))
    numbers = {
        "largest force in a leg [N]": float(abs(forces).max()),
        "work of a period [J]": float(np.trapezoid(power, motion.time)),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, left, right = style.beside()
        style.space(left, motion, 0.3)
        left.set_title("after 0.3 s")
        for k, force in enumerate(forces):
            right.plot(motion.time, force, label=f"leg {k}")
        right.set(xlabel="time [s]", ylabel="force [N]", title="forces of the legs, pushing")
        right.legend(ncols=3)
        style.save(figure, folder, "stewart_platform")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
