"""A marimba bar: its arch is optimised for the frequency ratios 1 : 4 : 10.

A free bar of constant depth has the frequency ratios 1 : 2.76 : 5.40. An arch cut into its lower
side tunes it. The variables are the depths at eleven positions of one half. With exact gradients of
the frequencies, the smoothest arch is computed that has the frequency of C4, four times and ten
times this frequency.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import structures

LENGTH, WIDTH, DEPTH, LEAST = 0.36, 0.05, 0.022, 0.004
MODULUS, DENSITY = 17e9, 850.0
HALF = 11
TONES = 261.63 * np.array([1.0, 4.0, 10.0])
ROUGH = np.linspace(DEPTH, 0.4 * DEPTH, HALF)
"""Depths of the arch as it is sawn, before it is tuned [m]."""
ROUGHNESS = " + ".join(f"(1e3*h{k} - 1e3*h{k + 1})**2" for k in range(HALF - 1))
FLOATING = -1e5
"""Shift [rad²/s²] below the zero of the rigid modes, which are numbers 1 to 3."""


def build(parts: int = 1) -> da.Structure:
    """The bar, each of its 22 pieces of even depth made of some parts."""
    structure = da.Structure("marimba bar")
    depths = [
        structure.parameter(f"h{k}", h, "m", bounds=(LEAST, DEPTH)) for k, h in enumerate(ROUGH)
    ]
    depths = [depth for depth in (*depths, *depths[::-1]) for _ in range(parts)]
    nodes = [structure.node(f"n{k}", LENGTH * k / len(depths), 0.0) for k in range(len(depths) + 1)]
    for k, depth in enumerate(depths):
        beam = structures.TimoshenkoFrame(
            f"e{k}",
            nodes[k],
            nodes[k + 1],
            area=WIDTH * depth,
            second_moment=WIDTH * depth**3 / 12,
            shear_area=WIDTH * depth * 5 / 6,
            modulus=MODULUS,
            shear_modulus=MODULUS / 12,
            density=DENSITY,
        )
        structure.add(beam)
    return structure


def main(folder=None) -> dict[str, float]:
    model = build().build()
    tones = [da.at(k + 4, "frequency", name=f"tone {k + 1}") for k in range(3)]
    best = da.optimize(
        model,
        da.final(ROUGHNESS, name="roughness [mm^2]"),
        subject_to=[da.Limit(tone, lower=f, upper=f) for tone, f in zip(tones, TONES, strict=True)],
        analysis=da.Modal(count=6, shift=FLOATING),
        max_iterations=200,
        tolerance=1e-9,
    )
    even = solved(model, dict.fromkeys(model.parameters, DEPTH))
    found = best.motion.frequencies[3:]
    print(best.message, f"after {len(best.history) - 1} iterations, {best.runs} runs")
    for name, f in (("even", even), ("arched", found)):
        print(f"{name:7}", " ".join(f"{v:9.2f} Hz" for v in f), " ratios", (f / f[0]).round(4))
    if folder:
        draw(folder, best)
    slender = solved(model, dict.fromkeys(model.parameters, 1e-3))
    fine = solved(build(4).build(), best.x)
    return {
        "success": best.success,
        "second": found[1] / found[0],
        "third": found[2] / found[0],
        "first": found[0],
        "first, finer": fine[0],
        "third, finer": fine[2],
        "even second": slender[1] / slender[0],
        "even third": slender[2] / slender[0],
    }


def solved(model, depths: dict[str, float]) -> np.ndarray:
    """Frequencies [Hz] of the three tones."""
    return da.solve_modes(model, 6, shift=FLOATING, parameters=depths).frequencies[3:]


def draw(folder, best) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.4))
    depths = np.array(list(best.x.values()))
    x = np.linspace(0, LENGTH, 2 * HALF + 1)
    left.stairs(-1e3 * np.r_[depths, depths[::-1]], x, fill=True, color=style.YELLOW)
    left.set(title="the bar from the side [mm]", xlabel="x [m]", ylim=(-60, 20))
    modes = best.motion
    for k, colour in zip((4, 5, 6), (style.BLUE, style.ORANGE, style.GREEN), strict=True):
        shape = np.array([modes[f"n{i}.uy"].sel(mode=k).item() for i in range(x.size)])
        label = f"{modes['frequency'].sel(mode=k).item():.1f} Hz"
        right.plot(x, shape / np.abs(shape).max(), color=colour, label=label)
    right.set(title="shapes of its tones", xlabel="x [m]")
    right.legend()
    style.save(figure, folder, "marimba_bar")


if __name__ == "__main__":
    main(*sys.argv[1:])
