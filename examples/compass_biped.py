"""A compass biped walks down a slope: rigid foot strikes, and the minimum slope for its speed.

Two legs with point masses and a mass at the hip walk without a motor (Goswami, Thuilot and Espiau
1996). A foot strikes without rebound, and the same impact lifts the other foot. Straight legs scuff
the ground as they pass; therefore each foot has stepping stones of its own, with pits in between.
The optimisation moves the masses of the legs, and with them the periodic gait, by exact gradients
through the impacts: the slope at equal speed falls from 3° to 1.3°.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

SPEED, HALF, STANCE, SWING = 0.729, 0.27102868, 1.09238359, 0.37737395
"""Speed of the gait [m/s]; at its start, half angle between the legs [rad], their rates [rad/s]."""
STATE, VARIABLES = ("half", "stance", "swing"), ("slope", "low", "half", "stance", "swing", "step")
GAIT = da.Dynamics(
    duration=3.0,
    integrator=da.DormandPrince(rtol=1e-9, atol=1e-11),
    events={"passing": "right.angle - left.angle"},
)
"""The next foot strike is between two passings of the legs."""


def build() -> da.System:
    system = da.System("compass biped", gravity=(0.0, -9.81))
    slope = system.parameter("slope", math.radians(3), "rad", (math.radians(1), math.radians(5)))
    leg = system.parameter("leg", 1.0, "m")
    low = system.parameter("low", 0.5, "m", (0.3, 0.7))
    mass = system.parameter("mass", 5.0, "kg")
    hip_mass = system.parameter("hip_mass", 10.0, "kg", (1.0, 40.0))
    half = system.parameter("half", HALF, "rad", (0.1, 0.4))
    stance = system.parameter("stance", STANCE, "rad/s", (0.3, 2.0))
    swing = system.parameter("swing", SWING, "rad/s", (-1.0, 2.0))
    step = system.parameter("step", 0.5354454, "m", (0.2, 0.8))
    pit = system.parameter("pit", 0.02, "m")
    friction = system.parameter("friction", 0.8)
    ahead, behind = slope - half, slope + half
    high = leg - low
    x, y = leg * da.sin(ahead), leg * da.cos(ahead)
    places = {
        "left": (low * da.sin(ahead), low * da.cos(ahead)),
        "right": (x - high * da.sin(behind), y - high * da.cos(behind)),
    }
    hip = system.add(planar.Particle("hip", mass=hip_mass, position=(x, y)))
    for name, lean, rate, first in (("left", ahead, stance, 1), ("right", behind, swing, 0)):
        points = {"foot": (0.0, -low), "hip": (0.0, high)}
        body = planar.Body(
            name, mass=mass, inertia=0.0, position=places[name], angle=-lean, points=points
        )
        system.add(body)
        system.add(planar.Revolute(f"{name}_hip", hip.center, body.point("hip")))
        foot = body.point("foot")
        c, s = da.cos(slope), da.sin(slope)
        along, above = foot.x * c - foot.y * s, foot.x * s + foot.y * c
        between = da.cos(math.pi * ((along + 0.1) / step - first))
        vx, vy = foot.velocity
        gap = above + pit * da.where(between > 0, between, 0.0) ** 2
        law = {"restitution": 0.0, "friction": friction}
        system.add(planar.UnilateralConstraint(f"{name}_foot", gap, vx * c - vy * s, **law))
        system.initial(body.angle, -lean)
        system.initial(body.angular_velocity, -rate)
        if first:
            for start in (foot.x, foot.y, vx, vy):
                system.initial(start, 0.0)
    return system


def section() -> list[tuple]:
    """Responses at two successive passings: angle, rates of the legs on the ground and in the air,
    way and time; the legs change their roles in between."""
    pairs = (
        ("left.angle", "right.angle"),
        ("left.angular_velocity", "right.angular_velocity"),
        ("right.angular_velocity", "left.angular_velocity"),
        ("hip.x/cos(slope)", "hip.x/cos(slope)"),
        ("t", "t"),
    )
    return [
        (da.at_event("passing", first), da.at_event("passing", second, 2))
        for first, second in pairs
    ]


def multipliers(motion) -> np.ndarray:
    """Eigenvalues of the derivative of a step, the return map of the section."""
    first, second = (
        da.sensitivity(motion, list(states[:3]), wrt=list(STATE)).values
        for states in zip(*section(), strict=True)
    )
    return np.linalg.eigvals(second @ np.linalg.inv(first))


def main(folder=None) -> dict[str, float]:
    model = build().build()
    gait = GAIT.run(model)
    changes = [second - first for first, second in section()]
    way, time = changes[3:]
    periodic = [*changes[:3], way - SPEED * time, way - da.final("step")]
    best = da.optimize(
        model,
        da.final("slope"),
        vary=VARIABLES,
        subject_to=[da.Limit(each, lower=0.0, upper=0.0) for each in periodic],
        analysis=GAIT,
    )
    strikes = [impact.time for impact in gait.impacts]
    numbers = {
        "period [s]": strikes[1] - strikes[0],
        "step [m]": da.evaluate(gait, way),
        "largest multiplier": float(np.abs(multipliers(gait)).max()),
        "optimised slope [deg]": math.degrees(best.x["slope"]),
        "optimised height of the masses [m]": best.x["low"],
        "optimised step [m]": best.x["step"],
        "strikes of the optimised gait": len(best.motion.impacts),
        "violation": best.violation,
    }
    print(best.message, *(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, axes = plt.subplot_mosaic("AC;BC", figsize=(9.5, 5), width_ratios=(1.7, 1))
        falls = f"optimised, slope {numbers['optimised slope [deg]']:.2f}°"
        for place, run, title in (("A", gait, "published, slope 3°"), ("B", best.motion, falls)):
            walk(axes[place], run)
            axes[place].set(title=f"{title}, {SPEED} m/s", xlabel="x [m]", ylabel="y [m]")
            fine = run.at(np.linspace(0, GAIT.duration, 1201))
            angle, rate = fine["left.angle"].values, fine["left.angular_velocity"].values
            rate = np.where(np.abs(np.gradient(rate)) > 0.15, np.nan, rate)  # jumps at strikes
            axes["C"].plot(angle, rate, label=title.split(",")[0])
        axes["C"].set(
            title="limit cycle of the left leg", xlabel="angle [rad]", ylabel="rate [rad/s]"
        )
        axes["C"].legend()
        style.save(figure, folder, "compass_biped")
    return numbers


def walk(ax, motion) -> None:
    """The legs at equal intervals, and the slope."""
    names = {"left": style.BLUE, "right": style.ORANGE}
    hip = motion["hip.position"].values
    feet = {name: motion[f"{name}.foot.position"].values for name in names}
    for time in np.arange(0, motion.time[-1], 0.12):
        k = int(np.argmin(abs(motion.time - time)))
        for name, colour in names.items():
            ax.plot(*np.array([hip[k], feet[name][k]]).T, color=colour, lw=1.2, alpha=0.8)
    ax.plot(*hip.T, color=style.GREY, lw=1)
    ends = np.array([-0.6, hip[-1, 0] + 0.3])
    ax.plot(ends, -math.tan(motion["slope"].values[0]) * ends, color="0.2", lw=1.5)
    ax.set_aspect("equal")


if __name__ == "__main__":
    main(*sys.argv[1:])
