"""A leaf spring of minimum mass for its stiffness: thicknesses of its leaves by exact gradients.

Of all cantilevers of a given width and deflection under a small load, that with the thickness ``h ~
√x`` is the lightest (x from the tip): its strain energy per mass is uniform. In steps, each
thickness is proportional to the fourth root of the mean of ``x²`` over its step.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

LENGTH, WIDTH, MODULUS, DENSITY, STEPS = 0.5, 0.06, 206e9, 7850.0, 5
LOAD, SOFT = 100.0, 0.012


def build() -> da.System:
    system = da.System("leaf spring")
    h = [system.parameter(f"h{k + 1}", 0.008, "m", bounds=(0.002, 0.02)) for k in range(STEPS)]
    end = None
    for k, thickness in enumerate(h):
        area = WIDTH * thickness
        clamp = {"frame_i": system.ground.center} if k == 0 else {"position": (k * 0.1, 0.0)}
        leaf = system.add(
            planar.Beam(
                f"leaf{k + 1}",
                **clamp,
                **({} if k == 0 else {"angle": 0.0}),
                length=LENGTH / STEPS,
                axial_rigidity=MODULUS * area,
                shear_rigidity=1e3 * MODULUS * area,  # as thin beams do, it hardly shears
                bending_rigidity=MODULUS * WIDTH * thickness**3 / 12,
                mass_per_length=DENSITY * area,
                elements=1,
            )
        )
        if end is not None:
            system.add(planar.Weld(f"clip{k}", end.center, leaf.start.center))
        end = leaf.end
    system.add(planar.Force("load", end.center, (0.0, -LOAD)))
    return system


def best_steps() -> np.ndarray:
    """(STEPS,) thicknesses in closed form [m], from the clamp on."""
    x = np.linspace(LENGTH, 0, STEPS + 1)
    cubes = (x[:-1] ** 3 - x[1:] ** 3) / 3  # ∫ x² dx
    shape = (cubes * STEPS / LENGTH) ** 0.25
    soft = 12 * LOAD / (MODULUS * WIDTH) * np.sum(cubes / shape**3)
    return shape * (soft / SOFT) ** (1 / 3)


def main(folder=None) -> dict[str, float]:
    model = build().build()
    names = [f"h{k + 1}" for k in range(STEPS)]
    mass = DENSITY * WIDTH * LENGTH / STEPS * sum(model.parameters[n] for n in names)
    tip = f"leaf{STEPS}.end.y"
    best = da.optimize(
        model,
        minimize=da.final(mass),
        subject_to=[da.Limit(da.final(tip), lower=-SOFT)],
        vary=names,
        analysis=da.Equilibrium(),
    )
    found = np.array([best.x[n] for n in names])
    expected = best_steps()
    even = (4 * LOAD * LENGTH**3 / (MODULUS * WIDTH * SOFT)) ** (1 / 3)
    numbers = {
        "mass": float(DENSITY * WIDTH * LENGTH / STEPS * found.sum()),
        "saved": 1 - found.sum() / (STEPS * even),
        "worst": float(np.abs(found / expected - 1).max()),
    }
    print(
        f"thicknesses {', '.join(f'{1e3 * h:.2f}' for h in found)} mm, mass "
        f"{numbers['mass']:.3f} kg, {numbers['saved']:.1%} less than an even leaf"
    )
    if folder:
        figure, ax = plt.subplots(figsize=(7, 3))
        at = np.linspace(0, LENGTH, STEPS + 1)
        ax.stairs(1e3 * found, 1e3 * at, lw=2, label="found by exact gradients")
        ax.stairs(1e3 * expected, 1e3 * at, ls="--", label="closed form of steps")
        fine = np.linspace(0, LENGTH, 200)
        ax.plot(
            1e3 * fine,
            1e3 * expected[0] * np.sqrt((LENGTH - fine) / (LENGTH - LENGTH / STEPS / 2)),
            color=style.GREY,
            label="h ~ √x",
        )
        ax.set(title="leaf spring of least mass", xlabel="from the clamp [mm]")
        ax.set_ylabel("thickness [mm]")
        ax.legend()
        style.save(figure, folder, "leaf_spring")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
