"""Minimum mass of a cantilever of eighteen bars: areas and positions of joints.

Five loads act on the upper chord, whose joints are fixed; the four lower ones may move. The stress
of no bar may exceed 20 ksi or the buckling stress 4 E A/L². The variables are four areas and eight
coordinates. This is a standard test of shape optimisation since Imai and Schmit (1981), with 4,668
lb; later searches reached 4,530 lb and less. With exact gradients a dozen runs suffice.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import structures

INCH, POUND, KIP = 0.0254, 0.45359237, 4448.2216152605
KSI = KIP / INCH**2
MODULUS, DENSITY, STRONGEST, FORCE = 1e4 * KSI, 0.1 * POUND / INCH**3, 20 * KSI, 20 * KIP
UPPER = {1: 1250, 2: 1000, 4: 750, 6: 500, 8: 250, 10: 0}
LOWER = {3: 1000, 5: 750, 7: 500, 9: 250}
BARS = [(1, 2), (1, 3), (2, 3), (2, 4), (3, 4), (3, 5), (4, 5), (4, 6), (5, 6), (5, 7)]
BARS += [(6, 7), (6, 8), (7, 8), (7, 9), (8, 9), (8, 10), (9, 10), (9, 11)]
GROUPS = {"upper": (0, 3, 7, 11, 15), "lower": (1, 5, 9, 13, 17)}
GROUPS |= {"posts": (2, 6, 10, 14), "diagonals": (4, 8, 12, 16)}
LOADED = (1, 2, 4, 6, 8)


def build() -> da.Structure:
    truss = da.Structure("truss of eighteen bars")
    areas = {}
    for name, members in GROUPS.items():
        area = truss.parameter(name, 12 * INCH**2, "m^2", bounds=(2 * INCH**2, 21.75 * INCH**2))
        areas |= dict.fromkeys(members, area)
    nodes = {k: truss.node(f"n{k}", x * INCH, 250 * INCH) for k, x in UPPER.items()}
    for k, x in LOWER.items():
        sides = (x - 225) * INCH, (x + 225) * INCH
        along = truss.parameter(f"x{k}", x * INCH, "m", bounds=sides)
        up = truss.parameter(f"y{k}", 0.0, "m", bounds=(-225 * INCH, 245 * INCH))
        nodes[k] = truss.node(f"n{k}", along, up)
    nodes[11] = truss.node("n11", 0.0, 0.0)
    for k, (i, j) in enumerate(BARS):
        bar = {"area": areas[k], "modulus": MODULUS, "density": DENSITY}
        truss.add(structures.Truss(f"b{k}", nodes[i], nodes[j], **bar))
    truss.support(nodes[10])
    truss.support(nodes[11])
    for k in LOADED:
        truss.load(nodes[k], fy=-FORCE)
    return truss


def limits() -> list[da.Limit]:
    """Stress over what the material bears, compression over what buckles: ``m = ρ A L``."""
    made = []
    for name, members in GROUPS.items():
        for k in members:
            stress = da.final(f"b{k}.stress/{STRONGEST!r}", name=f"stress of {k + 1}")
            length = f"b{k}.mass/({DENSITY!r}*{name})"
            share = f"-b{k}.stress*({length})**2/({4 * MODULUS!r}*{name})"
            buckling = da.final(share, name=f"buckling of {k + 1}")
            made += [da.Limit(stress, lower=-1, upper=1), da.Limit(buckling, upper=1)]
    return made


def main(folder=None) -> dict[str, float]:
    model = build().build()
    best = da.optimize(model, minimize=da.final("mass"), subject_to=limits(), analysis=da.Statics())
    first = best.history[0]
    print(f"{first.objective / POUND:.1f} lb → {best.fun / POUND:.2f} lb in {best.runs} runs")
    print(*best.active, sep=", ")
    if folder:
        picture(folder, best)
    return {"mass [lb]": best.fun / POUND, "runs": best.runs, "success": best.success} | best.x


def places(x: dict[str, float]) -> dict[int, tuple[float, float]]:
    upper = {k: (along * INCH, 250 * INCH) for k, along in UPPER.items()}
    return {**upper, **{k: (x[f"x{k}"], x[f"y{k}"]) for k in LOWER}, 11: (0.0, 0.0)}


def picture(folder, best: da.OptimizationResult) -> None:
    figure, ax = plt.subplots(figsize=(9.5, 2.9))
    colours = dict(zip(GROUPS, style.COLOURS, strict=False))
    first = places(best.history[0].parameters)
    for i, j in BARS:
        ax.plot(*zip(first[i], first[j], strict=True), color="0.8", lw=1)
    there = places(best.x)
    for name, members in GROUPS.items():
        area = best.x[name]
        for number, k in enumerate(members):
            label = f"{name}: {area / INCH**2:.1f} in²" if number == 0 else None
            ends = zip(*(there[n] for n in BARS[k]), strict=True)
            ax.plot(*ends, color=colours[name], lw=6 * np.sqrt(area / INCH**2 / 12), label=label)
    for k in LOADED:
        x, y = there[k]
        ax.annotate("", (x, y + 0.2), (x, y + 1.8), arrowprops={"arrowstyle": "->"})
    ax.plot(*zip(there[10], there[11], strict=True), "s", color="0.3", ms=8)
    ax.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", xlim=(-1, 40), ylim=(-0.8, 8.6))
    begun = best.history[0].objective / POUND
    ax.set(title=f"{best.fun / POUND:.1f} lb; the first sketch, {begun:.0f} lb, in grey")
    ax.legend(loc="upper right", fontsize=8)
    style.save(figure, folder, "truss_shape")


if __name__ == "__main__":
    main(*sys.argv[1:])
