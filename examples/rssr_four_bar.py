"""RSSR four-bar: a crank about z drives a rocker about x through a rod with two spherical joints.

The closure |A − B|² = l² is one equation for the angle ψ of the rocker, P cos ψ + Q sin ψ = R, with
two roots, the two assembly configurations; both are computed. The rod is a massless link; a body
between two spherical joints could rotate about its own axis.
"""

import sys

import numpy as np
import style

import dalembert as da
from dalembert import spatial

AHEAD, ASIDE, UP = (1, 0, 0), (0, 1, 0), (0, 0, 1)


def build() -> da.System:
    system = da.System("RSSR four-bar")
    a = system.parameter("a", 0.1, "m", bounds=(0.05, 0.12))
    b = system.parameter("b", 0.25, "m", bounds=(0.2, 0.4))
    rod = system.parameter("l", 0.45, "m", bounds=(0.4, 0.5))
    off = system.parameter("off", -0.1, "m", bounds=(-0.15, 0.1))
    level, leaning = da.rotation.identity(), da.rotation.axis_angle(AHEAD, 1.9)
    crank = spatial.Body("crank", position=(0, 0, 0), rotation=level, points={"tip": (a, 0, 0)})
    rocker = spatial.Body(
        "rocker", position=(0, 0.5, off), rotation=leaning, points={"tip": (0, b, 0)}
    )
    pivot = system.ground.frame((0, 0.5, off), axis=AHEAD, x=ASIDE)
    system.add(crank)
    system.add(rocker)
    shaft = spatial.Revolute(
        "O", system.ground.frame(axis=UP, x=AHEAD), crank.frame(axis=UP, x=AHEAD)
    )
    system.add(shaft)
    system.add(spatial.Revolute("C", pivot, rocker.frame(axis=AHEAD, x=ASIDE)))
    system.add(spatial.RigidLink("rod", crank.points["tip"], rocker.points["tip"], length=rod))
    system.add(spatial.RotationalDriver("motor", shaft, 2 * np.pi * da.t))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    motion = da.solve_kinematics(model, 1.0, outputs=361)
    angle = np.unwrap(motion["C.angle"].values)
    numbers = {
        "ways to close at the start": float(len(da.solve_assembly(model, all=True))),
        "angle of the rocker at the start [deg]": np.degrees(angle[0]),
        "swing of the rocker [deg]": np.degrees(np.ptp(angle)),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, left, right = style.beside()
        style.space(left, motion, 0.1, trace="rocker.tip")
        left.set_title("crank and rocker, path of the rocker's tip")
        right.plot(360 * motion.time, np.degrees(angle))
        right.set(xlabel="crank [°]", ylabel="rocker [°]", title="one turn of the crank")
        style.save(figure, folder, "rssr_four_bar")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
