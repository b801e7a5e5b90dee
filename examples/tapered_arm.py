"""Optimisation of the profile of a flexible arm with a payload: four heights are optimised.

The arm is a structure of finite elements in a floating frame. The mean square of the lag of its tip
during the motion of the hub is minimised at constant mass, with gradients through the reduction of
the structure to its shapes. If only the payload had mass, optimal heights would be proportional to
``(∫ s² ds)^(1/4)``, with the distances ``s`` of the sections of a piece from the load.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import laws, planar
from dalembert.structures import Frame

LENGTH, WIDTH, HEIGHT, DENSITY = 1.0, 0.02, 0.04, 2700.0
PIECES, EACH = 4, 3
HEIGHTS = [f"h{k + 1}" for k in range(PIECES)]
MOVE = 1.0


def arm() -> da.Structure:
    structure = da.Structure("arm")
    heights = [structure.parameter(name, HEIGHT, "m") for name in HEIGHTS]
    count = PIECES * EACH
    nodes = [structure.node(f"n{k}", LENGTH * k / count, 0.0) for k in range(count + 1)]
    for k in range(count):
        h = heights[k // EACH]
        section = {"area": WIDTH * h, "second_moment": WIDTH * h**3 / 12}
        structure.add(
            Frame(f"e{k}", nodes[k], nodes[k + 1], modulus=70e9, density=DENSITY, **section)
        )
    return structure


def build() -> da.System:
    system = da.System("tapered arm")
    heights = {h: system.parameter(h, HEIGHT, "m", bounds=(0.01, 0.08)) for h in HEIGHTS}
    system.derived("mass", DENSITY * WIDTH * LENGTH / PIECES * sum(heights.values()), "kg")
    flexible = system.add(
        planar.FlexibleBody(
            "arm",
            arm().build(),
            interface={"hub": "n0", "tip": f"n{PIECES * EACH}"},
            modes=2,
            reference="hub",
            parameters=heights,
            damping_ratio=0.05,
            position=(0, 0),
            angle=0.0,
        )
    )
    load = system.add(planar.Particle("load", mass=10.0, position=(LENGTH, 0)))
    system.add(planar.Revolute("shaft", system.ground.center, flexible.point("hub")))
    system.add(planar.Revolute("grip", flexible.point("tip"), load.center))
    law = laws.Polynomial4567Rise(height=1.0, duration=MOVE)
    system.add(planar.RotationalDriver("motor", system.ground, flexible.section("hub"), law))
    return system


def analysis() -> da.Dynamics:
    return da.Dynamics(duration=MOVE, step=0.025, integrator=da.Radau(fixed=True))


LAG = da.mean("(1e3*arm.tip.deflection.y)**2", name="mean square lag [mm^2]")
MASS = da.final("mass")


def best_profile(model: da.Model) -> da.OptimizationResult:
    """Least lag at constant mass."""
    mass = DENSITY * WIDTH * LENGTH * HEIGHT
    return da.optimize(
        model,
        minimize=LAG,
        subject_to=[da.Limit(MASS, upper=mass)],
        vary=HEIGHTS,
        analysis=analysis(),
    )


def load_alone() -> np.ndarray:
    """Heights that are best where the load is all that weighs."""
    s = LENGTH * (1 - np.arange(PIECES + 1) / PIECES)
    shares = ((s[:-1] ** 3 - s[1:] ** 3) / 3) ** 0.25
    return HEIGHT * shares / shares.mean()


def main(folder=None) -> dict[str, float]:
    model = build().build()
    best = best_profile(model)
    before, after = analysis().run(model), best.motion
    slopes = da.sensitivity(before, LAG, method="adjoint").values.ravel()
    differences = da.sensitivity(before, LAG, method="finite-difference").values.ravel()
    heights = np.array([best.x[h] for h in HEIGHTS])
    off = np.abs(heights / load_alone() - 1).max()
    lags = [float(da.evaluate(motion, LAG)) for motion in (before, after)]
    print(
        f"heights {', '.join(f'{1e3 * h:.1f}' for h in heights)} mm lessen the mean square lag "
        f"from {lags[0]:.3f} to {lags[1]:.3f} mm²; they are within {100 * off:.1f} % of those for "
        "the load alone"
    )
    if folder:
        picture(before, after, heights, folder)
    return {
        "before": lags[0],
        "after": lags[1],
        "off": float(off),
        "slope_error": float(np.abs(slopes - differences).max() / np.abs(slopes).max()),
    }


def picture(before, after, heights: np.ndarray, folder) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2))
    ends = np.linspace(0, LENGTH, PIECES + 1)
    for values, colour, label in (
        (np.full(PIECES, HEIGHT), style.GREY, "even"),
        (heights, style.BLUE, "optimised"),
        (load_alone(), style.ORANGE, "best for the load alone"),
    ):
        for side in (-0.5, 0.5):
            label_once = label if side > 0 else None
            left.stairs(1e3 * side * values, ends, baseline=None, color=colour, label=label_once)
    left.set(title="height of the arm [mm]", xlabel="x [m]")
    left.legend(loc="center")
    for motion, colour, label in ((before, style.GREY, "even"), (after, style.BLUE, "optimised")):
        lag = 1e3 * motion["arm.tip.deflection"].values[:, 1]
        right.plot(motion.time, lag, color=colour, label=label)
    right.set(title="deflection of the tip [mm]", xlabel="t [s]")
    right.legend()
    style.save(figure, folder, "tapered_arm")


if __name__ == "__main__":
    main(*sys.argv[1:])
