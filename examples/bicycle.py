"""Bicycle: four bodies, three hinges and two rolling wheels; its self-stability by eigenvalues.

The bicycle of Meijaard, Papadopoulos, Ruina and Schwab (2007). About straight running its motion is
linear in lean and steer. Its cyclic coordinates (position, heading, angles of the wheels) do not
matter in joint coordinates. Between the weave speed, 4.29 m/s, and the capsize speed, 6.02 m/s, all
perturbations decay: the bicycle is stable without a rider.
"""

import math
import sys

import numpy as np
import style
from scipy.interpolate import BarycentricInterpolator
from scipy.optimize import brentq

import dalembert as da
from dalembert import spatial

G, TILT, BASE, TRAIL, REAR, FRONT = 9.81, math.pi / 10, 1.02, 0.08, 0.3, 0.35
STEERING = np.array([math.sin(TILT), 0.0, math.cos(TILT)])
ASIDE = np.array([0.0, 1.0, 0.0])
PLACES = {
    "rear_wheel": np.array([0, 0, -REAR]),
    "frame": np.array([0.3, 0, -0.9]),
    "fork": np.array([0.9, 0, -0.7]),
    "front_wheel": np.array([BASE, 0, -FRONT]),
}


def build(lean_rate: float = 0.0) -> da.System:
    """Upright and straight; x points forward, y to the right, z down."""
    system = da.System("bicycle", gravity=(0.0, 0.0, G))
    speed = system.parameter("speed", 4.6, "m/s", bounds=(1.0, 10.0))
    given = {
        "frame": (85.0, [[9.2, 0, 2.4], [0, 11, 0], [2.4, 0, 2.8]], 0.0),
        "rear_wheel": (2.0, (0.0603, 0.12, 0.0603), -speed / REAR),
        "fork": (4.0, [[0.05892, 0, -0.00756], [0, 0.06, 0], [-0.00756, 0, 0.00708]], 0.0),
        "front_wheel": (3.0, (0.1405, 0.28, 0.1405), -speed / FRONT),
    }
    bodies = {
        name: system.add(
            spatial.Body(
                name,
                mass=mass,
                inertia=inertia,
                position=tuple(PLACES[name]),
                rotation=da.rotation.identity(),
                velocity=(speed, -lean_rate * PLACES[name][2], 0),
                angular_velocity=(lean_rate, spin, 0),
            )
        )
        for name, (mass, inertia, spin) in given.items()
    }
    hinges = (
        ("rear_axle", "frame", "rear_wheel", PLACES["rear_wheel"], ASIDE),
        ("steering", "frame", "fork", (BASE + TRAIL, 0, 0) - 0.9 * STEERING, STEERING),
        ("front_axle", "fork", "front_wheel", PLACES["front_wheel"], ASIDE),
    )
    for name, first, second, place, axis in hinges:
        x = np.array([1, 0, 0]) if axis is ASIDE else np.cross(ASIDE, STEERING)
        ends = (
            bodies[n].frame(tuple(place - PLACES[n]), axis=tuple(axis), x=tuple(x))
            for n in (first, second)
        )
        system.add(spatial.Revolute(name, *ends))
    road = system.ground.frame(axis=(0, 0, -1))
    for name, radius in (("rear", REAR), ("front", FRONT)):
        wheel = bodies[f"{name}_wheel"]
        system.add(spatial.RollingDisc(f"{name}_tyre", wheel, road, radius=radius))
    return system


def roots(model: da.Model, speed: float) -> np.ndarray:
    """Eigenvalues of lean and steer, by real part; four of cyclic motions are zero."""
    modes = da.linearize(
        model, equilibrium=False, coordinates=da.JointCoordinates(), parameters={"speed": speed}
    )
    found = modes.eigenvalues[abs(modes.eigenvalues) > 1e-4]
    return found[np.argsort(found.real)]


def main(folder=None) -> dict[str, float]:
    model = build().build()

    def growth(speed: float, oscillating: bool) -> float:
        """Of the weave, which oscillates at these speeds, or of the capsize."""
        return float(max(z.real for z in roots(model, speed) if bool(z.imag > 1e-6) is oscillating))

    weave = brentq(growth, 4.0, 4.6, args=(True,), xtol=1e-10)
    speeds = np.linspace(5.95, 6.1, 6)  # not where its growth is zero, like that of cyclic motions
    capsize = float(BarycentricInterpolator([growth(v, False) for v in speeds], speeds)(0.0))
    motion = da.solve_dynamics(build(0.5).build(), 5.0, step=5e-3, outputs=501, integrator=da.RK4())
    numbers = {
        "weave speed [m/s]": weave,
        "capsize speed [m/s]": capsize,
        "steer after 5 s [deg]": math.degrees(motion["steering.angle"][-1]),
        "largest error of the energy [J]": float(abs(motion["balance_error"]).max()),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, left, right = style.beside()
        speeds = np.linspace(0.5, 10, 96)
        for speed in speeds:
            right.plot(
                [speed] * len(found := roots(model, speed)), found.real, ".", color=style.BLUE, ms=3
            )
        right.axvspan(weave, capsize, color=style.GREEN, alpha=0.15, lw=0)
        right.set(
            xlabel="speed [m/s]",
            ylabel="real part [1/s]",
            title="eigenvalues; it is stable in the green band",
            ylim=(-10, 10),
        )
        motion.draw(0.0, left)
        left.invert_zaxis()
        left.invert_yaxis()
        left.set_title("at the start, z down")
        style.save(figure, folder, "bicycle")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
