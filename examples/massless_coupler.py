"""A four-bar with a massless coupler, which only transmits a force from pin to pin.

Without mass the coupler is a two-force member, so the forces at its ends are opposite and along
it. With a small mass the motion differs from this limit in proportion to the mass.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

MASSES = (1e-1, 1e-2, 1e-3, 1e-4)
DURATION = 2.0


def build(mass: float) -> da.System:
    system = da.System("massless coupler", gravity=(0.0, -9.81))
    crank = system.add(planar.Bar("crank", length=0.3, mass=1.5, angle=1.2, angular_velocity=2.0))
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=mass, angle=0.3))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=3.0, angle=1.4))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("C", system.ground.point(1, 0), rocker.start))
    return system


def run(mass: float, formulation) -> da.Motion:
    return da.solve_dynamics(build(mass).build(), DURATION, step=0.002, formulation=formulation)


def across(motion: da.Motion) -> np.ndarray:
    """Force of the coupler at B across its own direction [N]."""
    x, y = motion["B.force"].values.T
    angle = motion["coupler.angle"].values
    return y * np.cos(angle) - x * np.sin(angle)


def main(folder=None) -> dict[str, float]:
    limit = run(0.0, da.AugmentedLagrangian())
    others = {mass: run(mass, da.AugmentedLagrangian()) for mass in MASSES}
    distance = [abs(m.trajectory.y - limit.trajectory.y).max() for m in others.values()]
    plain = run(0.0, da.RangeSpace())
    numbers = {
        "difference to RangeSpace [m, rad]": float(
            abs(plain.trajectory.y - limit.trajectory.y).max()
        ),
        "power of the mass in the distance to the limit": float(
            np.polyfit(np.log(MASSES[1:]), np.log(distance[1:]), 1)[0]
        ),
        "force across the coupler, no mass [N]": float(abs(across(limit)).max()),
        "force across the coupler, 0.1 kg [N]": float(abs(across(others[0.1])).max()),
        "largest error of the energy [J]": float(abs(limit.data.balance_error).max()),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, axes = plt.subplots(1, 3, figsize=(10, 3.2))
        style.draw(axes[0], limit, 0.0)
        axes[0].set(xlabel="x [m]", ylabel="y [m]", title="the coupler hands on a force")
        for mass in MASSES[:2]:
            axes[1].plot(limit.time, across(others[mass]), label=f"{mass:g} kg")
        axes[1].plot(limit.time, across(limit), label="no mass", color="0.3")
        axes[1].set(xlabel="time [s]", title="force across the coupler [N]")
        axes[1].legend()
        axes[2].loglog(MASSES, distance, "o-")
        axes[2].set(xlabel="mass of the coupler [kg]", title="distance to the limit [m, rad]")
        style.save(figure, folder, "massless_coupler")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
