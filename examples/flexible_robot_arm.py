"""A light robot arm with two flexible links: residual vibration of its tip after a fast move.

Both joints follow motion laws that end at rest; a rigid arm would then be at rest. The links are
tubes that vibrate in bending, damped by their material.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import laws, planar
from dalembert.structures import Material, tube

MOVE, AFTER = 0.6, 0.6
UPPER, FORE = 0.9, 0.8


def build() -> da.System:
    system = da.System("robot arm", gravity=(0.0, 0.0))
    wall = system.parameter("wall", 0.0015, "m", bounds=(0.0005, 0.005))
    section = tube(0.025, wall).planar_beam(Material(70e9, 0.33, 2700.0))
    move = system.parameter("move", MOVE, "s", bounds=(0.3, 1.0))
    upper = system.add(
        planar.Beam(
            "upper", length=UPPER, position=(0, 0), angle=0.0, damping=2e-4, elements=2, **section
        )
    )
    fore = system.add(
        planar.Beam(
            "fore", length=FORE, position=(UPPER, 0), angle=0.0, damping=2e-4, elements=2, **section
        )
    )
    tool = system.add(planar.Body("tool", mass=0.5, inertia=1e-3, position=(UPPER + FORE, 0)))
    system.add(planar.Revolute("shoulder", system.ground.center, upper.start.center))
    system.add(planar.Revolute("elbow", upper.end.center, fore.start.center))
    system.add(planar.Weld("wrist", fore.end.center, tool.center))
    turns = (
        ("shoulder_motor", system.ground, upper.start, 1.2),
        ("elbow_motor", upper.end, fore.start, -0.8),
    )
    for name, first, second, angle in turns:
        law = laws.Polynomial4567Rise(height=angle, duration=move)
        system.add(planar.RotationalDriver(name, first, second, law))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    motion = da.solve_dynamics(
        model, MOVE + AFTER, step=5e-4, outputs=481, integrator=da.HHT(alpha=0.05)
    )
    x = UPPER * np.cos(1.2) + FORE * np.cos(0.4)
    y = UPPER * np.sin(1.2) + FORE * np.sin(0.4)
    off = np.hypot(motion["tool.x"].values - x, motion["tool.y"].values - y)
    late = motion.time >= MOVE
    ring = da.at(MOVE, (model["tool.x"] - x) ** 2 + (model["tool.y"] - y) ** 2)
    slope = da.sensitivity(motion, ring).sel(parameter="wall").item()
    peaks = np.flatnonzero((off[1:-1] > off[:-2]) & (off[1:-1] > off[2:]) & late[1:-1]) + 1
    half = np.diff(motion.time[peaks]).mean()  # the distance has a peak on either side
    numbers = {"swing": float(off[late].max()), "slope": float(slope), "ring": 0.5 / float(half)}
    print(
        f"after the move the tool swings by {1e3 * numbers['swing']:.2f} mm at "
        f"{numbers['ring']:.2f} Hz; the square of its "
        f"error at the stop changes by {slope:.3g} m²/m with the wall"
    )
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6))
        nodes = [b.name for b in model.bodies if b.name.startswith(("upper", "fore"))]
        order = [f"upper.{n}" for n in ("start", *(f"node{k}" for k in range(1, 6)), "end")]
        order += [f"fore.{n}" for n in ("start", *(f"node{k}" for k in range(1, 6)), "end")]
        assert set(order) == set(nodes)
        for share in np.linspace(0, 1, 9):
            k = int(share * np.flatnonzero(late)[0])
            xs, ys = ([float(motion[f"{n}.{q}"].values[k]) for n in order] for q in "xy")
            left.plot(xs, ys, color=style.BLUE, alpha=0.2 + 0.8 * share)
        left.plot(motion["tool.x"].values, motion["tool.y"].values, color=style.ORANGE, lw=1)
        left.set(title="the move", xlabel="x [m]", ylabel="y [m]", aspect="equal")
        right.plot(motion.time, 1e3 * np.where(late, off, np.nan))
        right.set(title="tool off its place after the stop [mm]", xlabel="t [s]")
        style.save(figure, folder, "flexible_robot_arm")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
