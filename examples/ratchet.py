"""A ratchet jack: a lever swings to and fro, and two pawls let the wheel turn one way only.

The driving pawl on the lever pushes a tooth and lifts the load; on the way back the holding pawl
bears it, while the driving pawl clicks over the next tooth. The lever swings by 1.6 pitches, and
every swing turns the wheel by one whole pitch: the wheel settles back by the rest. Springs press
the pawls on; contact of tips and teeth is compliant, without friction.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

TEETH, OUTER, ROOT, TIP = 12, 0.05, 0.042, 0.0015
"""Number; radii of the teeth and of the tips of the pawls [m]."""
ARM, HIGHER, SPRING, PRESS = 0.035, 0.004, 0.02, 1.0
"""Pivot beside and above the tip [m], so that the load presses it on; spring [N m/rad, rad]."""
PITCH, PERIOD, SWINGS, LOAD = 2 * math.pi / TEETH, 0.5, 3, 0.5
"""[rad], [s], number, moment of the load [N m]."""
BACK, SWING = 0.3 * PITCH, 1.6 * PITCH
"""The lever swings from here backwards, and so far [rad]."""


def turned(angle: float, point) -> np.ndarray:
    """The point turned about the axis."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]]) @ np.asarray(point)


def tooth(k: int) -> np.ndarray:
    """(4, 2) corners, anticlockwise: a radial face, and a back that falls off to the next face."""
    corners = (0.6 * ROOT, 0), (OUTER, 0), (ROOT, PITCH), (0.6 * ROOT, PITCH)
    return np.array([turned(k * PITCH + angle, (radius, 0)) for radius, angle in corners])


def seat() -> np.ndarray:
    """Middle of a tip that touches the face along x and the back of the tooth before it."""
    _, top, root, _ = tooth(-1)
    normal = turned(-math.pi / 2, root - top) / math.dist(root, top)
    return np.array([(normal @ root + TIP + normal[1] * TIP) / normal[0], -TIP])


def build() -> da.System:
    system = da.System("ratchet")
    load = system.parameter("load", LOAD, "N m")
    swing = system.parameter("swing", SWING, "rad")
    stiffness = system.parameter("stiffness", 1e5, "N/m")
    wheel = planar.Body("wheel", mass=0.5, inertia=5e-4, position=(0, 0), angle=0)
    lever = planar.Body("lever", mass=0.2, inertia=1e-3, position=(0, 0), angle=-BACK)
    for name, body in (("axle", wheel), ("hub", lever)):
        system.add(body)
        system.add(planar.Revolute(name, system.ground.center, body.center))
    law = swing * (0.5 - 0.5 * da.cos(2 * math.pi / PERIOD * da.t)) - BACK
    system.add(planar.RotationalDriver("hand", system.ground, lever, law))
    system.add(planar.Torque("weight", wheel, -load))
    oil = {"stiffness": 0.0, "damping": 0.01}
    system.add(planar.TorsionSpring("oil", system.ground, wheel, **oil))
    kit = planar.contact
    teeth = [kit.Polygon(wheel, tooth(k).tolist()) for k in range(TEETH)]
    law = kit.HuntCrossley(stiffness=stiffness, exponent=1, damping=5.0)
    reach = np.array([-HIGHER, ARM])
    base = seat() - reach
    for name, body, face, back, lifted in (
        ("hold", system.ground, math.pi / 2, 0.0, 0.0),
        ("drive", lever, -math.pi / 2, BACK, 0.09),
    ):
        pivot, along = turned(face, base), turned(face - back - lifted, reach)
        lean, middle = math.atan2(along[1], along[0]), turned(-back, pivot) + along / 2
        length = math.hypot(*reach)
        pawl = planar.Bar(name, length=length, mass=0.05, position=tuple(middle), angle=lean)
        system.add(pawl)
        system.add(planar.Revolute(f"{name}_pin", body.point(*pivot), pawl.start))
        rest = lean + lifted + back + PRESS
        press = {"stiffness": SPRING, "damping": 1e-4, "free_angle": rest}
        system.add(planar.TorsionSpring(f"{name}_spring", body, pawl, **press))
        end = kit.Circle(pawl.end, TIP)
        for k, shape in enumerate(teeth):
            system.add(planar.Contact(f"{name}{k}", shape, end, law=law))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    motion = da.solve_dynamics(model, SWINGS * PERIOD, step=5e-5, outputs=1501, backend="jit")
    wheel = motion["wheel.angle"].values / PITCH
    ends = np.arange(1, SWINGS + 1) * (wheel.size // SWINGS)  # the lever is back
    hold = sum(motion[f"hold{k}.force"].values for k in range(TEETH))

    def gained(measure: str) -> float:  # in the last swing
        return float(np.diff(motion[measure].values[ends[1:]])[0])

    numbers = {
        "first swing [pitches]": wheel[ends[0]],
        "second swing [pitches]": wheel[ends[1]] - wheel[ends[0]],
        "third swing [pitches]": wheel[ends[2]] - wheel[ends[1]],
        "farthest back [pitches]": float((np.maximum.accumulate(wheel) - wheel).max()),
        "contact forces of the holding pawl [N]": float(hold[ends].mean()),
        "energy supplied in a swing [J]": gained("input_energy"),
        "energy dissipated in a swing [J]": gained("dissipated_energy"),
    }
    print(*(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8))
        style.draw(left, motion, 0.6 * PERIOD)
        left.set(title="wheel, lever and pawls", xlabel="x [m]", ylabel="y [m]")
        right.plot(motion.time, motion["lever.angle"] / PITCH, color=style.GREY, label="lever")
        right.plot(motion.time, wheel, label="wheel")
        right.set(title="angle [pitches]", xlabel="t [s]", yticks=range(SWINGS + 2))
        right.legend()
        style.save(figure, folder, "ratchet")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
