"""Stroke of a crank shaper with the tolerances of its drawing, and tolerances of minimum cost.

The stroke of the quick-return shaper is ``2 L r/d``, with crank r, distance d of the pivots and
lever L; the link has no influence. The example compares first order, second order, Monte Carlo and
worst case, and then allocates tolerances of minimum cost with the cost ``c/t`` of each.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import quick_return_shaper
import style

import dalembert as da

HALF = {"r": 0.1e-3, "d": 0.2e-3, "lever_length": 0.3e-3, "link_length": 0.5e-3}
COSTS = {"r": 2.0, "d": 3.0, "lever_length": 1.0, "link_length": 1.0}
LIMIT = 0.25e-3


def main(folder=None) -> dict[str, float]:
    model = quick_return_shaper.build().build()
    analysis = da.Kinematics(2 * math.pi / 6, outputs=361)
    stroke = da.integral("abs(ram.vx)/2", name="stroke [m]")  # forth and back
    found = da.tolerance(model, stroke, HALF, analysis=analysis, samples=150)
    chosen = found.allocate(LIMIT, COSTS, bounds=(0.02e-3, 0.5e-3))
    again = da.tolerance(
        model, stroke, chosen, analysis=analysis, second_order=False, worst_case=False
    )
    mean, std = found.second_order
    numbers = {
        "stroke": found.nominal,
        "std": found.std,
        "std to second order": std,
        "shift of the mean": mean - found.nominal,
        "std of the samples": float(np.std(found.sampled, ddof=1)),
        "least": found.worst[0],
        "largest": found.worst[1],
        "allocated": again.sigmas * again.std,
        "cost": sum(c / chosen[n] for n, c in COSTS.items()) * 1e-3,
        "cost before": sum(c / HALF[n] for n, c in COSTS.items()) * 1e-3,
    }
    numbers |= {f"±{n}": t for n, t in chosen.items()}
    print(*(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    if folder:
        picture(folder, found, chosen)
    return numbers


def picture(folder, found: da.ToleranceResult, chosen: dict[str, float]) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.6))
    off = 1e3 * (found.sampled - found.nominal)
    left.hist(off, bins=18, density=True, color=style.SKY, alpha=0.6, label="Monte Carlo")
    reach = 1e3 * max(abs(np.array(found.worst) - found.nominal)) * 1.1
    x, spread = np.linspace(-reach, reach, 200), 1e3 * found.std
    bell = np.exp(-0.5 * (x / spread) ** 2) / (spread * math.sqrt(2 * math.pi))
    left.plot(x, bell, label="first order")
    for k, worst in enumerate(found.worst):
        label = "worst case" if k == 0 else None
        left.axvline(1e3 * (worst - found.nominal), color=style.ORANGE, ls="--", label=label)
    left.set(title="stroke about its nominal value [mm]")
    left.set_ylim(0, 1.55 * bell.max())
    left.legend(ncols=3, fontsize=8, loc="upper center")
    names, places = list(HALF), np.arange(len(HALF))
    right.barh(places + 0.19, [1e3 * HALF[n] for n in names], 0.36, label="drawing")
    cheap = [1e3 * chosen[n] for n in names]
    right.barh(places - 0.19, cheap, 0.36, label="cheapest for ±0.25 mm at 3σ")
    right.set(title="tolerances [mm]", yticks=places, xlim=(0, 0.8))
    right.set_yticklabels(names)
    right.legend(fontsize=8)
    style.save(figure, folder, "shaper_tolerances")


if __name__ == "__main__":
    main(*sys.argv[1:])
