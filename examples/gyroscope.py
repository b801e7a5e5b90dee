"""A gyroscope in gimbals: a weight on the inner ring causes precession.

With a horizontal axis and the initial precession Ω = m g l / (J ω), the axis stays horizontal and
precesses steadily at Ω, for any inertia of the rings. Released at rest, it also nutates: the axis
drops until the precession carries the weight. The mean precession is Ω if the rotor is fast.
"""

import sys

import numpy as np
import style

import dalembert as da
from dalembert import spatial

G, WEIGHT, ARM, SPIN, AXIAL = 9.81, 0.2, 0.1, 400.0, 4e-3
RATE = WEIGHT * G * ARM / (AXIAL * SPIN)
ALONG, ASIDE, UP = (1, 0, 0), (0, 1, 0), (0, 0, 1)


def build() -> da.System:
    """The rotor spins about x of the inner ring, which nods about y of the outer one."""
    system = da.System("gyroscope", gravity=(0.0, 0.0, -G))
    weight = system.parameter("weight", WEIGHT, "kg")
    spin = system.parameter("spin", SPIN, "rad/s")
    precession = system.parameter("precession", RATE, "rad/s")

    def body(name, mass, inertia, turning, **more):
        made = spatial.Body(
            name,
            mass=mass,
            inertia=inertia,
            position=(0, 0, 0),
            rotation=da.rotation.identity(),
            angular_velocity=turning,
            **more,
        )
        return system.add(made)

    going_round = (0, 0, precession)
    outer = body("outer", 0.5, (6e-4, 6e-4, 1e-3), going_round)
    inner = body("inner", 0.3, (5e-4, 4e-4, 4e-4), going_round, points={"tip": (ARM, 0, 0)})
    rotor = body("rotor", 2.0, (AXIAL, 2.5e-3, 2.5e-3), (spin, 0, precession))
    system.add(spatial.Revolute("stand", system.ground.frame(axis=UP), outer.frame(axis=UP)))
    system.add(spatial.Revolute("nod", outer.frame(axis=ASIDE), inner.frame(axis=ASIDE)))
    system.add(spatial.Revolute("axle", inner.frame(axis=ALONG), rotor.frame(axis=ALONG)))
    system.add(spatial.Force("hung", inner.points["tip"], (0, 0, -weight * G)))
    return system


def main(folder=None) -> dict[str, float]:
    model, accurate = build().build(), da.DormandPrince853(1e-10, 1e-10)
    steady, nodding = (
        da.solve_dynamics(
            model, 4.0, integrator=accurate, outputs=2001, parameters={"precession": rate}
        )
        for rate in (RATE, 0.0)
    )
    heading, falling = (
        np.unwrap(np.arctan2(m["inner.tip.y"].values, m["inner.tip.x"].values))
        for m in (steady, nodding)
    )
    numbers = {
        "precession, steady [rad/s]": heading[-1] / 4,
        "axis leaves the level by [m], steady": float(abs(steady["inner.tip.z"]).max()),
        "precession, let go at rest [rad/s]": falling[-1] / 4,
        "axis drops by [m], let go at rest": -float(nodding["inner.tip.z"].min()),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, left, right = style.beside()
        few = slice(0, 301)
        left.plot(*(nodding[f"inner.tip.{axis}"][few] for axis in "xyz"), color=style.ORANGE)
        left.plot(*(steady[f"inner.tip.{axis}"][few] for axis in "xyz"), color=style.BLUE)
        left.set_title("path of the weight, 0.6 s")
        for motion, colour, label in (
            (steady, style.BLUE, "started at Ω"),
            (nodding, style.ORANGE, "let go at rest"),
        ):
            right.plot(
                motion.time[few], 1e3 * motion["inner.tip.z"][few], color=colour, label=label
            )
        right.set(xlabel="time [s]", ylabel="height of the weight [mm]", title="nutation")
        right.legend()
        style.save(figure, folder, "gyroscope")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
