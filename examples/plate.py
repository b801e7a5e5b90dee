"""Bracket plate: a deep cantilever as a mesh of quadrilaterals, compared with beam theory.

The end deflection agrees with that of a beam with shear deformation, P L³/(3 E I) + P L/(κ G A)
with κ = 5/6. Colours show the equivalent stress, averaged at the nodes.
"""

import sys

import matplotlib.pyplot as plt
import style

import dalembert as da
from dalembert import structures

LENGTH, HEIGHT, POISSON = 1.0, 0.25, 0.3


def build(kind: str = "quad8", counts: tuple[int, int] = (16, 4)) -> da.Structure:
    plate = da.Structure("bracket plate")
    thickness = plate.parameter("thickness", 0.01, "m", (2e-3, 0.03))
    modulus = plate.parameter("modulus", 70e9, "Pa")
    force = plate.parameter("force", 2000.0, "N", description="on each node of the free edge")
    mesh = plate.add_mesh(
        "plate",
        structures.rectangle_mesh((LENGTH, HEIGHT), counts, kind),
        thickness=thickness,
        modulus=modulus,
        poisson=POISSON,
        density=2700,
    )
    plate.support(mesh.nodes().where(x=0))
    plate.load(mesh.nodes().where(x=LENGTH), fy=-force)
    return plate


def deflection(force: float, thickness: float = 0.01, modulus: float = 70e9) -> float:
    """Of the end of a beam under a force there [m]."""
    bending = force * LENGTH**3 / (3 * modulus * thickness * HEIGHT**3 / 12)
    shear = modulus / (2 * (1 + POISSON)) * thickness * HEIGHT * 5 / 6
    return bending + force * LENGTH / shear


def main(folder=None) -> dict[str, float]:
    model = build().build()
    result = da.solve_statics(model)
    corner = next(iter(model.structure.nodes.values())).nearest(LENGTH, HEIGHT / 2)
    sag = -result.displacement_of(corner)[0, 1]
    total = -float(result.applied(0).sum())
    sensitivity = da.sensitivity(result, da.final("strain_energy"))
    numbers = {
        "force on the end [N]": total,
        "deflection of the end [m]": sag,
        "deflection of a beam [m]": deflection(total),
        "largest equivalent stress [Pa]": result["plate.von_mises.max"],
        "strain energy [J]": result["strain_energy"],
        "its derivative by the thickness [J/m]": float(sensitivity.sel(parameter="thickness")[0]),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, ax = plt.subplots(figsize=(7.2, 2.9))
        result.draw("plate.von_mises", smooth=True, ax=ax)
        ax.axis("off")
        style.save(figure, folder, "plate")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
