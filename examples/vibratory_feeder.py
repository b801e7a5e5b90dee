"""A vibratory feeder moves a part up a trough: it sticks, slides and hops in every period.

The trough vibrates along a line. Where its acceleration exceeds gravity the part hops, and a
plastic impact with friction ends the flight. All changes between sticking, sliding and flight are
located, so that the gradient of the way is exact; with it the line of vibration is turned for the
fastest transport.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

TIME, WAY = 0.4, "-(part.x - trough.x)*cos(slope) - (part.y - trough.y)*sin(slope)"
"""Length of the run, ten periods [s]; minus the way along the trough."""
RUN = da.Dynamics(duration=TIME, integrator=da.DormandPrince(rtol=1e-9, atol=1e-12))


def build() -> da.System:
    system = da.System("vibratory feeder", gravity=(0.0, -9.81))
    slope = system.parameter("slope", math.radians(4), "rad")
    line = system.parameter("line", math.radians(30), "rad", (math.radians(10), math.radians(60)))
    amplitude = system.parameter("amplitude", 1e-3, "m")
    frequency = system.parameter("frequency", 50 * math.pi, "rad/s")
    friction = system.parameter("friction", 0.4, bounds=(0.1, 1.0))
    toward = da.cos(slope + line), da.sin(slope + line)
    trough = system.add(
        planar.Body(
            "trough",
            mass=5.0,
            inertia=0.05,
            position=(0, 0),
            angle=slope,
            points={"low": (-0.01, 0), "high": (0.04, 0)},
        )
    )
    speed = tuple(amplitude * frequency * each for each in toward)
    part = system.add(planar.Particle("part", mass=0.01, position=(0, 0), velocity=speed))
    shake = da.sin(frequency * da.t)
    system.add(planar.UserConstraint("along", trough.x - amplitude * toward[0] * shake))
    system.add(planar.UserConstraint("up", trough.y - amplitude * toward[1] * shake))
    system.add(planar.UserConstraint("level", trough.angle - slope))
    c, s = da.cos(slope), da.sin(slope)
    gap = (part.y - trough.y) * c - (part.x - trough.x) * s
    slip = (part.vx - trough.vx) * c + (part.vy - trough.vy) * s
    law = {"restitution": 0.0, "friction": friction}
    system.add(planar.UnilateralConstraint("surface", gap, slip, **law))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    best = da.optimize(model, da.final(WAY), vary=["line"], analysis=RUN)
    numbers = {
        "speed [mm/s]": -1e3 * da.evaluate(best.initial, da.final(WAY)) / TIME,
        "landings": len(best.initial.impacts),
        "optimised line [deg]": math.degrees(best.x["line"]),
        "optimised speed [mm/s]": -1e3 * best.fun / TIME,
    }
    print(best.message, *(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4))
        runs = (best.initial, "30°"), (best.motion, f"{numbers['optimised line [deg]']:.1f}°")
        for motion, label in runs:
            fine = motion.at(np.linspace(0, TIME, 2001))
            c, s = math.cos(math.radians(4)), math.sin(math.radians(4))
            apart = fine["part.position"].values - fine["trough.position"].values
            along, above = 1e3 * apart @ (c, s), 1e3 * apart @ (-s, c)
            left.plot(along, above)
            right.plot(1e3 * fine.time, along, label=label)
        left.set(title="path relative to the trough", xlabel="along [mm]", ylabel="above [mm]")
        right.set(title="way along the trough [mm]", xlabel="t [ms]")
        right.legend(title="line of vibration")
        style.save(figure, folder, "vibratory_feeder")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
