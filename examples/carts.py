"""Three carts on rolling wheels (Nikravesh): driven, started smoothly, pushed by a motor.

A and B prescribe the angle of the front wheel against the chassis; C has a motor torque
20 N m (1 - |speed|/(4 pi)) with its reaction on the chassis.
"""

import math
import sys

import matplotlib.pyplot as plt
import style

import dalembert as da
from dalembert import planar


def cart(name: str) -> tuple[da.System, planar.Body, planar.Body]:
    """The cart without its drive, its chassis and its front wheel."""
    system = da.System(name, gravity=(0.0, -9.81))
    radius = system.parameter("radius", 0.1, "m")
    mass = system.parameter("mass", 20.0, "kg")
    chassis = system.add(
        planar.Body(
            "chassis",
            mass=mass,
            inertia=5.0,
            position=(0.5, 0.2),
            angle=0.0,
            points={
                "rear": (-0.3, -0.1),
                "front": (0.3, -0.1),
                "top_rear": (-0.3, 0.1),
                "top_front": (0.3, 0.1),
            },
        )
    )
    for k, (x, place) in enumerate(((0.2, "rear"), (0.8, "front")), 1):
        wheel = system.add(
            planar.Body(
                f"wheel{k}",
                mass=2.0,
                inertia=0.5,
                position=(x, radius),
                angle=0.0,
                points={"mark": (0, 0.07)},
            )
        )
        system.add(planar.Revolute(f"{place}_axle", chassis.point(place), wheel.center))
        system.add(
            planar.RollingDisc(f"road{k}", system.ground.center, wheel.center, radius=radius)
        )
    return system, chassis, wheel


def cart_a() -> da.System:
    system, chassis, wheel = cart("cart A")
    speed = system.parameter("speed", 2 * math.pi, "rad/s")
    system.add(planar.RotationalDriver("motor", chassis, wheel, -speed * da.t))
    return system


def cart_b() -> da.System:
    """The speed follows 10 s^3 - 15 s^4 + 6 s^5 of s = t/T, the angle its integral."""
    system, chassis, wheel = cart("cart B")
    speed = system.parameter("speed", 2 * math.pi, "rad/s")
    T = system.parameter("T", 2.0, "s")
    s = da.t / T
    start = -speed * T * (2.5 * s**4 - 3 * s**5 + s**6)
    system.add(
        planar.RotationalDriver(
            "motor", chassis, wheel, da.where(da.t < T, start, -speed * (da.t - T / 2))
        )
    )
    return system


def cart_c() -> da.System:
    system, chassis, wheel = cart("cart C")
    torque = system.parameter("torque", 20.0, "N m")
    idle = system.parameter("idle", 4 * math.pi, "rad/s")
    system.initial(chassis.velocity[0], system.parameter("v0", 0.0, "m/s"))
    turning = wheel.angular_velocity - chassis.angular_velocity  # clockwise, so negative
    system.add(planar.Torque("motor", wheel, -torque * (1 + turning / idle), reaction_on=chassis))
    return system


def main(folder=None) -> dict[str, float]:
    motions = {
        "A": da.solve_inverse_dynamics(cart_a().build(), 10.0, outputs=201),
        "B": da.solve_inverse_dynamics(cart_b().build(), 10.0, outputs=401),
        "C": da.solve_dynamics(cart_c().build(), 10.0, step=0.01),
    }
    numbers = {}
    for name, motion in motions.items():
        for time in (1, 2, 10):
            numbers[f"{name} x({time})"] = da.evaluate(motion, da.at(time, "chassis.x"))
            numbers[f"{name} v({time})"] = da.evaluate(motion, da.at(time, "chassis.vx"))
        print(
            f"cart {name}: "
            + ", ".join(
                f"x({time} s) = {numbers[f'{name} x({time})']:.12f} m" for time in (1, 2, 10)
            )
        )
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.1), width_ratios=(1.3, 1))
        left.plot(
            motions["C"]["wheel2.mark.x"][:160],
            motions["C"]["wheel2.mark.y"][:160],
            color=style.PINK,
            lw=1,
        )
        style.draw(left, motions["C"], 1.6)
        left.set_aspect("equal", adjustable="box")
        left.set(
            title="cart C after 1.6 s, path of a mark on the wheel",
            xlabel="x [m]",
            ylabel="y [m]",
            xlim=(0.6, 2.3),
            ylim=(-0.1, 0.55),
        )
        for name, motion in motions.items():
            right.plot(motion.time, motion["chassis.vx"], label=f"cart {name}")
        right.set(title="speed [m/s]", xlabel="time [s]", ylim=(0, 1.4))
        right.legend(loc="lower right")
        style.save(figure, folder, "carts")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
