"""Discs flow out of a hopper: their rate by the width of the opening, beside Beverloo's law.

The flow of discs of diameter d through an opening of width D hardly depends on the height of the
filling, and grows as ``C √(g/d) (D/d − k)^{3/2}`` discs per second in a plane (Beverloo, Leniger
and van de Velde 1961, with the exponent 5/2 in space). C and k are fitted; the exponent is that of
the rates with this k. A lid leaves the opening when the discs have settled. Gaps penetrate by the
motion of half a step; to correct them would lift the pressed discs in every step, and make them
flow faster.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

RADIUS, SPREAD, DENSITY, G = 0.01, 0.1, 10.0, 9.81
"""Mean radius of the discs [m], its variation, mass per area [kg/m²]."""
WIDTH, STEEP, WALL, TRAY = 16 * RADIUS, math.radians(50), 0.5 * RADIUS, 20 * RADIUS
"""Half the width [m], slope of the funnel, half its thickness, depth of the tray below."""
FRICTION, RESTITUTION, STEP, OPENS = 0.3, 0.3, 1e-3, 0.2
"""Coefficients, step of the integration and time at which the lid leaves [s]."""
OPENINGS = (4.0, 5.0, 6.0, 7.0)
"""Widths of the opening over the mean diameter."""


def build(opening: float, count: int) -> da.System:
    """Discs in rows above a funnel with an opening of so many diameters."""
    rng = np.random.default_rng(1)
    system = da.System("hopper", gravity=(0.0, -G))
    edge = opening * RADIUS
    rise = (WIDTH - edge) * math.tan(STEEP)
    largest, discs, k = (1 + SPREAD) * RADIUS, [], 0
    pitch = 2.04 * largest
    while len(discs) < count:
        level = 1.5 * largest + k * pitch * math.sqrt(3) / 2
        funnel = edge + level / math.tan(STEEP) - 1.02 * largest / math.sin(STEEP)
        half = min(funnel, WIDTH - 1.02 * largest)
        places = pitch * (np.arange(-20, 20) + k % 2 / 2)
        for x in places[np.abs(places) < half][: count - len(discs)]:
            radius = RADIUS * (1 + SPREAD * rng.uniform(-1, 1))
            mass = DENSITY * math.pi * radius**2
            place = {"position": (x, level), "angle": 0.0}
            disc = planar.Body(
                f"disc{len(discs)}", mass=mass, inertia=mass * radius**2 / 2, **place
            )
            discs.append(planar.contact.Circle(system.add(disc), radius))
        k += 1
    kit, ground, normal = planar.contact, system.ground, (math.sin(STEEP), math.cos(STEEP))
    walls = [kit.HalfPlane(ground.point(0.0, -TRAY))]
    for side in (1, -1):
        low, high = (
            ground.point(side * (x + WALL * normal[0]), y - WALL * normal[1])
            for x, y in ((edge, 0.0), (WIDTH, rise))
        )
        walls.append(kit.Capsule(low, high, WALL))
        walls.append(kit.HalfPlane(ground.point(side * WIDTH, 0.0), (-side, 0.0)))
    lid = system.add(planar.Body("lid", mass=1.0, inertia=1e-3, position=(0, 0), angle=0.0))
    guide = system.add(planar.Prismatic("guide", ground.center, lid.center, axis=(0, 1)))
    fall = da.CycloidalRise(height=-1.2 * TRAY, duration=0.2, begin=OPENS)
    system.add(planar.TranslationalDriver("release", guide, fall))
    plate = kit.Rectangle(lid.point(0.0, -RADIUS / 2), (2 * edge, RADIUS))
    shapes = {"discs": discs, "walls": walls, "lid": [plate]}
    apart = kit.Pair(("lid", "walls"), touching=False)
    law = {"friction": FRICTION, "restitution": RESTITUTION, "pairs": [apart]}
    system.add(planar.Collisions("contacts", shapes, **law))
    return system


def solve(opening: float, count: int) -> da.Motion:
    """Flow of about half of the discs."""
    duration = OPENS + 0.15 + 0.6 * count / (math.sqrt(G / (2 * RADIUS)) * opening**1.5)
    model = build(opening, count).build()
    outputs, scheme = round(200 * duration) + 1, da.MoreauJean(projection=False)
    return da.solve_nonsmooth(model, duration, step=STEP, integrator=scheme, outputs=outputs)


def passed(motion: da.Motion, count: int) -> np.ndarray:
    """Number of discs below the opening, by time."""
    return (motion.data["position"].values[:, :count, 1] < -4 * RADIUS).sum(axis=1)


def rate(motion: da.Motion, count: int) -> float:
    """Discs per ``√(d/g)`` while a tenth to a half of them have passed."""
    number = passed(motion, count)
    steady = (number > 0.1 * count) & (number < 0.5 * count)
    per_second = np.polyfit(motion.time[steady], number[steady], 1)[0]
    return float(per_second * math.sqrt(2 * RADIUS / G))


def beverloo(openings, rates) -> tuple[float, float]:
    """Coefficients C and k of ``C (D/d − k)^{3/2}``."""
    slope, start = np.polyfit(openings, np.power(rates, 2 / 3), 1)
    return float(slope**1.5), float(-start / slope)


def picture(motions: dict[float, da.Motion], rates: list[float], count: int, folder) -> None:
    """The hopper, discs that have passed by time, and rates by width."""
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(11, 3.8))
    openings = list(motions)
    motion = motions[openings[-1]]
    style.draw(left, motion, OPENS + 0.3)
    left.set(title=f"D = {openings[-1]} d, t = {OPENS + 0.3:.2f} s", xlabel="x [m]")
    left.set(ylabel="y [m]", xlim=(-1.1 * WIDTH, 1.1 * WIDTH), ylim=(-1.2 * TRAY, 0.35))
    left.set_aspect("equal", adjustable="box")
    left.grid(False)
    for opening, motion in motions.items():
        middle.plot(motion.time, passed(motion, count), label=f"{opening} d")
    middle.set(title="discs that have passed", xlabel="t [s]")
    middle.legend(title="opening")
    factor, offset = beverloo(openings, rates)
    widths = np.linspace(max(offset, 0), openings[-1] + 0.5, 100)
    right.plot(widths, factor * (widths - offset) ** 1.5, color=style.GREY, lw=4, alpha=0.4)
    right.plot(openings, rates, "o")
    right.set(title="discs per √(d/g)", xlabel="D/d", xlim=(0, None), ylim=(0, None))
    style.save(figure, folder, "hopper")


def main(folder=None, count: int = 140, openings=OPENINGS) -> dict[str, float]:
    motions = {opening: solve(opening, count) for opening in openings}
    rates = [rate(motion, count) for motion in motions.values()]
    factor, offset = beverloo(openings, rates)
    widths = np.log(np.array(openings) - max(offset, 0.0))
    numbers = {
        "finished": float(all(motion.status.success for motion in motions.values())),
        **{f"discs per √(d/g), D = {o} d": r for o, r in zip(openings, rates, strict=True)},
        "C of Beverloo's law": factor,
        "k of Beverloo's law": offset,
        "exponent with k, at least 0": float(np.polyfit(widths, np.log(rates), 1)[0]),
        "maximum penetration [d]": max(
            float(motion.data["penetration"].max()) / (2 * RADIUS) for motion in motions.values()
        ),
    }
    for name, value in numbers.items():
        print(f"{name:32s} {value:.4g}")
    if folder:
        picture(motions, rates, count, folder)
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
