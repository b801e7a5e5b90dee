"""A tuned mass on a tower under ground motion, and the influence of its spring on the largest sway.

The ground of a steel tower of 40 m moves in a burst near its first frequency. A mass of 5 % of its
modal mass is attached to its top by a spring. The gradient of the root mean square and of the
largest sway with respect to the stiffness of the spring comes from the adjoint of the time steps; a
sweep over stiffnesses shows that it is the slope of the curves.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import structures

HEIGHT, RIGIDITY, MASS, PARTS = 40.0, 4.2e9, 785.0, 10
OMEGA = 1.8751040687119612**2 * math.sqrt(RIGIDITY / (MASS * HEIGHT**4))
SHARE, DAMPING = 0.05, 0.01
TUNED = SHARE * MASS * HEIGHT / 4
DURATION, STEP = 16.0, 0.025
STIFFNESSES = np.linspace(0.6, 1.3, 8) * TUNED * OMEGA**2


def ground(time):
    """Displacement of the ground [m]."""
    return 0.02 * da.sin(OMEGA * time) * da.exp(-(((time - 4.0) / 2.0) ** 2))


def build(tuned: bool) -> da.Structure:
    s = da.Structure("tower")
    stiffness = s.parameter("stiffness", TUNED * OMEGA**2 / (1 + SHARE) ** 2, "N/m", (1.0, None))
    nodes = [s.node(f"n{k}", 0.0, HEIGHT * k / PARTS) for k in range(PARTS + 1)]
    numbers = {"area": 0.1, "second_moment": RIGIDITY / 210e9, "modulus": 210e9}
    for k in range(PARTS):
        part = f"part{k}", nodes[k], nodes[k + 1]
        s.add(structures.Frame(*part, density=MASS / 0.1, **numbers))
    s.support(nodes[0], ux=ground(da.t), uy=0.0, rz=0.0)
    if tuned:
        mass = s.node("mass", 1.0, HEIGHT)
        s.add(structures.AxialSpring("spring", nodes[-1], mass, stiffness=stiffness))
        s.add(structures.PointMass("tuned", mass, mass=TUNED))
        s.support(mass, uy=0.0)
    return s


def sway(model) -> da.Expression:
    """Displacement of the top against the ground [m]."""
    return model[f"n{PARTS}.ux"] - model["n0.ux"]


def run(model, **parameters: float):
    """The motion, and the responses on it."""
    damping = da.Rayleigh(stiffness=2 * DAMPING / OMEGA)
    motion = da.solve_transient(model, DURATION, step=STEP, damping=damping, parameters=parameters)
    across = sway(motion.model)
    return motion, [da.maximum(across, name="largest"), da.rms(across, name="rms")]


def main(folder=None) -> dict[str, float]:
    bare, responses = run(build(tuned=False).build())
    without = [da.evaluate(bare, r) for r in responses]
    model = build(tuned=True).build()
    motion, responses = run(model)
    values = [da.evaluate(motion, r) for r in responses]
    slopes = da.sensitivity(motion, responses, ["stiffness"], "adjoint").values[:, 0]
    for k, response in enumerate(responses):
        print(
            f"{response.label:8} sway {without[k] * 1e3:.1f} mm, with the tuned mass "
            f"{values[k] * 1e3:.1f} mm; {slopes[k] * 1e6:+.2f} mm per kN/m"
        )
    sweep = np.array([swept(model, k) for k in STIFFNESSES])
    if folder:
        draw(folder, bare, motion, sweep)
    at = int(np.argmin(abs(STIFFNESSES - motion.parameters[0])))
    h = 1e-4 * STIFFNESSES[at]
    around = [rms(model, STIFFNESSES[at] + side * h) for side in (-1, 1)]
    return {
        "without": without[0],
        "with": values[0],
        "slope of rms": sweep[at, 1, 1],
        "difference of rms": (around[1] - around[0]) / (2 * h),
    }


def swept(model, stiffness: float) -> np.ndarray:
    """(2, 2) values of both responses, and their slopes, at a stiffness of the spring."""
    motion, responses = run(model, stiffness=stiffness)
    slopes = da.sensitivity(motion, responses, ["stiffness"], "adjoint").values[:, 0]
    return np.array([[da.evaluate(motion, r) for r in responses], slopes])


def rms(model, stiffness: float) -> float:
    """Root mean square of the sway at a stiffness of the spring [m]."""
    motion, responses = run(model, stiffness=stiffness)
    return da.evaluate(motion, responses[1])


def draw(folder, bare, motion, sweep) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.6))
    left.plot(bare.time, 1e3 * bare.values(sway(bare.model)), color=style.GREY, label="bare tower")
    found = 1e3 * motion.values(sway(motion.model))
    left.plot(motion.time, found, color=style.BLUE, label="with tuned mass")
    left.set(title="sway of the top [mm]", xlabel="time [s]")
    left.legend()
    width = 0.3 * (STIFFNESSES[1] - STIFFNESSES[0])
    for k, (name, colour) in enumerate((("largest", style.ORANGE), ("rms", style.BLUE))):
        right.plot(STIFFNESSES / 1e3, 1e3 * sweep[:, 0, k], ".", color=colour, label=name)
        for x, y, slope in zip(STIFFNESSES, sweep[:, 0, k], sweep[:, 1, k], strict=True):
            ends = np.array([-1.2, 1.2]) * width
            right.plot((x + ends) / 1e3, 1e3 * (y + slope * ends), color=colour, lw=1.2)
    right.set(title="sway [mm] with its gradients", xlabel="stiffness of the spring [kN/m]")
    right.legend()
    style.save(figure, folder, "tuned_mass")


if __name__ == "__main__":
    main(*sys.argv[1:])
