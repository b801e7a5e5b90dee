"""A disc rolls without slip: the steady circle of an inclined coin, and an unsteady motion.

With the inclination θ of the axle from the vertical, the rate Ω of the heading and the angular
velocity ω about the axle, (Ia + m r²) ω Ω sin θ = (It Ω² sin θ − m g r) cos θ is steady: the centre
runs in a circle of radius r ω / Ω. From other initial speeds the inclination oscillates. Energy is
conserved, because the two nonholonomic equations do no work. The disc has five free coordinates,
but three free speeds.
"""

import sys

import numpy as np
import style

import dalembert as da
from dalembert import spatial

G, ACCURATE = 9.81, da.DormandPrince853(1e-10, 1e-10)


def build(roll_off: float = 1.0) -> da.System:
    """At ``roll_off`` times the angular velocity of the steady circle about the axle."""
    system = da.System("rolling disc", gravity=(0.0, 0.0, -G))
    m = system.parameter("m", 2.0, "kg")
    r = system.parameter("r", 0.3, "m", bounds=(0.1, 0.5))
    tilt = system.parameter("tilt", 1.2, "rad")
    turn = system.parameter("turn", 1.5, "rad/s")
    up, level = da.sin(tilt), da.cos(tilt)
    roll = system.derived(
        "roll", roll_off * (turn**2 * up * r / 4 - G) * level / (1.5 * r * turn * up), "rad/s"
    )
    disc = spatial.Body(
        "disc",
        mass=m,
        inertia=(m * r**2 / 4, m * r**2 / 4, m * r**2 / 2),
        position=(0, -r * level, r * up),
        rotation=da.rotation.axis_angle((1, 0, 0), tilt),
        velocity=(-r * roll, 0, 0),
        angular_velocity=(0, -roll * up + turn * up * level, roll * level + turn * up**2),
        points={"rim": (r, 0, 0)},
    )
    system.add(disc)
    road = system.ground.frame()
    system.add(spatial.RollingDisc("rolling", disc, road, radius=r, axis=(0, 0, 1)))
    return system


def main(folder=None) -> dict[str, float]:
    steady, reeling = (
        da.solve_dynamics(build(off).build(), 6.0, integrator=ACCURATE, outputs=1201)
        for off in (1.0, 0.5)
    )
    numbers = {
        "diameter of the circle [m]": float(np.ptp(steady["disc.y"].values)),
        "height varies by [m], steady": float(np.ptp(steady["disc.z"].values)),
        "height varies by [m], reeling": float(np.ptp(reeling["disc.z"].values)),
        "energy drift [J], reeling": float(abs(reeling["balance_error"]).max()),
        "slip [m/s], reeling": float(reeling["velocity_violation"].max()),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, left, right = style.beside()
        for motion, colour, label in (
            (steady, style.BLUE, "steady"),
            (reeling, style.ORANGE, "half as fast about the axle"),
        ):
            path = [motion[f"disc.{axis}"] for axis in "xyz"]
            left.plot(*path, color=colour, label=label)
            right.plot(motion.time, motion["rolling.force.z"], color=colour, label=label)
        steady.draw(0.0, left)
        left.set(xlim=(-1.3, 1.3), ylim=(-0.3, 2.3), zlim=(0, 0.6), title="paths of the centre")
        left.set_aspect("equal")
        right.set(xlabel="time [s]", ylabel="force [N]", title="contact force across the plane")
        right.legend()
        style.save(figure, folder, "rolling_disc")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
