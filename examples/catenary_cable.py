"""A cable between two poles: its sag and tension compared with the closed form of the catenary.

A chain of length L between supports a distance d apart hangs as ``y = c cosh(x/c)`` with ``2 c
sinh(d/(2c)) = L``, and pulls its supports together with the force ``w c``. The cable is a beam of
very small bending stiffness; its initial shape is an arc between the poles.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style
from scipy.optimize import brentq

import dalembert as da
from dalembert import planar

LENGTH, SPAN, WEIGHT = 12.0, 10.0, 0.8 * 9.81


def build() -> da.System:
    system = da.System("cable", gravity=(0.0, -9.81))
    span = system.parameter("span", SPAN, "m", bounds=(6.0, 11.5))
    cable = system.add(
        planar.Beam(
            "cable",
            length=LENGTH,
            curvature=0.1712,  # an arc that fits to start from; its bending is too weak to matter
            axial_rigidity=1e6,
            shear_rigidity=1e6,
            bending_rigidity=1e-2,
            mass_per_length=0.8,
            elements=12,
            position=(0.0, 0.0),
            angle=-1.027,
            relaxed=False,
        )
    )
    system.add(planar.Revolute("left", system.ground.center, cable.start))
    system.add(planar.Revolute("right", system.ground.point(span, 0.0), cable.end))
    return system


def catenary() -> tuple[float, float]:
    """Sag [m] and horizontal pull [N]."""
    c = brentq(lambda c: 2 * c * np.sinh(SPAN / (2 * c)) - LENGTH, 1.0, 100.0)
    return c * (np.cosh(SPAN / (2 * c)) - 1), WEIGHT * c


def main(folder=None) -> dict[str, float]:
    model = build().build()
    hanging = da.solve_equilibrium(model)
    sag, pull = catenary()
    numbers = {
        "sag": -float(hanging["cable.node18.y"].values[0]),
        "pull": float(hanging["left.force.x"].values[0]),
    }
    slope = da.sensitivity(hanging, da.final("cable.node18.y")).sel(parameter="span").item()
    numbers["slope"] = -float(slope)
    print(
        f"sag {numbers['sag']:.4f} m (catenary {sag:.4f}), pull {abs(numbers['pull']):.3f} N "
        f"({pull:.3f}), sag per span {numbers['slope']:.3f}"
    )
    if folder:
        figure, ax = plt.subplots(figsize=(7, 3.4))
        x, y = (
            [float(hanging[f"{node.name}.{q}"].values[0]) for node in model.bodies] for q in "xy"
        )
        order = np.argsort(x)
        c = pull / WEIGHT
        fine = np.linspace(0, SPAN, 200)
        exact = c * (np.cosh((fine - SPAN / 2) / c) - np.cosh(SPAN / (2 * c)))
        ax.plot(fine, exact, color=style.GREY, lw=4, alpha=0.4, label="catenary")
        ax.plot(np.array(x)[order], np.array(y)[order], "o-", ms=3, label="cable of 12 elements")
        ax.set(title="a hanging cable", xlabel="x [m]", ylabel="y [m]", aspect="equal")
        ax.legend(loc="upper center")
        style.save(figure, folder, "catenary_cable")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
