"""Minimum mass of a ten-bar truss with limits of stress and deflection, by adjoint gradients."""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import structures

INCH, POUND, KIP = 0.0254, 0.45359237, 4448.2216152605
PSI = 1e-3 * KIP / INCH**2
PLACES = [(720, 360), (720, 0), (360, 360), (360, 0), (0, 360), (0, 0)]
BARS = [(4, 2), (2, 0), (5, 3), (3, 1), (2, 3), (0, 1), (4, 3), (5, 2), (2, 1), (3, 0)]
PUBLISHED = [30.5218, 0.1, 23.1999, 15.2229, 0.1, 0.5514, 7.4572, 21.0364, 21.5284, 0.1]
STRESS, DEFLECTION, LEAST, START = 25e3 * PSI, 2 * INCH, 0.1 * INCH**2, 20.0 * INCH**2


def build() -> da.Structure:
    structure = da.Structure("ten-bar truss")
    nodes = [structure.node(f"n{k}", x * INCH, y * INCH) for k, (x, y) in enumerate(PLACES)]
    for k, (i, j) in enumerate(BARS):
        area = structure.parameter(f"a{k}", START, "m^2", bounds=(LEAST, 40 * INCH**2))
        structure.add(
            structures.Truss(
                f"bar{k}",
                nodes[i],
                nodes[j],
                area=area,
                modulus=1e7 * PSI,
                density=0.1 * POUND / INCH**3,
            )
        )
    for node in nodes[4:]:
        structure.support(node)
    for node in (nodes[1], nodes[3]):
        structure.load(node, fy=-100 * KIP)
    return structure


def main(folder=None) -> dict[str, float]:
    model = build().build()
    limits = [da.Limit(da.final(f"bar{k}.stress"), lower=-STRESS, upper=STRESS) for k in range(10)]
    limits += [
        da.Limit(da.final(f"n{k}.{u}"), lower=-DEFLECTION, upper=DEFLECTION)
        for k in range(4)
        for u in ("ux", "uy")
    ]
    best = da.optimize(
        model,
        da.final("mass"),
        subject_to=limits,
        analysis=da.Statics(),
        tolerance=1e-10,
        max_iterations=300,
    )
    result = best.motion
    areas = np.array(list(best.x.values())) / INCH**2
    weight = best.fun / POUND
    deflection = max(abs(result[f"n{k}.uy"]) for k in range(4)) / INCH
    print(f"weight {best.history[0].objective / POUND:.2f} lb → {weight:.2f} lb, {best.message}")
    print("areas [in²]:", " ".join(f"{a:.4f}" for a in areas))
    print(
        f"largest deflection {deflection:.6f} in, stress in bar 4 "
        f"{result['bar4.stress'] / PSI / 1e3:.3f} ksi"
    )
    if folder:
        picture(folder, result, areas)
    return {"weight": weight, "deflection": deflection, "area of bar 0": areas[0]}


def picture(folder, result, areas) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.6), width_ratios=(1.5, 1))
    stress = np.array([result[f"bar{k}.stress"] for k in range(10)]) / PSI / 1e3
    for k, (i, j) in enumerate(BARS):
        ends = np.array([PLACES[i], PLACES[j]]).T
        colour = style.BLUE if stress[k] > 0 else style.ORANGE
        left.plot(*ends, color=colour, lw=0.6 + areas[k] / 3.5, solid_capstyle="round")
        middle = ends @ (0.6, 0.4)
        left.annotate(
            f"{stress[k]:.1f}",
            middle,
            fontsize=7.5,
            ha="center",
            va="center",
            bbox={"boxstyle": "round,pad=0.2", "fc": "w", "ec": "none", "alpha": 0.85},
        )
    left.plot(*np.array(PLACES).T, "o", color="w", mec="0.2", ms=7, zorder=5)
    left.set(
        title="best areas as widths, stress [ksi]: blue pulled, orange pressed",
        xlabel="x [in]",
        ylabel="y [in]",
        aspect="equal",
    )
    right.bar(np.arange(10), areas, color=style.BLUE, width=0.6, label="found")
    right.plot(np.arange(10), PUBLISHED, "o", color=style.ORANGE, ms=5, label="published")
    right.set(title="areas [in²]", xlabel="bar", xticks=range(10))
    right.legend()
    style.save(figure, folder, "ten_bar_truss")


if __name__ == "__main__":
    main(*sys.argv[1:])
