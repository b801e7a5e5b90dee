"""A Geneva wheel with four slots: a pin with constant speed moves the wheel by quarter turns.

The pin enters a slot along its direction, so that the wheel starts at zero speed, and leaves it
after a quarter turn of the pin. In between, ``tan ψ = r sin θ/(a − r cos θ)`` for the distance a of
the axes and r = a/√2. Here the wheel consists of four blocks with clearance for the pin, so that
contact opens and closes; a brake holds the wheel between its motions, in place of a locking disc.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

APART, PIN, PLAY, SPEED = 0.1, 0.004, 5e-5, 4 * math.pi
REACH = APART / math.sqrt(2)
TURN = 2 * math.pi / SPEED


def block() -> np.ndarray:
    """(4, 2) corners of what lies between the slots along x and y."""
    slot, outer = PIN + PLAY, 0.97 * REACH
    return np.array([[slot, slot], [outer, slot], [0.72 * outer, 0.72 * outer], [slot, outer]])


def build() -> da.System:
    system = da.System("Geneva wheel")
    speed = system.parameter("speed", SPEED, "rad/s")
    brake = system.parameter("brake", 0.02, "N m", bounds=(0.005, 0.2))
    turning = {"angle": -0.3 * math.pi, "angular_velocity": speed, "position": (0, 0)}
    crank = system.add(
        planar.Body("crank", mass=1.0, inertia=1e-3, points={"pin": (REACH, 0)}, **turning)
    )
    wheel = system.add(
        planar.Body("wheel", mass=0.3, inertia=2e-4, position=(APART, 0), angle=math.pi / 4)
    )
    system.add(planar.Revolute("A", system.ground.center, crank.center))
    axle = system.add(planar.Revolute("B", system.ground.point(APART, 0), wheel.center))
    law = -0.3 * math.pi + speed * da.t
    system.add(planar.RotationalDriver("motor", system.ground, crank, law))
    system.add(planar.JointFriction("bearing", axle, coulomb=brake, transition=0.02))
    kit, pin = planar.contact, crank.point("pin")
    for k in range(4):
        c, s = round(math.cos(k * math.pi / 2)), round(math.sin(k * math.pi / 2))
        corners = block() @ np.array([[c, s], [-s, c]])
        system.add(
            planar.Contact(
                f"block{k + 1}",
                kit.Polygon(wheel, corners.tolist()),
                kit.Circle(pin, PIN),
                law=kit.HuntCrossley(stiffness=2e9, damping=20.0),
            )
        )
    return system


def ideal(angle: np.ndarray) -> np.ndarray:
    """Angle of the wheel by that of the crank, within a slot."""
    return -np.arctan2(REACH * np.sin(angle), APART - REACH * np.cos(angle))


def main(folder=None) -> dict[str, float]:
    model = build().build()
    motion = da.solve_dynamics(
        model, 2 * TURN, integrator=da.DormandPrince(rtol=1e-6, atol=1e-9), outputs=801
    )
    crank = motion["crank.angle"].values
    wheel = motion["wheel.angle"].values - math.pi / 4
    within = np.abs(crank) < 0.24 * math.pi  # of the first pass
    off = wheel[within] - math.pi / 4 * -1 - ideal(crank[within])
    press = sum(motion[f"block{k + 1}.force"].values for k in range(4))
    numbers = {
        "turned": float(np.degrees(wheel[-1])),
        "off": float(np.abs(off - off.mean()).max()),
        "press": float(press.max()),
    }
    print(
        f"after two turns the wheel has turned by {numbers['turned']:.2f}°, off the ideal course "
        f"by {1e3 * numbers['off']:.2f} mrad in a slot; the pin presses up to {press.max():.0f} N"
    )
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6))
        style.draw(left, motion, 0.1)
        left.set(title="pin and wheel", xlabel="x [m]", ylabel="y [m]", aspect="equal")
        right.plot(motion.time, np.degrees(wheel))
        right.set(title="angle of the wheel [°]", xlabel="t [s]")
        right.set_yticks([0, -90, -180])
        style.save(figure, folder, "geneva_wheel")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
