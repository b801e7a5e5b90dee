"""The lightest two-bar truss over the reliability index.

Section and height of a timber truss are optimised with limits of deflection and buckling, each with
a required reliability index β; load, material and sawn section are random. The page also shows the
deterministic optimum, and the optimum with three standard deviations of distance from its limits.
All variables are lognormal and both limits are products of powers, so that the index of any design
has a closed form.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import structures

WIDTH, LOAD, MODULUS, DENSITY = 2.0, 60e3, 11e9, 420.0
MOST = 6.5e-3
RANDOM = {
    "load": da.Lognormal(LOAD, 0.2 * LOAD),
    "modulus": da.Lognormal(MODULUS, 0.13 * MODULUS),
    "cut": da.Lognormal(1.0, 0.03),
}
INDICES = (1.0, 2.0, 3.0, 4.0, 5.0)


def build() -> da.Structure:
    structure = da.Structure("timber truss")
    load = structure.parameter("load", LOAD, "N")
    modulus = structure.parameter("modulus", MODULUS, "Pa")
    side = structure.parameter("side", 0.11, "m", bounds=(0.05, 0.3))
    cut = structure.parameter("cut", 1.0, description="what the saw makes of the side")
    height = structure.parameter("height", 1.0, "m", bounds=(0.5, 3.0))
    apex = structure.node("apex", 0, height)
    for k, x in enumerate((-WIDTH, WIDTH)):
        foot = structure.node(f"foot{k}", x, 0)
        bar = structures.Truss(
            f"bar{k}", foot, apex, area=(side * cut) ** 2, modulus=modulus, density=DENSITY
        )
        structure.add(bar)
        structure.support(foot)
    structure.load(apex, fy=-load)
    return structure


def shares() -> list[da.Response]:
    """Deflection, and force of a square bar with hinged ends, each over the most that may be."""
    euler = f"-bar0.force*{12 / np.pi**2!r}*({WIDTH**2} + height**2)/(modulus*(side*cut)**4)"
    return [
        da.final(f"-apex.uy/{MOST}", name="deflection"),
        da.final(euler, name="buckling"),
    ]


def limits(shares) -> list[da.Limit]:
    return [da.Limit(share, upper=1.0) for share in shares]


def exact(x: dict[str, float]) -> tuple[float, float]:
    """Indices of a design: ``ln`` of what may be over what is, in standard deviations."""
    means, spread = zip(*(given.logarithm for given in RANDOM.values()), strict=True)
    F, E, a = np.exp(means) * (1.0, 1.0, x["side"])
    length = np.hypot(WIDTH, x["height"])
    deflection = F * length**3 / (2 * x["height"] ** 2 * E * a**2)
    force = F * length / (2 * x["height"])
    buckling = np.pi**2 * E * a**4 / (12 * length**2)
    found = []
    for ratio, power in ((MOST / deflection, 2), (buckling / force, 4)):
        found.append(float(np.log(ratio) / np.linalg.norm(np.multiply(spread, (1, 1, power)))))
    return found[0], found[1]


def main(folder=None) -> dict[str, float]:
    model, mass = build().build(), da.final("mass")
    task = {"vary": ["side", "height"], "analysis": da.Statics()}
    plain = da.optimize(model, minimize=mass, subject_to=limits(shares()), **task)
    task["subject_to"] = limits(shares())
    sure = [da.optimize_reliable(model, mass, random=RANDOM, beta=beta, **task) for beta in INDICES]
    task["subject_to"] = limits([da.robust(share, RANDOM, 3.0) for share in shares()])
    steady = da.optimize(model, minimize=mass, **task)
    numbers = {"mass": plain.fun, "beta": min(exact(plain.x))}
    for beta, best in zip(INDICES, sure, strict=True):
        numbers[f"mass at {beta:g}"] = best.optimum.fun
        numbers[f"beta at {beta:g}"] = min(exact(best.x))
    numbers |= {"robust mass": steady.fun, "robust beta": min(exact(steady.x))}
    print(*(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    if folder:
        picture(folder, plain, sure, steady)
    return numbers


def picture(
    folder,
    plain: da.OptimizationResult,
    sure: list[da.ReliableOptimizationResult],
    steady: da.OptimizationResult,
) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.8), width_ratios=(1, 1.25))
    left.plot(
        INDICES, [best.optimum.fun for best in sure], "o-", color=style.BLUE, label="reliable"
    )
    marks = (("no scatter thought of", plain, style.ORANGE), ("3 σ kept away", steady, style.GREEN))
    for label, best, colour in marks:
        left.plot(min(exact(best.x)), best.fun, "s", color=colour, label=label)
    left.set(title="what reliability weighs", xlabel="reliability index β", ylabel="mass [kg]")
    left.legend(loc="upper left")
    shown = [(f"β = {INDICES[k]:g}", sure[k].x, c) for k, c in ((4, style.PINK), (2, style.BLUE))]
    shown.append(("no scatter thought of", plain.x, style.ORANGE))
    for label, x, colour in shown:
        right.plot(
            [-WIDTH, 0, WIDTH],
            [0, x["height"], 0],
            color=colour,
            lw=60 * x["side"],
            solid_capstyle="round",
            label=f"{label}: {100 * x['side']:.1f} cm, {x['height']:.2f} m",
        )
    right.set(title="the designs, sections drawn thicker", aspect="equal")
    right.set(xlabel="x [m]", ylabel="y [m]", ylim=(-0.2, 2.2))
    right.legend(loc="upper right", fontsize=8)
    style.save(figure, folder, "lightest_reliable_truss")


if __name__ == "__main__":
    main(*sys.argv[1:])
