"""Pareto front of a plunger pump: smooth motor torque and small bearing load.

The model is the plunger pump of ``smooth_torque`` with its spring. One spring minimises the
variation of the motor torque, another one the load of the crank bearing; the Pareto front between
them is computed. Its slope is the price of torque in bearing load.
"""

import sys

import matplotlib.pyplot as plt
import smooth_torque
import style

import dalembert as da

TORQUE = da.rms("motor.effort", name="motor torque, rms")
LOAD = da.rms("O.force_norm", name="bearing load, rms")


def front(model: da.Model, points: int = 7) -> da.ParetoResult:
    """Springs between the smoothest torque and the smallest bearing load."""
    return da.pareto(
        model,
        [TORQUE, LOAD],
        vary=["k", "free"],
        analysis=da.InverseDynamics(duration=1 / 3, outputs=121),
        points=points,
    )


def main(folder=None) -> dict[str, float]:
    model = smooth_torque.build().build()
    found = front(model)
    nominal = da.solve_inverse_dynamics(model, 1 / 3, outputs=121)
    first = [da.evaluate(nominal, aim) for aim in (TORQUE, LOAD)]
    print(found)
    print(f"at first {first[0]:.3f} N m and {first[1]:.2f} N")
    for (torque, load), design in zip(found.values, found.designs, strict=True):
        spring = ", ".join(f"{n} = {v:.5g}" for n, v in zip(found.names, design, strict=True))
        print(f"{torque:.3f} N m, {load:.2f} N with {spring}")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.8))
        found.plot(left)
        left.set_title("springs of which none is better in both")
        right.plot(*found.designs.T, marker="o", ms=4, color=style.ORANGE)
        right.set(
            title="from the smoothest torque to the least load, upwards",
            xlabel="stiffness [N/m]",
            ylabel="free length [m]",
        )
        style.save(figure, folder, "pump_front")
    return {
        "points": len(found),
        "least torque": found.values[0, 0],
        "least load": found.values[-1, 1],
        "first torque": first[0],
        "first load": first[1],
    }


if __name__ == "__main__":
    main(*sys.argv[1:])
