"""Reliability of a two-bar truss: deflection and buckling with random load, timber and section.

Two equal inclined bars carry a load at their apex. Too much deflection or a buckled bar is failure.
All variables are lognormal and both limits are products of powers, so that the reliability indices
have a closed form: ``ln`` of capacity over demand is normal.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import structures

WIDTH, HEIGHT, LOAD, SIDE, MODULUS = 2.0, 1.0, 60e3, 0.095, 11e9
MOST = 6.5e-3
RANDOM = {
    "load": da.Lognormal(LOAD, 0.2 * LOAD),
    "modulus": da.Lognormal(MODULUS, 0.13 * MODULUS),
    "side": da.Lognormal(SIDE, 0.03 * SIDE),
}


def build() -> da.Structure:
    structure = da.Structure("two-bar truss")
    load = structure.parameter("load", LOAD, "N")
    modulus = structure.parameter("modulus", MODULUS, "Pa")
    side = structure.parameter("side", SIDE, "m")
    apex = structure.node("apex", 0, HEIGHT)
    for k, x in enumerate((-WIDTH, WIDTH)):
        foot = structure.node(f"foot{k}", x, 0)
        structure.add(
            structures.Truss(f"bar{k}", foot, apex, area=side**2, modulus=modulus, density=420)
        )
        structure.support(foot)
    structure.load(apex, fy=-load)
    return structure


def limits() -> list:
    """Deflection, and Euler's load of a square bar with hinged ends."""
    euler = f"{np.pi**2 / (12 * (WIDTH**2 + HEIGHT**2))!r}*modulus*side**4 + bar0.force"
    return [da.Limit(da.final("apex.uy"), lower=-MOST), da.final(euler, name="buckling")]


def main(folder=None) -> dict[str, float]:
    model = build().build()
    found = da.reliability(model, limits(), RANDOM, analysis=da.Statics())
    sampled = found.importance_sampling(500)
    numbers = {}
    for name, point in zip(("deflection", "buckling"), found.points, strict=True):
        numbers[f"beta of {name}"] = point.beta
        numbers[f"residual of {name}"] = point.residual
    numbers |= {"probability": found.probability, "sampled": sampled.probability}
    numbers |= {"low": sampled.interval[0], "high": sampled.interval[1]}
    print(*(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    if folder:
        picture(folder, found)
    return numbers


def picture(folder, found: da.ReliabilityResult) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.8), width_ratios=(1.25, 1))
    nataf = found.nataf
    side = found.point.u[2]  # the section held where failure is likeliest
    a, b = np.meshgrid(np.linspace(-1, 5, 31), np.linspace(-4, 2, 31))
    points = nataf.values(np.stack([a, b, np.full_like(a, side)], axis=-1).reshape(-1, 3))
    g = found.searches[0].limits.values_at(points).reshape(*a.shape, 2)
    for k, name in enumerate(("deflection", "buckling")):
        left.contour(a, b, g[:, :, k], [0], colors=style.COLOURS[k])
        left.plot([], color=style.COLOURS[k], label=f"{name}, β = {found.points[k].beta:.3f}")
    left.contourf(a, b, g.min(axis=2), [-1e9, 0], colors=[style.ORANGE], alpha=0.12)
    for radius in (1, 2, 3):
        left.add_patch(plt.Circle((0, 0), radius, fill=False, ec="0.7", lw=0.8))
    left.plot(*found.point.u[:2], "o", color="0.2", label="design point")
    left.set(
        title="failure is shaded, rings are standard deviations",
        xlabel="load, as a standard normal variable",
        ylabel="modulus",
        aspect="equal",
        xlim=(-1, 5),
        ylim=(-4, 2),
    )
    left.legend(loc="upper left", fontsize=8, frameon=True, framealpha=0.95)
    names = list(RANDOM)
    for k, (name, point) in enumerate(zip(("deflection", "buckling"), found.points, strict=True)):
        shares = 100 * point.alpha**2
        places = np.arange(len(names)) + 0.19 * (2 * k - 1)
        right.barh(places, shares, height=0.36, color=style.COLOURS[k], label=name)
    right.set(title="share of the variance [%]", yticks=range(len(names)))
    right.set_yticklabels(names)
    right.legend()
    style.save(figure, folder, "reliable_truss")


if __name__ == "__main__":
    main(*sys.argv[1:])
