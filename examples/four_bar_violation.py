"""Constraint violation of the four-bar and its correction: section 5.4.3 and example 5.2.

RK-Gill with the coarse step 0.05 s over 8 s, in the angles of the chain opened at one pivot:
(a) no correction, (b) Baumgarte with alpha = 10, beta = 25, (c) projection, (d) projection and
correction of the energy; the reference takes steps of 0.0005 s.

The book states neither the direction of gravity nor the assembly configuration, nor the sign of the
crank's 1 rad/s. Here the fixed pivots are one above the other, with the crank perpendicular to
their line (alpha_1 = pi/2): then all four cases stay finite and (d) stays within the 1.5 degrees
that the book reports. With pivots at the same height the crank starts at the top of its path,
passes it very slowly in every turn, and (a) diverges.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

CASES = {
    "(a) no correction": da.Stabilization(),
    "(b) Baumgarte": da.Baumgarte(10.0, 25.0),
    "(c) projection": da.Projection(),
    "(d) with energy": da.EnergyProjection(),
}
ANGLES = da.JointCoordinates(cut=("O2",), angles="absolute")


def build() -> da.System:
    system = da.System("four-bar violation", gravity=(0.0, -9.81))
    l1, l2, l3 = (system.parameter(n, v, "m") for n, v in (("l1", 0.3), ("l2", 1.0), ("l3", 0.6)))
    m2 = system.parameter("m2", 5.0, "kg")
    omega = system.parameter("omega", 1.0, "rad/s")
    crank = system.add(
        planar.Bar("crank", length=l1, mass=1.5, angle=math.pi, angular_velocity=omega)
    )
    coupler = system.add(planar.Bar("coupler", length=l2, mass=m2, angle=0.69))
    rocker = system.add(planar.Bar("rocker", length=l3, mass=3.0, angle=2.48))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.start))
    system.add(planar.Revolute("O2", system.ground.point(0, 1), rocker.end))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    times = np.linspace(0, 8, 161)
    common = {"coordinates": ANGLES, "integrator": da.RKGill()}
    exact = da.solve_dynamics(model, 8.0, step=0.0005, outputs=times, **common)
    runs = {
        name: da.solve_dynamics(model, 8.0, step=0.05, stabilization=case, **common)
        for name, case in CASES.items()
    }
    off = {
        name: np.degrees(run["crank.angle"].values - exact["crank.angle"].values)
        for name, run in runs.items()
    }
    numbers = {"reference angle": float(exact["crank.angle"][-1])}
    for name, run in runs.items():
        key = name[1]
        numbers[f"violation {key}"] = float(run["position_violation"].max())
        numbers[f"energy {key}"] = float(abs(run["balance_error"]).max())
        numbers[f"angle {key}"] = float(abs(off[name]).max())
        print(
            f"{name:18} largest violation {numbers[f'violation {key}']:.1e} m, "
            f"energy error {numbers[f'energy {key}']:.3f} J, "
            f"crank off by {numbers[f'angle {key}']:.2f} deg"
        )
    if folder:
        draw(runs, off, folder)
    return numbers


def draw(runs, off, folder) -> None:
    figure, axes = plt.subplots(3, 4, figsize=(11, 6.4), sharex=True, sharey="row")
    for column, (name, run) in zip(axes.T, runs.items(), strict=True):
        column[0].semilogy(run.time, run["position_violation"] + 1e-17, label="position [m]")
        column[0].semilogy(run.time, run["velocity_violation"] + 1e-17, label="velocity [m/s]")
        column[0].set(title=name, ylim=(1e-17, 10))
        column[1].semilogy(run.time, abs(run["balance_error"]) + 1e-17, color=style.GREEN)
        column[2].plot(run.time, off[name], color=style.PINK)
        column[2].set_yscale("symlog", linthresh=1)
        column[2].set(xlabel="time [s]")
    axes[0, 0].legend(loc="lower right")
    for ax, label in zip(
        axes[:, 0], ("violation", "energy error [J]", "crank angle error [deg]"), strict=True
    ):
        ax.set_ylabel(label)
    style.save(figure, folder, "four_bar_violation")


if __name__ == "__main__":
    main(*sys.argv[1:])
