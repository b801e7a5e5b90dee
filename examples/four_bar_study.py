"""A study of a four-bar: dependence of transmission angle and swing on its lengths.

128 designs fill the ranges of three lengths evenly. Sobol' indices of a Gaussian process through
the designs measure the influence of each length; the process estimates its own error. The
transmission angle is extreme where crank and ground are collinear, cos μ = (c² + f² − (g ∓
d)²)/(2cf).
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

RANGES = {"d": (0.2, 0.4), "c": (0.9, 1.1), "f": (0.65, 0.85)}


def build() -> da.Model:
    system = da.System("crank-rocker")
    d = system.parameter("d", 0.3, "m")
    c = system.parameter("c", 1.0, "m")
    f = system.parameter("f", 0.75, "m")
    crank = system.add(planar.Bar("crank", length=d))
    coupler = system.add(planar.Bar("coupler", length=c, angle=0.6))
    rocker = system.add(planar.Bar("rocker", length=f, angle=1.6))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    system.add(planar.RotationalDriver("motor", system.ground, crank, 2 * math.pi * da.t))
    return system.build()


def main(folder=None) -> dict[str, float]:
    degrees = 180 / math.pi
    responses = [
        da.minimum(f"(rocker.angle - coupler.angle)*{degrees}", name="transmission angle [deg]"),
        da.maximum(f"rocker.angle*{degrees}", name="farthest turn [deg]"),
    ]
    study = da.sweep(
        build(),
        da.DesignTable.sobol(RANGES, 128, rng=1),
        analysis=da.Kinematics(duration=1.0, outputs=73),
        responses=responses,
    )
    surface = da.gaussian_process(study, "transmission angle [deg]")

    def run(design: da.DesignTable) -> da.SweepResult:
        values = surface(**dict(zip(design.names, design.values.T, strict=True)))
        return da.SweepResult(
            "surface", design, (surface.response,), values[:, None], ("",) * len(design)
        )

    indices = da.sobol_indices(run, RANGES, samples=1024, rng=1)
    d, c, f = study.design.values.T
    closed = np.degrees(np.arccos((c**2 + f**2 - (1 - d) ** 2) / (2 * c * f)))
    off = abs(study.column("transmission angle [deg]") - closed).max()
    total = indices.total.values[0]
    print(study)
    print(f"error of the surface: {surface.error:.2g} deg")
    print("total indices:", ", ".join(f"{n} {v:.3f}" for n, v in zip(RANGES, total, strict=True)))
    if folder:
        figure, axes = plt.subplots(1, 3, figsize=(11, 3.4), width_ratios=(1.3, 1, 0.7))
        x, y = np.meshgrid(np.linspace(*RANGES["d"], 40), np.linspace(*RANGES["f"], 40))
        drawn = axes[0].contourf(x, y, surface(d=x, c=1.0, f=y), 14, cmap="viridis")
        figure.colorbar(drawn, label="least transmission angle [deg]")
        axes[0].plot(d, f, ".", ms=3, color="white")
        axes[0].set(title="surface at c = 1 m", xlabel="crank d [m]", ylabel="rocker f [m]")
        axes[1].plot(study.values[:, 0], study.values[:, 1], ".", color=style.BLUE)
        axes[1].set(title="128 designs", xlabel=study.responses[0], ylabel=study.responses[1])
        axes[2].bar(list(RANGES), total, color=style.ORANGE)
        axes[2].set(title="total index")
        style.save(figure, folder, "four_bar_study")
    numbers = {f"total_{n}": float(v) for n, v in zip(RANGES, total, strict=True)}
    return {"off": float(off), "error": surface.error, "failed": len(study.failures), **numbers}


if __name__ == "__main__":
    main(*sys.argv[1:])
