"""Formulations and stabilisations compared on the four-bar of the book's section 5.4.3, all by RK4.

Left: cost over accuracy. All formulations solve the same equations, so at the same step their
errors agree but their times differ. Only the penalty method solves other equations, with slightly
compliant joints, and its error soon stops decreasing.

Right: the energy with four treatments of the constraint violation, at the same steps. Projection
closes the joints to round-off but loses energy; energy projection conserves both, but the motion
still has an error.
"""

import math
import sys

import matplotlib.pyplot as plt
import style

import dalembert as da
from dalembert import planar

FORMULATIONS = ("RangeSpace", "KKT", "NullSpace", "AugmentedLagrangian", "Penalty")
STABILIZATIONS = ("Stabilization", "Baumgarte", "Projection", "EnergyProjection")
STEPS = (0.01, 0.005, 0.0025)


def build() -> da.System:
    """One fixed pivot above the other, the crank square to their line."""
    system = da.System("four-bar", gravity=(0.0, -9.81))
    crank = system.add(
        planar.Bar("crank", length=0.3, mass=1.5, angle=math.pi, angular_velocity=1.0)
    )
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=5.0, angle=1.9))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=3.0, angle=3.2))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(0, 1), rocker.start))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    settings = {"integrators": "RK4", "steps": STEPS}
    costs = da.compare(model, 4.0, formulations=FORMULATIONS, **settings)
    kept = da.compare(
        model, 4.0, formulations="RangeSpace", stabilizations=STABILIZATIONS, **settings
    )
    print(costs, kept, sep="\n\n")
    numbers = {"uncertainty": costs.uncertainty}
    for name in FORMULATIONS:
        row = costs.sel(formulation=name, step=STEPS[-1]).table().iloc[0]
        numbers[f"error {name}"] = float(row["error_position"])
    for name in STABILIZATIONS:
        row = kept.sel(stabilization=name, step=STEPS[-1]).table().iloc[0]
        numbers[f"violation {name}"] = float(row["position_violation"])
        numbers[f"energy {name}"] = float(row["energy_error"])
    if folder:
        figure, axes = plt.subplots(1, 2, figsize=(11, 4.6), layout="none")
        figure.subplots_adjust(0.07, 0.11, 0.99, 0.94, wspace=0.2)
        costs.sel(formulation=["RangeSpace", "KKT", "Penalty"]).plot(ax=axes[0])
        kept.plot("energy", ax=axes[1])
        style.save(figure, folder, "compare_four_bar")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
