"""A tippe top turns over: friction of its sliding contact lifts the mass centre of a spinning ball.

The mass centre of the ball is below its middle at the start. Friction proportional to the slip, as
in the literature (Rauch-Wojciechowski and Rutstam, SIGMA 10, 2014, 017), takes energy out but not
Jellett's constant ``λ = −L·a``, with the arm a from the mass centre to the contact. Therefore the
spin after turning over is known in advance, and the top ends at the tilt of minimum energy for its
λ. Below a threshold of λ this is not the inverted position.
"""

import math
import sys

import numpy as np
import style

import dalembert as da
from dalembert import spatial

RADIUS, MASS, OFFSET, SPIN, TILT, G = 0.02, 0.02, 0.3, 155.0, 0.1, 9.82
AXIAL, ACROSS = 2 / 5 * MASS * RADIUS**2, 131 / 350 * MASS * RADIUS**2
SLOW = 60.0
"""Spin of a top that does not turn over completely [rad/s]."""


def build() -> da.System:
    system = da.System("tippe top", gravity=(0.0, 0.0, -G))
    radius = system.parameter("radius", RADIUS, "m")
    mass = system.parameter("mass", MASS, "kg")
    offset = system.parameter("offset", OFFSET, bounds=(0.1, 0.5))
    friction = system.parameter("friction", 0.3, "s/m", bounds=(0.1, 0.5))
    stiffness = system.parameter("stiffness", 1e4, "N/m")
    spin = system.parameter("spin", SPIN, "rad/s", bounds=(20, 200))
    tilt = system.parameter("tilt", TILT, "rad")
    across, axial = 131 / 350 * mass * radius**2, 2 / 5 * mass * radius**2
    top = spatial.Sphere(
        "top",
        mass=mass,
        radius=radius,
        center_of_mass=(0, 0, -offset * radius),
        inertia=(across, across, axial),
        position=(0, 0, radius - G * mass / stiffness),
        rotation=da.rotation.axis_angle((0, 1, 0), tilt),
        velocity=(0, 0, 0),
        angular_velocity=(spin * da.sin(tilt), 0, spin * da.cos(tilt)),
        points={"middle": (0, 0, 0), "stem": (0, 0, radius)},
    )
    system.add(top)
    kit = spatial.contact
    system.add(
        spatial.Contact(
            "table",
            kit.HalfSpace(system.ground.frame(axis=(0, 0, 1))),
            kit.Sphere(top.point("middle"), radius),
            law=kit.KelvinVoigt(stiffness=stiffness, damping=2.0),
            friction=kit.Stribeck(0.0, viscous=friction),
        )
    )
    return system


def run(model: da.Model, spin: float, time: float) -> da.Motion:
    accurate, outputs = da.DormandPrince853(1e-7, 1e-9), round(400 * time) + 1
    start = {"spin": spin}
    return da.solve_dynamics(model, time, outputs=outputs, integrator=accurate, parameters=start)


def axis(motion: da.Motion) -> np.ndarray:
    """(outputs, 3) direction from the middle to the stem."""
    return (motion["top.stem.position"].values - motion["top.position"].values) / RADIUS


def tilt(motion: da.Motion) -> np.ndarray:
    return np.arccos(np.clip(axis(motion)[:, 2], -1, 1))


def jellett(motion: da.Motion) -> np.ndarray:
    turn, along = motion["top.angular_velocity"].values, axis(motion)
    momentum = ACROSS * turn + (AXIAL - ACROSS) * (turn * along).sum(1, keepdims=True) * along
    arm = RADIUS * (OFFSET * along - (0, 0, 1))
    return -(momentum * arm).sum(1)


def threshold() -> float:
    """Jellett's constant above which the inverted top is stable ."""
    narrow = 1 + OFFSET - ACROSS / AXIAL
    return math.sqrt(MASS * G * RADIUS**3 * AXIAL * OFFSET / narrow) * (1 + OFFSET) ** 2


def lowest(constant: float) -> float:
    """Tilt of minimum energy for a value of Jellett's constant [rad]."""
    angles = np.linspace(0, math.pi, 100_001)
    lever = ACROSS * np.sin(angles) ** 2 + AXIAL * (OFFSET - np.cos(angles)) ** 2
    height = RADIUS * (1 - OFFSET * np.cos(angles))
    return float(angles[np.argmin(MASS * G * height + constant**2 / (2 * RADIUS**2 * lever))])


def main(folder=None) -> dict[str, float]:
    model = build().build()
    fast, slow = run(model, SPIN, 7.0), run(model, SLOW, 11.0)
    constant = jellett(fast)
    numbers = {
        "tilt at the end [deg]": math.degrees(tilt(fast)[-1]),
        "spin at the end [rad/s]": float(fast["top.angular_velocity"].values[-1, 2]),
        "spin by Jellett's constant [rad/s]": constant[0] / (RADIUS * (1 + OFFSET) * AXIAL),
        "change of Jellett's constant [share]": float(np.abs(constant / constant[0] - 1).max()),
        "Jellett's constant over threshold": constant[0] / threshold(),
        "the same for the slow top": jellett(slow)[0] / threshold(),
        "its tilt at the end [deg]": math.degrees(tilt(slow)[-1]),
        "its tilt of minimum energy [deg]": math.degrees(lowest(jellett(slow)[0])),
        "dissipated energy [mJ]": 1e3 * float(fast["dissipated_energy"].values[-1]),
    }
    print(*(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, left, right = style.beside()
        left.plot(*axis(fast).T, color=style.PINK, lw=0.7)
        left.set(title="path of the stem around the ball", xlabel="", ylabel="", zlabel="")
        left.set_aspect("equal")
        for motion, label in ((fast, f"{SPIN:.0f} rad/s"), (slow, f"{SLOW:.0f} rad/s")):
            right.plot(motion.time, np.degrees(tilt(motion)), label=label)
        right.set(title="tilt of the axis [°]", xlabel="t [s]", yticks=range(0, 181, 45))
        right.legend()
        style.save(figure, folder, "tippe_top")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
