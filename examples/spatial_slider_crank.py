"""Spatial slider-crank: the axis of the crank is parallel to the path of the slider.

Data of the IFToMM benchmark after Haug (1989). The revolute, spherical, universal and prismatic
joints remove 5 + 3 + 4 + 5 of 18 degrees of freedom; with two spherical joints the rod could rotate
about its axis.
"""

import sys

import style

import dalembert as da
from dalembert import spatial

AHEAD, ASIDE = (1, 0, 0), (0, 1, 0)
ROD = da.rotation.euler("zyx", -0.4636476, 0.7297277, -2.2142974)


def build() -> da.System:
    system = da.System("spatial slider-crank", gravity=(0.0, 0.0, -9.81))
    r = system.parameter("r", 0.08, "m", bounds=(0.05, 0.1))
    l = system.parameter("l", 0.3, "m", bounds=(0.28, 0.4))
    load = system.parameter("load", 2.0, "kg")
    omega = system.parameter("omega", 6.0, "rad/s")
    crank = spatial.Body(
        "crank",
        mass=0.12,
        inertia=(1e-4, 1e-5, 1e-4),
        position=(0, 0.1, 0.12 + r / 2),
        rotation=da.rotation.identity(),
        angular_velocity=(omega, 0, 0),
        points={"tip": (0, 0, r / 2)},
    )
    rod = spatial.Body(
        "rod",
        mass=0.5,
        inertia=(4e-4, 4e-3, 4e-3),
        position=(0.1, 0.05, 0.1),
        rotation=ROD,
        points={"start": (-l / 2, 0, 0), "end": (l / 2, 0, 0)},
    )
    slider = spatial.Body("slider", mass=load, inertia=(1e-4,) * 3, position=(0.2, 0, 0))
    for body in (crank, rod, slider):
        system.add(body)

    pivot = system.ground.frame((0, 0.1, 0.12), axis=AHEAD, x=ASIDE)
    guide, nut = (body.frame(axis=AHEAD, x=ASIDE) for body in (system.ground, slider))
    system.add(spatial.Revolute("A", pivot, crank.frame((0, 0, -r / 2), axis=AHEAD, x=ASIDE)))
    system.add(spatial.Spherical("B", crank.points["tip"], rod.points["start"]))
    system.add(spatial.Universal("C", rod.frame((l / 2, 0, 0), axis=(0, 0, 1)), nut))
    system.add(spatial.Prismatic("D", guide, nut))
    return system


def main(folder=None) -> dict[str, float]:
    motion = da.solve_dynamics(build().build(), 5.0, step=0.001, outputs=1001)
    x = da.final("slider.x", name="slider after 5 s [m]")
    numbers = {
        x.label: da.evaluate(motion, x),
        "largest error of the energy [J]": float(abs(motion["balance_error"]).max()),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, left, right = style.beside()
        style.space(left, motion, 0.1, trace="crank.tip")
        left.set_title("after 0.1 s, and path of the crank pin")
        right.plot(motion.time, motion["slider.x"])
        right.set(xlabel="time [s]", ylabel="slider [m]", title="travel of the slider")
        style.save(figure, folder, "spatial_slider_crank")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
