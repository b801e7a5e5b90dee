"""Slider-crank compressor at constant speed: motor torque and bearing forces (inverse dynamics)."""

import math
import sys

import matplotlib.pyplot as plt
import style

import dalembert as da
from dalembert import planar


def build() -> da.System:
    system = da.System("slider-crank", gravity=(0.0, -9.81))
    r = system.parameter("r", 0.05, "m", bounds=(0.03, 0.07))
    l = system.parameter("l", 0.18, "m", bounds=(0.12, 0.3))
    m_rod = system.parameter("m_rod", 0.6, "kg")
    m_piston = system.parameter("m_piston", 0.8, "kg")
    speed = system.parameter("speed", 20 * math.pi, "rad/s")
    gas = system.parameter("gas", 1500.0, "N")

    crank = system.add(planar.Bar("crank", length=r, mass=0.9, angle=0.0))
    rod = system.add(planar.Bar("rod", length=l, mass=m_rod, angle=0.0))
    piston = system.add(planar.Body("piston", mass=m_piston, inertia=1e-3, position=(r + l, 0.0)))
    system.add(planar.Revolute("O", system.ground.center, crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, piston.center))
    system.add(planar.Prismatic("guide", system.ground.center, piston.center))
    system.add(planar.RotationalDriver("motor", system.ground, crank, speed * da.t))

    outward = (
        1 + da.tanh(piston.velocity[0] / 0.2)
    ) / 2  # gas pushes back while the piston moves out
    system.add(planar.Force("gas_force", piston.center, (-gas * outward, 0.0)))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    motion = da.solve_inverse_dynamics(model, 0.1, outputs=401)
    numbers = {
        "torque_rms": da.evaluate(motion, da.rms("motor.effort")),
        "piston_speed": da.evaluate(motion, da.maximum("piston.vx")),
        "bearing": float(motion["O.force_norm"].max()),
    }
    print(
        f"motor torque {numbers['torque_rms']:.2f} N m rms, "
        f"piston up to {numbers['piston_speed']:.3f} m/s, "
        f"main bearing up to {numbers['bearing']:.0f} N"
    )
    if folder:
        figure, (left, middle, right) = plt.subplots(1, 3, figsize=(11, 3.2))
        style.draw(left, motion, 0.012)
        left.set(title="mechanism", xlabel="x [m]", ylabel="y [m]")
        angle = 360 * motion.time / motion.time[-1]
        middle.plot(angle, motion["motor.effort"])
        middle.set(title="motor torque [N m]")
        right.plot(angle, motion["O.force_norm"], label="main bearing O")
        right.plot(angle, motion["B.force_norm"], label="piston pin B")
        right.set(title="bearing forces [N]")
        right.legend()
        for ax in (middle, right):
            ax.set(xlabel="crank angle [deg]", xticks=range(0, 361, 90))
        style.save(figure, folder, "slider_crank")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
