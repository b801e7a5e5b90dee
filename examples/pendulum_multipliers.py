"""Book example 4.4: a pendulum with three forms of its constraint and two kinds of multipliers.

``√(x² + y²) − l`` is the prohibited displacement: its multiplier is the tension in newtons, the
same as that of a ``RigidLink``. ``x² + y² − l²`` has the same motion, but its multiplier λ/(2l), in
newtons per metre, is not a force.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

LENGTH, MASS, G, START = 0.8, 1.5, 9.81, 1.2


def build(form: str) -> da.System:
    system = da.System(f"pendulum {form}", gravity=(0.0, -G))
    place = (LENGTH * np.sin(START), -LENGTH * np.cos(START))
    bob = system.add(planar.Particle("bob", mass=MASS, position=place, velocity=(0, 0)))
    square = bob.x**2 + bob.y**2
    if form == "link":
        link = planar.RigidLink("thread", system.ground.center, bob.center, length=LENGTH)
    elif form == "physical":
        link = planar.UserConstraint("thread", da.sqrt(square) - LENGTH)
    else:
        link = planar.UserConstraint("thread", square - LENGTH**2)
    system.add(link)
    return system


def tension(height) -> np.ndarray:
    """``m g cos α + m v²/l`` with the speed from the energy; height of the bob below the pin."""
    cosine = -np.asarray(height) / LENGTH
    return MASS * G * (3 * cosine - 2 * np.cos(START))


def main(folder=None) -> dict[str, float]:
    motions = {
        form: da.solve_dynamics(build(form).build(), 2.0, step=0.002)
        for form in ("link", "physical", "squared")
    }
    multiplier = {form: run.data.multiplier.values[:, 0] for form, run in motions.items()}
    exact = tension(motions["link"]["bob.y"])
    numbers = {
        "largest tension [N]": float(multiplier["link"].max()),
        "error of the tension [N]": float(abs(multiplier["link"] - exact).max()),
        "link against user constraint [N]": float(
            abs(multiplier["link"] - multiplier["physical"]).max()
        ),
        "squared: ratio of the multipliers [1/m]": float(
            np.median(multiplier["squared"] / multiplier["physical"])
        ),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), width_ratios=(1, 1.6))
        for time in (0.0, 0.2, 0.4, 0.5):
            style.draw(left, motions["link"], time, alpha=0.35 + time)
        left.set(xlabel="x [m]", ylabel="y [m]", title="pendulum")
        time = motions["link"].time
        right.plot(time, multiplier["link"], label="λ of RigidLink [N]")
        right.plot(time[::25], multiplier["physical"][::25], "o", ms=4, mfc="none")
        right.lines[-1].set_label("λ of √(x² + y²) − l [N]")
        right.plot(time, multiplier["squared"], label="λ of x² + y² − l² [N/m]")
        right.set(xlabel="time [s]", title="multipliers", ylim=(0, 45))
        right.legend(loc="upper right", ncols=3, fontsize=8)
        style.save(figure, folder, "pendulum_multipliers")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
