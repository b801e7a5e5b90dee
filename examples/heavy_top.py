"""Heavy top: a rotor on a spherical joint nutates and precesses.

Data of the benchmark of Brüls, Cardona, Arnold, Terze and others: 15 kg, an initially horizontal
axis, 150 rad/s about it and 4.6 rad/s about the vertical. The spin is too slow for a steady
precession: the axis swings down until the top nearly hangs, and up again, while it precesses.
"""

import sys

import style

import dalembert as da
from dalembert import spatial


def build() -> da.System:
    system = da.System("heavy top", gravity=(0.0, 0.0, -9.81))
    m = system.parameter("m", 15.0, "kg")
    l = system.parameter("l", 1.0, "m", bounds=(0.5, 1.5))
    spin = system.parameter("spin", 150.0, "rad/s")
    swing = system.parameter("swing", -4.61538, "rad/s")
    rotor = spatial.Body(
        "rotor",
        mass=m,
        inertia=(0.234375, 0.46875, 0.234375),
        center_of_mass=(0, l, 0),
        position=(0, 0, 0),
        rotation=da.rotation.identity(),
        angular_velocity=(0, spin, swing),
        points={"C": (0, l, 0)},
    )
    system.add(rotor)
    system.add(spatial.Spherical("O", system.ground.point(0, 0, 0), rotor))
    return system


def main(folder=None) -> dict[str, float]:
    motion = da.solve_dynamics(
        build().build(), 1.0, integrator=da.DormandPrince853(1e-10, 1e-10), outputs=501
    )
    height = da.final("rotor.C.z", name="height of the mass centre at 1 s [m]")
    numbers = {
        height.label: da.evaluate(motion, height),
        "lowest height [m]": float(motion["rotor.C.z"].min()),
        "energy drift [J]": float(abs(motion["energy"] - motion["energy"][0]).max()),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, left, right = style.beside()
        style.space(left, motion, trace="rotor.C")
        left.set_title("path of the mass centre")
        for axis in "xyz":
            right.plot(motion.time, motion[f"rotor.C.{axis}"], label=axis)
        right.set(xlabel="time [s]", ylabel="mass centre [m]", title="it nods and precesses")
        right.legend(ncols=3)
        style.save(figure, folder, "heavy_top")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
