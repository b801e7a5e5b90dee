"""Spring pendulum in two-to-one resonance: its modes, and the exchange of energy between them.

About the equilibrium the vertical frequency is sqrt(k/m) and the pendulum frequency sqrt(g/L). With
k = 3 m g / free the first is twice the second, and the energy moves between the two modes.
"""

import sys

import matplotlib.pyplot as plt
import style

import dalembert as da
from dalembert import planar


def build() -> da.System:
    system = da.System("spring pendulum", gravity=(0.0, -9.81))
    m = system.parameter("m", 1.0, "kg")
    k = system.parameter("k", 39.24, "N/m")
    free = system.parameter("free", 0.75, "m")
    x0 = system.parameter("x0", 0.03, "m")
    drop = system.parameter("drop", 0.15, "m")
    hang = system.derived("hang", free + 9.81 * m / k, "m")
    ball = system.add(planar.Particle("ball", mass=m, position=(x0, -hang - drop)))
    system.add(
        planar.Spring("spring", system.ground.center, ball.center, stiffness=k, free_length=free)
    )
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    modes = da.linearize(model)
    motion = da.solve_dynamics(model, 30.0, step=0.01)
    numbers = {
        "swing [Hz]": float(min(modes.frequencies)),
        "bounce [Hz]": float(max(modes.frequencies)),
        "energy error [J]": float(abs(motion["balance_error"]).max()),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), width_ratios=(1, 1.6))
        left.plot(motion["ball.x"], motion["ball.y"], lw=0.7, color=style.SKY)
        style.draw(left, motion, 5.0)
        left.set(title="path over 30 s", xlabel="x [m]", ylabel="y [m]")
        right.plot(motion.time, motion["ball.y"] + 1, label="bounce, y + 1 m", lw=1)
        right.plot(motion.time, motion["ball.x"], label="swing, x", lw=1)
        right.set(
            title="energy wanders between the two modes",
            xlabel="time [s]",
            ylabel="[m]",
            ylim=(-0.32, 0.42),
        )
        right.legend(loc="upper right", ncols=2)
        style.save(figure, folder, "spring_pendulum")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
