"""Balancing of a four-bar: counterweights cancel its shaking force but increase its shaking moment.

By Berkof and Lowen (1969) counterweights on crank and rocker can cancel the whole shaking force: a
uniform coupler is equivalent to half its mass at each pin, and each weight balances its link with
that half. Minimising the shaking force yields these weights. The shaking moment increases; a second
optimisation accepts some force for a smaller moment.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

CRANK, COUPLER, ROCKER, BASE = 0.1, 0.4, 0.3, 0.4
MASSES = {"crank": 1.0, "coupler": 3.0, "rocker": 2.0}
SPEED = 20.0
ARMS = {"crank": 0.08, "rocker": 0.12}


def build() -> da.System:
    system = da.System("balanced four-bar")
    lengths = {"crank": CRANK, "coupler": COUPLER, "rocker": ROCKER}
    angles = {"crank": 0.6, "coupler": 0.5, "rocker": 1.3}
    bars = {
        name: system.add(
            planar.Bar(name, length=lengths[name], mass=MASSES[name], angle=angles[name])
        )
        for name in lengths
    }
    system.add(planar.Revolute("O1", system.ground.point(0, 0), bars["crank"].start))
    system.add(planar.Revolute("A", bars["crank"].end, bars["coupler"].start))
    system.add(planar.Revolute("B", bars["coupler"].end, bars["rocker"].end))
    system.add(planar.Revolute("O2", system.ground.point(BASE, 0), bars["rocker"].start))
    for name, arm in ARMS.items():
        mass = system.parameter(f"weight_{name}", 0.01, "kg", bounds=(0.0, 12.0))
        weight = system.add(planar.Particle(f"{name}_weight", mass=mass))
        place = bars[name].point(-lengths[name] / 2 - arm, 0)
        system.add(planar.Revolute(f"{name}_bolt", place, weight.center))
    motor = planar.RotationalDriver("motor", system.ground, bars["crank"], 0.6 + SPEED * da.t)
    system.add(motor)
    return system


FORCE = "sqrt((O1.force.x + O2.force.x)**2 + (O1.force.y + O2.force.y)**2)"
MOMENT = f"motor.effort + {BASE}*O2.force.y"


def balanced_masses() -> dict[str, float]:
    """Of Berkof and Lowen: ``m r = m_link l/2 + m_coupler l/2`` [kg]."""
    half = MASSES["coupler"] / 2
    lengths = {"crank": CRANK, "rocker": ROCKER}
    return {n: (MASSES[n] / 2 + half) * lengths[n] / ARMS[n] for n in ARMS}


def main(folder=None) -> dict[str, float]:
    model = build().build()
    turn = da.InverseDynamics(duration=2 * math.pi / SPEED, outputs=181)
    force = da.mean("(O1.force.x + O2.force.x)**2 + (O1.force.y + O2.force.y)**2", name="force²")
    moment = da.rms(MOMENT, name="shaking moment")
    still = da.optimize(model, force, analysis=turn, tolerance=1e-14)
    before = da.evaluate(still.initial, force)
    compromise = da.optimize(
        model, moment, subject_to=[da.Limit(force, upper=0.25 * before)], analysis=turn
    )
    numbers = {}
    for name, motion in (
        ("before", still.initial),
        ("without force", still.motion),
        ("half the force", compromise.motion),
    ):
        numbers[f"force {name} [N]"] = math.sqrt(max(da.evaluate(motion, force), 0.0))
        numbers[f"moment {name} [N m]"] = da.evaluate(motion, moment)
        numbers[f"torque {name} [N m]"] = da.evaluate(motion, da.rms("motor.effort"))
    numbers |= {f"mass on the {n} [kg]": still.x[f"weight_{n}"] for n in ARMS}
    print(*(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    if folder:
        picture(folder, still, compromise)
    return numbers


def picture(folder, still: da.OptimizationResult, compromise: da.OptimizationResult) -> None:
    figure, axes = plt.subplots(1, 3, figsize=(11, 3.6))
    style.draw(axes[0], still.motion, 0.0)
    for name in ARMS:
        at = [still.motion[f"{name}_weight.{a}"].values[0] for a in "xy"]
        axes[0].plot(*at, "o", ms=16, color=style.GREY, zorder=6)
    axes[0].set(title="weights that take the force", xlabel="x [m]", ylabel="y [m]")
    shown = (
        ("no weights", still.initial, style.GREY),
        ("no shaking force", still.motion, style.BLUE),
        ("half the force", compromise.motion, style.ORANGE),
    )
    for label, motion, colour in shown:
        x, y = (-(motion[f"O1.force.{a}"] + motion[f"O2.force.{a}"]) for a in "xy")
        dot = {"marker": "o"} if label == "no shaking force" else {}
        axes[1].plot(x, y, color=colour, label=label, **dot)
        wide = 4 if label == "no weights" else 1.6
        axes[2].plot(np.degrees(SPEED * motion.time), motion[MOMENT], color=colour, lw=wide)
    axes[1].set(title="shaking force [N]", aspect="equal")
    axes[1].legend(fontsize=8)
    axes[2].set(title="shaking moment [N m]", xlabel="crank turned [deg]", xticks=range(0, 361, 90))
    style.save(figure, folder, "four_bar_balancing")


if __name__ == "__main__":
    main(*sys.argv[1:])
