"""A coupler on three parallel cranks: the third crank is redundant, but carries a share of load.

``RangeSpace`` removes one redundant equation, so the load of each crank depends on the choice of
this equation. ``AugmentedLagrangian`` retains all equations and computes the smallest possible
multipliers; three equal cranks then carry equal loads. The motion is the same.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar

LENGTH, CRANK, COUPLER, G, START, SPEED = 0.6, 1.0, 3.0, 9.81, 2.0, -1.0
PLACES = {"left": 0.0, "middle": 1.0, "right": 2.0}


def build() -> da.System:
    system = da.System("double parallelogram", gravity=(0.0, -G))
    coupler = system.add(planar.Bar("coupler", length=2.0, mass=COUPLER, angle=0.0))
    for name, x in PLACES.items():
        place = (x + LENGTH / 2 * np.cos(START), LENGTH / 2 * np.sin(START))
        bar = planar.Bar(
            name, length=LENGTH, mass=CRANK, position=place, angle=START, angular_velocity=SPEED
        )
        system.add(bar)
        system.add(planar.Revolute(f"{name}_foot", system.ground.point(x, 0), bar.start))
        system.add(planar.Revolute(f"{name}_pin", bar.end, coupler.point(x - 1.0, 0)))
    return system


def exact(times) -> np.ndarray:
    """Angle of the cranks, whose end carries the coupler along a circle."""
    inertia = (3 * CRANK / 3 + COUPLER) * LENGTH**2
    weight = (3 * CRANK / 2 + COUPLER) * LENGTH * G
    flow = solve_ivp(
        lambda t, s: [s[1], -weight / inertia * np.cos(s[0])],
        (0, times[-1]),
        [START, SPEED],
        "DOP853",
        times,
        rtol=1e-13,
        atol=1e-13,
    )
    return flow.y[0]


def main(folder=None) -> dict[str, float]:
    model = build().build()
    choices = {"all equations": da.AugmentedLagrangian(), "independent": da.RangeSpace()}
    runs = {
        name: da.solve_dynamics(model, 1.0, step=0.002, formulation=formulation)
        for name, formulation in choices.items()
    }
    full, other = runs.values()
    share = {
        name: np.array([run[f"{crank}_pin.force_norm"].values for crank in PLACES])
        for name, run in runs.items()
    }
    numbers = {
        "redundant equations": float(len(model.diagnosis.redundancies)),
        "largest error of the angle [rad]": float(
            abs(full["left.angle"].values - exact(full.time)).max()
        ),
        "difference of the motions [m, rad]": float(
            abs(full.trajectory.y - other.trajectory.y).max()
        ),
        "difference of the shares, all equations [N]": float(
            np.ptp(share["all equations"], axis=0).max()
        ),
        "difference of the shares, independent [N]": float(
            np.ptp(share["independent"], axis=0).max()
        ),
        "largest force of a crank [N]": float(share["all equations"].max()),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, axes = plt.subplots(1, 3, figsize=(10, 3.2), width_ratios=(1.2, 1, 1))
        for time, alpha in ((0.0, 0.9), (0.6, 0.4)):
            style.draw(axes[0], full, time, alpha=alpha)
        axes[0].set(xlabel="x [m]", ylabel="y [m]", title="a crank too many")
        for ax, name in zip(axes[1:], choices, strict=True):
            for crank, force, width in zip(PLACES, share[name], (4, 2.4, 1), strict=True):
                ax.plot(full.time, force, label=crank, lw=width)
            ax.set(xlabel="time [s]", title=f"force of the cranks [N], {name}")
            ax.legend(loc="upper left")
        style.save(figure, folder, "double_parallelogram")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
