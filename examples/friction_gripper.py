"""A gripper lifts a disc by friction: the force of its jaws is sized by exact gradients.

Two jaws press the disc with the force N each. It stays on the floor if ``2 μ N < m g``, follows the
lift if ``2 μ N > m (g + a)`` with the largest acceleration a, and slips for a while in between. The
friction law creeps instead of sticking, at ``v_t artanh(T/μN)/4``. The optimisation reduces the
force until the disc lags behind by 0.3 mm.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

G, MASS, FRICTION, GRIP, LIFT, STIFFNESS = 9.81, 1.0, 0.3, 30.0, 0.2, 1e6
RISE, CREEP, WEAK = 0.6, 3e-4, 15.0
"""Time of the lift [s], permitted lag [m], a force too small to lift the disc [N]."""
RUN = da.Dynamics(duration=0.8, integrator=da.Radau(rtol=1e-7, atol=1e-10))


def build() -> da.System:
    system = da.System("friction gripper", gravity=(0.0, -G))
    grip = system.parameter("grip", GRIP, "N", bounds=(10.0, 60.0))
    mass = system.parameter("mass", MASS, "kg")
    friction = system.parameter("friction", FRICTION)
    lift = system.parameter("lift", LIFT, "m")
    stiffness = system.parameter("stiffness", STIFFNESS, "N/m")
    radius = 0.04
    bottom, apart = radius - G * mass / stiffness, radius - grip / stiffness
    disc = planar.Body(
        "disc", mass=mass, inertia=mass * radius**2 / 2, position=(0, bottom), angle=0
    )
    carriage = planar.Body(
        "carriage",
        mass=2.0,
        inertia=0.02,
        position=(0, bottom + 0.1),
        angle=0,
        points={"left": (-0.08, 0), "right": (0.08, 0)},
    )
    system.add(disc)
    system.add(carriage)
    column = planar.Prismatic("column", system.ground.center, carriage.center, axis=(0, 1))
    system.add(column)
    kit = planar.contact
    law = kit.KelvinVoigt(stiffness=stiffness, damping=200.0)
    rim = kit.Circle(disc.center, radius)
    for name, inward in (("left", 1), ("right", -1)):
        points = {"top": (0, 0.1), "low": (0, -0.02)}
        place = {"position": (-inward * apart, bottom), "angle": 0}
        jaw = planar.Body(name, mass=0.2, inertia=2e-4, points=points, **place)
        system.add(jaw)
        guide = carriage.center, jaw.point("top")
        system.add(planar.Prismatic(f"{name}_guide", *guide, axis=(1, 0)))
        system.add(planar.Force(f"{name}_force", jaw.center, (inward * grip, 0)))
        face, rough = kit.HalfPlane(jaw.center, normal=(inward, 0)), kit.Coulomb(friction)
        system.add(planar.Contact(f"{name}_jaw", face, rim, law=law, friction=rough))
    system.add(planar.Contact("floor", kit.HalfPlane(system.ground.center), rim, law=law))
    rise = da.CycloidalRise(height=lift, duration=RISE, start=bottom + 0.1)
    system.add(planar.TranslationalDriver("hoist", column, rise))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    lag = da.final("left.y - disc.y")
    best = da.optimize(
        model,
        da.final("grip"),
        vary=["grip"],
        subject_to=[da.Limit(lag, upper=CREEP)],
        analysis=RUN,
        method=da.Ipopt(),
    )
    weak, firm = RUN.run(model, parameters={"grip": WEAK}), best.initial
    least = best.x["grip"]
    numbers = {
        "lag at 30 N [mm]": 1e3 * da.evaluate(firm, lag),
        "height at 15 N [mm]": 1e3 * float(np.ptp(weak["disc.y"].values)),
        "floor bears during the lift at 15 N [N]": float(weak.at([0.3])["floor.force"].values[0]),
        "smallest force [N]": least,
        "lag with it [mm]": 1e3 * da.evaluate(best.motion, lag),
    }
    print(best.message, *(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, middle, right) = plt.subplots(
            1, 3, figsize=(11, 3.5), width_ratios=(0.8, 1, 1)
        )
        style.draw(left, best.motion, RUN.duration)
        left.set(title="lifted", xlabel="x [m]", ylabel="y [m]")
        for motion, label in ((firm, "30 N"), (best.motion, f"{least:.1f} N"), (weak, "15 N")):
            fine = motion.at(np.linspace(0, RUN.duration, 801))
            middle.plot(fine.time, 1e3 * (fine["disc.y"] - fine["disc.y"][0]), label=label)
            if motion is not weak:
                right.plot(fine.time, 1e3 * (fine["left.y"] - fine["disc.y"]), label=label)
        middle.set(title="height of the disc [mm]", xlabel="t [s]")
        middle.legend()
        right.set(title="lag behind the jaws [mm]", xlabel="t [s]")
        right.legend()
        style.save(figure, folder, "friction_gripper")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
