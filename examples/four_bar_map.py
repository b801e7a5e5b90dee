"""A map of four-bars: 1,600 designs of coupler and rocker in one call.

A crank with a flywheel drives a rocker. If Grashof's rule holds, shortest + longest length ≤ sum of
the others, the crank makes full turns; otherwise it reverses. The map shows the largest force in
the joint of coupler and rocker and, for full turns, the smallest transmission angle, with the
closed form cos μ = [b² + c² − (d ∓ a)²] / (2bc). White designs cannot be assembled, or pass too
close to a change point for these steps.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style
from matplotlib.colors import LogNorm

import dalembert as da
from dalembert import planar

CRANK, GROUND, SPEED = 0.3, 1.0, 20.0
PER_LENGTH = 1.0
"""Mass of coupler and rocker [kg/m]."""
SIZE = 40
COUPLERS, ROCKERS = np.linspace(0.42, 1.39, SIZE), np.linspace(0.41, 1.37, SIZE)


def build() -> da.System:
    system = da.System("four-bar map")
    b = system.parameter("coupler", 1.0, bounds=(0.3, 2.0), unit="m")
    c = system.parameter("rocker", 0.8, bounds=(0.3, 2.0), unit="m")
    crank = system.add(
        planar.Bar(
            "crank", length=CRANK, mass=1.0, inertia=1.0, angle=np.pi / 2, angular_velocity=SPEED
        )
    )
    coupler = system.add(planar.Bar("link", length=b, mass=PER_LENGTH * b))
    rocker = system.add(planar.Bar("lever", length=c, mass=PER_LENGTH * c, angle=1.4))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("C", system.ground.point(GROUND, 0), rocker.start))
    return system


def grashof(b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Whether the crank can go round: it is the shortest link and the rule holds."""
    lengths = np.sort(np.stack(np.broadcast_arrays(CRANK, GROUND, b, c)), axis=0)
    return (lengths[0] == CRANK) & (lengths[0] + lengths[3] <= lengths[1] + lengths[2])


def smallest_angle(b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Smallest angle of coupler and rocker over a turn, between their lines [rad]."""
    spans = np.array([GROUND - CRANK, GROUND + CRANK])
    cosines = (b**2 + c**2 - spans[:, None] ** 2) / (2 * b * c)
    angles = np.arccos(np.clip(cosines, -1, 1))  # of change points they are 1
    return np.minimum(angles, np.pi - angles).min(axis=0)


def main(folder=None) -> dict[str, float]:
    b, c = (grid.ravel() for grid in np.meshgrid(COUPLERS, ROCKERS))
    batch = da.solve_dynamics(
        build().build(), 0.5, step=5e-4, outputs=501, parameters={"coupler": b, "rocker": c}
    )
    print(batch)
    round_and_round = batch.values("crank.angle").max(axis=1) > np.pi / 2 + 2 * np.pi
    turn = batch.values("link.angle") - batch.values("lever.angle")
    angle = np.arcsin(abs(np.sin(turn))).min(axis=1)
    force = da.evaluate(batch, da.maximum("B.force_norm")).values
    good = batch.succeeded & grashof(b, c)
    off = abs(angle[good] - smallest_angle(b[good], c[good]))
    assembled = np.array([s.outcome is not da.Outcome.NOT_ASSEMBLED for s in batch.statuses])
    numbers = {
        "designs": float(len(batch)),
        "assembled": float(assembled.sum()),
        "not finished": float((assembled & ~batch.succeeded).sum()),
        "on the other side of Grashof's line": float(
            (round_and_round != grashof(b, c))[batch.succeeded].sum()
        ),
        "transmission angle off by at most [deg]": float(np.degrees(off.max())),
    }
    print(*(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    if folder:
        draw(force, np.where(good, angle, np.nan), folder)
    return numbers


def draw(force, angle, folder) -> None:
    figure, panels = plt.subplots(1, 2, figsize=(9.5, 4.0))
    fine = np.meshgrid(np.linspace(0.42, 1.39, 400), np.linspace(0.41, 1.37, 400))
    shown = (
        (force, "largest force in the joint [N]", LogNorm(60, 30_000), "viridis_r"),
        (np.degrees(angle), "smallest transmission angle [°]", None, "viridis"),
    )
    for ax, (values, title, norm, colours) in zip(panels, shown, strict=True):
        table = values.reshape(SIZE, SIZE)
        image = ax.pcolormesh(COUPLERS, ROCKERS, table, norm=norm, cmap=colours)
        ax.contour(*fine, grashof(*fine), levels=[0.5], colors=style.ORANGE, linewidths=1.4)
        ax.set(title=title, xlabel="coupler [m]", ylabel="rocker [m]", aspect="equal")
        ax.grid(False)
        figure.colorbar(image, ax=ax)
    panels[0].text(0.43, 1.33, "Grashof's line", color="white")
    style.save(figure, folder, "four_bar_map")


if __name__ == "__main__":
    main(*sys.argv[1:])
