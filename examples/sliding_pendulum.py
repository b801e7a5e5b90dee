"""Sliding pendulum, a textbook case of Nikravesh with a published solution at 10 s."""

import sys

import matplotlib.pyplot as plt
import style

import dalembert as da
from dalembert import planar

PUBLISHED = {"slider.x": 0.290985380740065, "pendulum.angle": -0.177394633452164}


def build() -> da.System:
    system = da.System("sliding pendulum", gravity=(0.0, -9.81))
    m1, m2 = system.parameter("m1", 5.0, "kg"), system.parameter("m2", 2.0, "kg")
    J2 = system.parameter("J2", 0.2, "kg m^2")
    arm = system.parameter("arm", 0.5, "m")
    k, free = system.parameter("k", 20.0, "N/m"), system.parameter("free", 0.6, "m")
    x0 = system.parameter("x0", 0.999999405396684, "m")
    phi0 = system.parameter("phi0", 0.523601521953373, "rad")

    wall = system.ground.point(0, 0.2)
    slider = system.add(
        planar.Body("slider", mass=m1, inertia=4.0, position=(x0, 0.2), angle=0.0, velocity=(0, 0))
    )
    pendulum = system.add(
        planar.Body(
            "pendulum",
            mass=m2,
            inertia=J2,
            angle=phi0,
            angular_velocity=0.0,
            points={"hinge": (0, arm)},
        )
    )
    system.add(planar.Prismatic("rail", wall, slider.center))
    system.add(planar.Revolute("hinge", slider.center, pendulum.point("hinge")))
    system.add(planar.Spring("spring", wall, slider.center, stiffness=k, free_length=free))
    return system


def main(folder=None) -> dict[str, float]:
    motion = da.solve_dynamics(
        build().build(), 10.0, integrator=da.DormandPrince(rtol=1e-11, atol=1e-12), outputs=1001
    )
    numbers = {
        name: float(motion[name][-1])
        for name in ("slider.x", "pendulum.angle", "slider.vx", "pendulum.angular_velocity")
    }
    for name, value in numbers.items():
        published = f", published {PUBLISHED[name]:.9f}" if name in PUBLISHED else ""
        print(f"{name} at 10 s: {value:.12f}{published}")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), width_ratios=(1, 1.6))
        style.draw(left, motion)
        left.set(title="start", xlabel="x [m]", ylabel="y [m]")
        right.plot(motion.time, motion["slider.x"], label="slider x [m]")
        right.plot(motion.time, motion["pendulum.angle"], label="pendulum angle [rad]")
        right.plot(
            [10, 10],
            list(PUBLISHED.values()),
            "o",
            mfc="none",
            color=style.GREY,
            label="published at 10 s",
        )
        right.set(xlabel="time [s]", title="motion")
        right.set_ylim(-0.6, 1.45)
        right.legend(ncols=3, loc="upper right", fontsize=8, columnspacing=1, handlelength=1.4)
        style.save(figure, folder, "sliding_pendulum")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
