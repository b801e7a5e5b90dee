"""A roller chain on two sprockets: speed ratio, strand tensions, polygon effect.

Every link is a body; the sprockets have 9 and 14 teeth, and every roller may touch every tooth. The
motor has constant speed. The mean speed of the driven sprocket follows from the ratio of teeth, and
the tensions of the strands differ by the load. A link that enters a sprocket of z teeth moves along
the strand with ``ω R cos θ``, ``|θ| ≤ π/z``, so the speed of the chain varies by ``1 − cos(π/z)``.
"""

import math
import sys
from functools import cache

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

PITCH, ROLLER, LINKS, TEETH = 12.7e-3, 7.92e-3, 24, (9, 14)
NAMES, SPEED, LOAD, MASS, INERTIA = ("driver", "driven"), 20.0, 3.0, 0.009, 5e-4
SAG, BENDING, RAMP, END = 4e-3, 1e-4, 0.03, 0.5
RADII = tuple(PITCH / (2 * math.sin(math.pi / z)) for z in TEETH)


def path(apart: float) -> tuple[np.ndarray, float]:
    """(links, 2) pins on both pitch circles, a straight strand and one that sags; how far the last
    link goes past the first pin. Clockwise, from the middle of the left wheel's arc."""
    lean = math.asin((RADII[1] - RADII[0]) / apart)  # of the tangents
    straight = apart * math.cos(lean)
    arcs = RADII[0] * (math.pi - 2 * lean), RADII[1] * (math.pi + 2 * lean)
    ends = np.cumsum([arcs[0] / 2, straight, arcs[1], straight, arcs[0] / 2])

    def place(s: float) -> np.ndarray:
        up = np.array([-math.sin(lean), math.cos(lean)])
        if s < ends[0] or s >= ends[3]:
            angle = math.pi - (s if s < ends[0] else s - ends[4]) / RADII[0]
            return RADII[0] * np.array([math.cos(angle), math.sin(angle)])
        if s < ends[1]:
            along = np.array([math.cos(lean), math.sin(lean)])
            return RADII[0] * up + (s - ends[0]) * along
        if s < ends[2]:
            angle = math.pi / 2 + lean - (s - ends[1]) / RADII[1]
            return np.array([apart, 0]) + RADII[1] * np.array([math.cos(angle), math.sin(angle)])
        along = np.array([-math.cos(lean), math.sin(lean)])
        down, share = up * [1, -1], (s - ends[2]) / straight
        hangs = RADII[1] + 4 * SAG * share * (1 - share)
        return np.array([apart, 0]) + hangs * down + (s - ends[2]) * along

    def next_after(s: float) -> float:
        here, low, high = place(s % ends[4]), s, s + 1.2 * PITCH
        for _ in range(60):
            middle = (low + high) / 2
            short = math.dist(place(middle % ends[4]), here) < PITCH
            low, high = (middle, high) if short else (low, middle)
        return low

    stations = [0.0]
    for _ in range(LINKS):
        stations.append(next_after(stations[-1]))
    return np.array([place(s % ends[4]) for s in stations[:-1]]), stations[-1] - ends[4]


@cache
def distance() -> float:
    """Of the axes, so that the chain closes."""
    low, high = 0.6 * LINKS / 2 * PITCH * 0.5, LINKS / 2 * PITCH
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if path(middle)[1] > 0 else (low, middle)
    return low


def build() -> da.System:
    apart = distance()
    pins, _ = path(apart)
    system = da.System("chain drive", gravity=(0.0, -9.81))
    speed = system.parameter("speed", SPEED, "rad/s")
    load = system.parameter("load", LOAD, "N m", bounds=(0.5, 10.0))
    links = []
    for k, (here, there) in enumerate(zip(pins, np.roll(pins, -1, axis=0), strict=True)):
        lean = math.atan2(*(there - here)[::-1])
        middle = tuple((here + there) / 2)
        link = planar.Bar(f"link{k}", length=PITCH, mass=MASS, position=middle, angle=lean)
        links.append(system.add(link))
    for k, link in enumerate(links):
        system.add(planar.Revolute(f"pin{k}", links[k - 1].end, link.start))
        bend = {"stiffness": 0.0, "damping": BENDING}
        system.add(planar.TorsionSpring(f"bend{k}", links[k - 1], link, **bend))
    law = speed * (da.t + RAMP * (da.exp(-da.t / RAMP) - 1))
    press = planar.contact.KelvinVoigt(stiffness=2e6, damping=400.0)
    for name, x, teeth, radius in zip(NAMES, (0.0, apart), TEETH, RADII, strict=True):
        off = pins - (x, 0.0)
        seat = off[np.argmin(np.abs(np.linalg.norm(off, axis=1) - radius))]
        angle = math.atan2(seat[1], seat[0])
        wheel = planar.Body(name, mass=0.5, inertia=INERTIA, position=(x, 0), angle=angle)
        system.add(wheel)
        system.add(planar.Revolute(f"axle_{name}", system.ground.point(x, 0), wheel.center))
        if name == "driver":
            system.add(planar.RotationalDriver("motor", system.ground, wheel, angle + law))
        else:
            system.add(planar.Torque("resistance", wheel, -load))
        sprocket = planar.contact.Sprocket(wheel.center, teeth, PITCH, ROLLER)
        for k, link in enumerate(links):
            roller = planar.contact.Circle(link.start, ROLLER / 2)
            system.add(planar.Contact(f"{name}{k}", sprocket, roller, law=press))
    return system


def strands(motion) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Tension of the upper and of the lower strand, speed along the upper one, in their middle."""
    position = np.array([motion[f"link{k}.position"].values for k in range(LINKS)])
    lean = np.array([motion[f"link{k}.angle"].values for k in range(LINKS)])
    velocity = np.array([motion[f"link{k}.velocity"].values for k in range(LINKS)])
    speed = np.abs(velocity[:, :, 0] * np.cos(lean) + velocity[:, :, 1] * np.sin(lean))
    pull = np.array([np.hypot(*motion[f"pin{k}.force"].values.T) for k in range(LINKS)])
    off, when = np.abs(position[:, :, 0] - distance() / 2), np.arange(motion.time.size)
    upper, lower = (
        np.argmin(np.where(side * position[:, :, 1] > 0, off, np.inf), axis=0) for side in (1, -1)
    )
    return pull[upper, when], pull[lower, when], speed[upper, when]


def main(folder=None) -> dict[str, float]:
    model = build().build()
    motion = da.solve_dynamics(model, END, step=2e-5, outputs=2001, backend="jit")
    steady = motion.time > END - 2 * math.pi / SPEED  # one turn of the driver
    driver, driven = (motion[f"{name}.angle"].values[steady] for name in NAMES)
    tight, slack, speed = (each[steady] for each in strands(motion))
    numbers = {
        "ratio": float(np.ptp(driven) / np.ptp(driver)),
        "torque": float(((tight - slack) * RADII[1]).mean()),
        "motor": float(np.abs(motion["motor.moment"].values[steady]).mean()),
        "ripple": float(1 - speed.min() / speed.max()),
    }
    wanted = TEETH[0] / TEETH[1], LOAD, LOAD * TEETH[0] / TEETH[1], 1 - math.cos(math.pi / TEETH[0])
    for (name, value), closed in zip(numbers.items(), wanted, strict=True):
        print(f"{name:<7} {value:.5g}, of rigid links and slow motion {closed:.5g}")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.6), width_ratios=(1.3, 1))
        style.draw(left, motion, END)
        left.set(title="links and sprockets", xlabel="x [m]", ylabel="y [m]", aspect="equal")
        fastest = SPEED * RADII[0]
        right.plot(motion.time[steady], speed, label="tight strand")
        for part in (1.0, math.cos(math.pi / TEETH[0])):
            right.axhline(part * fastest, color=style.GREY, lw=1, ls="--")
        right.set(title="speed of the chain [m/s]", xlabel="t [s]")
        style.save(figure, folder, "chain_drive")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
