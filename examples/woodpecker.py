"""The woodpecker toy: a bird pecks its way down a pole, with impacts, sticking and free flight.

A bird is connected by a spring to a sleeve with clearance on the pole (Pfeiffer and Glocker 1996).
The sleeve alternately jams, slides and falls, the beak hits the pole once a cycle, and the work of
gravity is dissipated in the impacts. The gradient of the distance travelled includes all impacts.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

DURATION = 0.5
"""Length of the run [s]."""
PIVOT, HANG, BEAK_AT = 0.01, 0.015, 0.0201
"""Arms: sleeve to spring, spring to bird, bird to beak [m]."""
BEAK, EDGE, INNER, POLE = 0.02, 0.0058, 0.0031, 0.0025
"""Beak and edge of the sleeve from their axes, radii of sleeve and pole [m]."""
TILT, ANGLE, SPEED, RATE = -(INNER - POLE) / EDGE, -0.2788, -0.3411, -7.4583
"""Start: angles of sleeve and bird, speed down, rate of the bird."""


def build() -> da.System:
    system = da.System("woodpecker", gravity=(0.0, -9.81))
    friction = system.parameter("friction", 0.3)
    bounce = system.parameter("bounce", 0.5)
    stiffness = system.parameter("stiffness", 0.0056, "N m/rad")
    sleeve = planar.Body(
        "sleeve", mass=3e-4, inertia=5e-9, position=(0, 0), angle=TILT, velocity=(0, SPEED)
    )
    bird = planar.Body(
        "bird",
        mass=4.5e-3,
        inertia=7e-7,
        position=(0, PIVOT * TILT + HANG * ANGLE),
        angle=ANGLE,
        velocity=(0, SPEED + HANG * RATE),
        angular_velocity=RATE,
    )
    system.add(sleeve)
    system.add(bird)
    system.add(planar.UserConstraint("pole", sleeve.x))
    system.add(planar.UserConstraint("plane", bird.x))
    arm = sleeve.y + PIVOT * sleeve.angle + HANG * bird.angle
    system.add(planar.UserConstraint("arm", bird.y - arm))
    system.add(planar.TorsionSpring("spring", sleeve, bird, stiffness=stiffness))
    play, tip = INNER - POLE, PIVOT + HANG - BEAK_AT - POLE
    edge = sleeve.vy + INNER * sleeve.angular_velocity
    beak = sleeve.vy + PIVOT * sleeve.angular_velocity + (HANG - BEAK_AT) * bird.angular_velocity
    for name, gap, slip, e in (
        ("beak", tip - BEAK * bird.angle, beak, bounce),
        ("lower", play + EDGE * sleeve.angle, edge, 0.0),
        ("upper", play - EDGE * sleeve.angle, edge, 0.0),
    ):
        law = {"restitution": e, "friction": friction}
        system.add(planar.UnilateralConstraint(name, gap, slip, **law))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    motion = da.solve_dynamics(model, DURATION, integrator=da.DormandPrince())
    pecks = np.array([impact.time for impact in motion.impacts if impact.name == "beak"])
    way = da.sensitivity(motion, da.final("sleeve.y"), method="adjoint").squeeze()
    early = motion.at(np.array([0.02]))
    numbers = {
        "angle of the bird after 0.02 s [rad]": early.values("bird.angle").item(),
        "pecks": float(pecks.size),
        "period [s]": float(np.mean(np.diff(pecks))),
        "way down [m]": float(-motion.values("sleeve.y")[-1]),
        "way down by friction [m]": float(-way.sel(parameter="friction")),
        "energy not accounted for [J]": float(np.abs(motion.data["balance_error"]).max()),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        fine = motion.at(np.linspace(0, DURATION, 4001))
        figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.4))
        left.plot(fine.time, 1e3 * fine.values("sleeve.y"))
        for time in pecks:
            left.axvline(time, color=style.GREY, lw=0.7, ls=":")
        left.set(xlabel="time [s]", ylabel="sleeve [mm]", title="way down, and when it pecks")
        angle, rate = fine.values("bird.angle"), fine.values("bird.angular_velocity")
        struck = np.abs(np.diff(rate)) > 1.0  # the rate jumps there
        rate = np.where(np.append(struck, False), np.nan, rate)
        right.plot(angle, rate, lw=1)
        right.set(xlabel="angle of the bird [rad]", ylabel="rate [rad/s]", title="limit cycle")
        style.save(figure, folder, "woodpecker")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
