"""A hundred discs fall into a box: hundreds of contacts without penetration.

Nonsmooth steps keep every gap nonnegative to round-off, and contacts only dissipate energy.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

WIDTH, LARGEST = 1.2, 0.05


def model(count: int = 100) -> da.Model:
    """Discs in rows above the floor of a box, of different sizes and with some speed."""
    rng = np.random.default_rng(1)
    system = da.System("discs in a box", gravity=(0.0, -9.81))
    columns, balls = int(WIDTH / (2.4 * LARGEST)), []
    for k in range(count):
        radius = LARGEST * (0.8 + 0.2 * rng.random())
        mass = 10.0 * np.pi * radius**2
        across = (k % columns + 0.5) / columns * WIDTH - WIDTH / 2
        disc = planar.Body(
            f"disc_{k}",
            mass=mass,
            inertia=mass * radius**2 / 2,
            position=(across + 0.005 * rng.random(), 2.1 * LARGEST * (k // columns + 1)),
            angle=0.0,
            velocity=tuple(0.3 * rng.normal(size=2)),
        )
        balls.append(planar.contact.Circle(system.add(disc), radius))
    left, right = (system.ground.point(x, 0.0) for x in (-WIDTH / 2, WIDTH / 2))
    walls = [
        planar.contact.HalfPlane(left, (0.0, 1.0)),
        planar.contact.HalfPlane(left, (1.0, 0.0)),
        planar.contact.HalfPlane(right, (-1.0, 0.0)),
    ]
    system.add(planar.Collisions("contacts", [*balls, *walls], restitution=0.4, friction=0.3))
    return system.build()


def solve(count: int = 100, duration: float = 1.0, step: float = 4e-3):
    return da.solve_nonsmooth(model(count), duration, step=step)


def picture(motion, folder) -> None:
    """Where the discs are, and what becomes of their energy."""
    figure, (first, last, energy) = plt.subplots(1, 3, figsize=(11, 3.8))
    element = motion.model.parts.elements["contacts"]
    radii = [float(ball.radius.sx) for ball in element.balls]
    times = motion.time[-1] / 4, motion.time[-1]
    for ax, time in zip((first, last), times, strict=True):
        at = motion.data.sel(time=time, method="nearest")
        for k, ((x, y), angle) in enumerate(
            zip(at["position"].values, at["angle"].values, strict=True)
        ):
            colour = style.COLOURS[k % len(style.COLOURS)]
            ax.add_patch(plt.Circle((x, y), radii[k], fc=colour, ec="white", lw=0.4, alpha=0.85))
            rim = radii[k] * np.array([np.cos(angle), np.sin(angle)])
            ax.plot([x, x + rim[0]], [y, y + rim[1]], color="white", lw=0.8)
        ax.plot([-WIDTH / 2, -WIDTH / 2, WIDTH / 2, WIDTH / 2], [1.2, 0, 0, 1.2], color="0.3")
        ax.set(aspect="equal", title=f"t = {time:.2f} s", xlabel="x [m]", ylabel="y [m]")
        ax.grid(False)
    data = motion.data
    energy.plot(motion.time, data["energy"], label="energy")
    energy.plot(motion.time, data["kinetic_energy"], label="kinetic")
    energy.plot(motion.time, data["dissipated_energy"], label="taken by contacts")
    energy.set(xlabel="t [s]", ylabel="[J]", title="Contacts take energy, they create none")
    energy.legend()
    style.save(figure, folder, "discs_in_a_box")


def main(folder=None, count: int = 100) -> dict[str, float]:
    """Draw the fall of so many discs; returns how deep any went and what energy did."""
    motion = solve(count)
    print(motion)
    energy = motion.data["energy"].values
    found = {
        "deepest penetration [radii]": float(motion.data["penetration"].max()) / LARGEST,
        "largest gain of energy [share]": float(np.diff(energy).max()) / energy[0],
        "energy left [share]": float(energy[-1] / energy[0]),
        "maximum active contacts": float(motion.statistics["maximum active contacts"]),
        "finished": float(motion.status.success),
    }
    for name, value in found.items():
        print(f"{name:32s} {value:.3g}")
    if folder:
        picture(motion, folder)
    return found


if __name__ == "__main__":
    main(*sys.argv[1:])
