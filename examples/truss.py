"""Warren truss under snow and wind: bar forces, and the design of minimum mass.

By the method of sections a chord carries the bending moment divided by the height, and the
diagonals carry the shear force. The picture shows both for two load cases, and the optimised truss.
"""

import itertools
import sys

import matplotlib.pyplot as plt
import style

import dalembert as da
from dalembert import structures

STEEL = {"modulus": 210e9, "density": 7850}


def build() -> da.Structure:
    truss = da.Structure("Warren truss")
    chord = truss.parameter("chord_area", 8e-4, "m^2", (1e-4, 5e-3), "of the chords")
    web = truss.parameter("web_area", 5e-4, "m^2", (1e-4, 5e-3), "of the diagonals")
    height = truss.parameter("height", 1.6, "m", (0.8, 3.0))
    low = [truss.node(f"l{k}", 2 * k, 0) for k in range(4)]
    up = [truss.node(f"u{k}", 2 * k + 1, height) for k in range(3)]
    for name, nodes in (("bottom", low), ("top", up)):
        for k, (i, j) in enumerate(itertools.pairwise(nodes)):
            truss.add(structures.Truss(f"{name}{k}", i, j, area=chord, **STEEL))
    zigzag = [low[0], up[0], low[1], up[1], low[2], up[2], low[3]]
    for k, (i, j) in enumerate(itertools.pairwise(zigzag)):
        truss.add(structures.Truss(f"web{k}", i, j, area=web, **STEEL))
    truss.support(low[0], ux=0, uy=0)
    truss.support(low[3], uy=0)
    for node in up:
        truss.load(node, "snow", fy=-30e3)
    truss.load(up[0], "wind", fx=20e3)
    truss.load(up[1], "wind", fy=8e3)
    return truss


def lightest(model):
    """The least mass within limits of sag and stresses under snow."""
    limits = {"-l1.uy": 8e-3, "bottom1.stress": 120e6, "-web0.stress": 90e6}
    return da.optimize(
        model,
        minimize=da.final(model["mass"]),
        subject_to=[da.Limit(da.at(0, name), upper=most) for name, most in limits.items()],
        vary=list(model.parameters),
        analysis=da.Statics(),
    )


def main(folder=None) -> dict[str, float]:
    model = build().build()
    result = da.solve_statics(model)
    best = lightest(model)
    snow = result.case("snow")
    numbers = {
        "force in the bottom chord [N]": result["bottom1.force"][snow],
        "force in the first diagonal [N]": result["web0.force"][snow],
        "reaction on the left, wind [N]": result["l0.fx"][result.case("wind")],
        "mass [kg]": result["mass"][0],
        "lightest mass [kg]": best.fun,
        "stress in the chord of the lightest [Pa]": best.motion["bottom1.stress"][snow],
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, axes = plt.subplots(3, 1, figsize=(7.2, 7.6))
        result.draw("force", "snow", ax=axes[0])
        result.draw("force", "wind", ax=axes[1])
        best.motion.draw("stress", "snow", ax=axes[2])
        axes[2].set_title(f"lightest, {best.fun:.0f} kg; {axes[2].get_title('left')}")
        for ax in axes:
            ax.axis("off")
        style.save(figure, folder, "truss")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
