"""Crank shaper: a pin sliding in a slotted lever produces a slow cutting stroke and a quick return.

The crank circle subtends the angle 2 asin(r/d) at the pivot of the lever. The ram reverses where
the crank is normal to the lever. Therefore the time ratio is (pi + 2 asin(r/d))/(pi - 2 asin(r/d))
and the stroke 2 L r/d.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style
from scipy.optimize import brentq

import dalembert as da
from dalembert import planar

HEIGHT = 0.235


def build() -> da.System:
    system = da.System("quick-return shaper", gravity=(0.0, -9.81))
    r = system.parameter("r", 0.1, "m", bounds=(0.06, 0.14))
    d = system.parameter("d", 0.3, "m", bounds=(0.25, 0.4))
    lever_length = system.parameter("lever_length", 0.55, "m", bounds=(0.5, 0.6))
    link_length = system.parameter("link_length", 0.2, "m", bounds=(0.15, 0.3))
    m_ram = system.parameter("m_ram", 40.0, "kg")
    speed = system.parameter("speed", 6.0, "rad/s")
    cut = system.parameter("cut", 2000.0, "N")

    crank = system.add(planar.Bar("crank", length=r, mass=4.0, angle=0.0))
    lever = system.add(planar.Bar("lever", length=lever_length, mass=12.0, angle=1.25))
    link = system.add(planar.Bar("link", length=link_length, mass=3.0, angle=0.0))
    ram = system.add(
        planar.Body(
            "ram",
            mass=m_ram,
            inertia=1.0,
            position=(0.37, HEIGHT),
            points={
                "tool": (0.3, -0.1),
                "nose": (0.3, 0.04),
                "tail": (-0.15, 0.04),
                "heel": (-0.15, -0.04),
            },
        )
    )
    system.add(planar.Revolute("shaft", system.ground.center, crank.start))
    system.add(planar.Revolute("pivot", system.ground.point(0, -d), lever.start))
    system.add(planar.PinInSlot("slot", lever.start, crank.end))
    system.add(planar.Revolute("A", lever.end, link.start))
    system.add(planar.Revolute("B", link.end, ram.center))
    system.add(planar.Prismatic("guide", system.ground.point(0, HEIGHT), ram.center))
    system.add(planar.RotationalDriver("motor", system.ground, crank, speed * da.t))
    cutting = (1 - da.tanh(ram.velocity[0] / 0.02)) / 2  # while the ram moves to the left
    system.add(planar.Force("chip", ram.point("tool"), (cut * cutting, 0.0)))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    period = 2 * math.pi / 6.0
    motion = da.solve_inverse_dynamics(model, period, outputs=721)

    def speed(time: float) -> float:
        return float(motion.at([time])["ram.vx"][0])

    signs = np.flatnonzero(np.diff(np.sign(motion["ram.vx"].values)))
    left_end, right_end = (
        brentq(speed, motion.time[k], motion.time[k + 1], xtol=1e-15) for k in signs
    )
    returning = right_end - left_end
    stroke = float(motion.at([right_end])["ram.x"][0] - motion.at([left_end])["ram.x"][0])
    numbers = {"time_ratio": (period - returning) / returning, "stroke": stroke}
    print(
        f"time ratio {numbers['time_ratio']:.9f}, stroke {stroke:.9f} m, "
        f"torque up to {float(motion['motor.effort'].max()):.0f} N m"
    )
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4), width_ratios=(1.25, 1))
        for time, alpha in ((left_end, 0.25), (right_end, 0.25), (0.2, 1.0)):
            style.draw(left, motion, time, alpha)
        left.set(title="mechanism, and the ends of the stroke", xlabel="x [m]", ylabel="y [m]")
        right.plot(motion.time, motion["ram.vx"])
        right.axvspan(left_end, right_end, color=style.ORANGE, alpha=0.12, lw=0)
        for time, text in ((left_end / 2, "cut"), ((left_end + right_end) / 2, "return")):
            right.text(
                time,
                0.95,
                text,
                transform=right.get_xaxis_transform(),
                ha="center",
                color=style.ORANGE,
            )
        right.set(
            title="speed of the ram [m/s]", xlabel="time [s]", xlim=(0, period), ylim=(-1.1, 2)
        )
        style.save(figure, folder, "quick_return_shaper")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
