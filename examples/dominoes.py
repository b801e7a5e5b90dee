"""A row of dominoes: speed of the wave beside the theory of van Leeuwen, by spacing and friction.

Dominoes turn about their front edges, which friction holds, and lean on each other after inelastic
impacts. For smooth faces the row has one freedom between impacts (J. M. J. van Leeuwen, The domino
effect, Am. J. Phys. 78, 721, 2010, arXiv:physics/0401018), so that speeds follow from its energy.
Friction between dominoes slows the wave.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

HEIGHT, THICK, MASS, G = 0.048, 0.0075, 0.01, 9.81
INERTIA = MASS * (HEIGHT**2 + THICK**2) / 12
SPACING, PUSH, FLOOR, ROUGH = 0.0085, 12.0, 2.0, 0.2
"""Distance between dominoes [m], angular velocity of the first one [rad/s], friction on the floor,
friction of rough dominoes."""
SPACINGS = (0.15, 0.25, 0.4, 0.6)
"""Distances over the height."""


def build(count: int = 8) -> da.System:
    system = da.System("dominoes", gravity=(0.0, -G))
    spacing = system.parameter("spacing", SPACING, "m", bounds=(2e-3, 0.04))
    push = system.parameter("push", PUSH, "rad/s", bounds=(8.0, 16.0))
    friction = system.parameter("friction", 0.0, bounds=(0.0, 0.4))
    shapes = []
    for k in range(count):
        place = {"position": (k * (spacing + THICK), HEIGHT / 2), "angle": 0.0}
        if not k:  # turns about its front edge
            place["velocity"] = (push * HEIGHT / 2, push * THICK / 2)
            place["angular_velocity"] = -push
        domino = system.add(planar.Body(f"domino{k}", mass=MASS, inertia=INERTIA, **place))
        shapes.append(planar.contact.Rectangle(domino, (THICK, HEIGHT)))
    groups = {"dominoes": shapes, "floor": [planar.contact.HalfPlane(system.ground)]}
    rough = planar.contact.Pair(("dominoes", "floor"), friction=FLOOR)
    system.add(planar.Collisions("contacts", groups, friction=friction, pairs=[rough]))
    return system


def row(front: np.ndarray, count: int, pitch: float) -> tuple[np.ndarray, np.ndarray]:
    """Tilts of dominoes that lean on each other, from the front one on, and their rates over
    that of the front one."""
    tilts, rates = [front], [np.ones_like(front)]
    for _ in range(count - 1):
        tilts.append(tilts[-1] + np.arcsin((pitch * np.cos(tilts[-1]) - THICK) / HEIGHT))
        lever = HEIGHT * np.cos(tilts[-1] - tilts[-2])
        rates.append(rates[-1] * (1 - pitch * np.sin(tilts[-2]) / lever))
    return np.array(tilts), np.array(rates)


def theory(spacing: float, count: int) -> np.ndarray:
    """Times at which smooth dominoes have turned half-way to the next one [s] (van Leeuwen)."""
    points, weights = np.polynomial.legendre.leggauss(20)
    pitch, hit = spacing + THICK, math.asin(spacing / HEIGHT)
    edge = INERTIA + MASS * (HEIGHT**2 + THICK**2) / 4  # inertia about an edge
    times, time, before = [], 0.0, PUSH

    def lift(tilts: np.ndarray) -> np.ndarray:
        return MASS * G / 2 * (HEIGHT * np.cos(tilts) + THICK * np.sin(tilts)).sum(axis=0)

    for n in range(1, count + 1):
        tilts, rates = row(np.zeros(1), n, pitch)
        share = (rates**2).sum()
        after = before * (share - 1) / share if n > 1 else PUSH
        energy = edge * share * after**2 / 2 + lift(tilts)

        def rate(front: np.ndarray, n=n, energy=energy) -> np.ndarray:
            tilts, rates = row(front, n, pitch)
            return np.sqrt(2 * (energy - lift(tilts)) / (edge * (rates**2).sum(axis=0)))

        half, whole = (
            angle / 2 * weights @ (1 / rate(angle / 2 * (1 + points))) for angle in (hit / 2, hit)
        )
        times.append(time + half)
        time, before = time + whole, rate(np.array([hit])).item()
    return np.array(times)


def wave(model: da.Model, spacing: float, friction: float, count: int) -> da.Motion:
    """Run until the last domino has turned half-way."""
    start = {"spacing": spacing, "friction": friction}
    duration = 1.05 * theory(spacing, count)[-1] * (1 + 2 * friction)
    return da.solve_nonsmooth(model, float(duration), step=1e-3, parameters=start)


def passing(motion: da.Motion, spacing: float, count: int) -> np.ndarray:
    """Times at which dominoes have turned half-way to the next one [s]."""
    half = math.asin(spacing / HEIGHT) / 2
    times = []
    for k in range(count):
        tilt = -motion.values(f"domino{k}.angle")
        after = int(np.argmax(tilt > half))
        times.append(
            np.interp(half, tilt[after - 1 : after + 1], motion.time[after - 1 : after + 1])
        )
    return np.array(times)


def speed(times: np.ndarray, spacing: float) -> float:
    """Speed of the wave at the end of the row [m/s]."""
    return (spacing + THICK) / (times[-1] - times[-2])


def picture(motion: da.Motion, numbers: dict[str, float], count: int, spacings, folder) -> None:
    """The row on its way, and the speeds by spacing."""
    figure = plt.figure(figsize=(10, 3.2))
    panels = figure.subplot_mosaic([["early", "speed"], ["late", "speed"]], width_ratios=(1.6, 1))
    right = panels["speed"]
    for name, share in (("early", 0.6), ("late", 0.95)):
        ax, time = panels[name], share * motion.time[-1]
        style.draw(ax, motion, time)
        ax.set(title=f"t = {time:.2f} s", ylim=(-0.01, 0.08), ylabel="y [m]")
        ax.set_aspect("equal", adjustable="box")
        ax.grid(False)
    ax.set(xlabel="x [m]")
    shares, unit = np.linspace(0.08, 0.75, 25), math.sqrt(G * HEIGHT)
    for dominoes, colour in ((count, style.BLUE), (60, style.GREY)):
        speeds = [speed(theory(share * HEIGHT, dominoes), share * HEIGHT) for share in shares]
        right.plot(shares, np.array(speeds) / unit, color=colour, label=f"theory, {dominoes}")
    for kind, mark in (("smooth", "o"), ("rough", "s")):
        speeds = [numbers[f"{kind}, spacing {share} [m/s]"] / unit for share in spacings]
        right.plot(spacings, speeds, mark, mfc="none", label=f"{kind}, {count}")
    right.set(title="speed over √(g h)", xlabel="spacing over height", ylim=(0, None))
    right.legend(title="number of dominoes")
    style.save(figure, folder, "dominoes")


def main(folder=None, count: int = 16, spacings=SPACINGS) -> dict[str, float]:
    """Speeds of the wave at the end of rows of so many dominoes."""
    model, numbers = build(count).build(), {}
    for share in spacings:
        spacing = share * HEIGHT
        smooth, rough = (wave(model, spacing, friction, count) for friction in (0.0, ROUGH))
        times = {
            "smooth": passing(smooth, spacing, count),
            "rough": passing(rough, spacing, count),
            "theory": theory(spacing, count),
        }
        for kind, instants in times.items():
            numbers[f"{kind}, spacing {share} [m/s]"] = speed(instants, spacing)
    for name, value in numbers.items():
        print(f"{name:32s} {value:.4f}")
    if folder:
        picture(smooth, numbers, count, spacings, folder)
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
