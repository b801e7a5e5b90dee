"""A quarter car that drives over a kerb, passive and with a sampled skyhook damper.

The active damper pulls the car towards an imagined hook in the sky with a force proportional to the
absolute speed of the car (Karnopp 1974), measured every five milliseconds. The gradient of the
comfort with respect to the gain passes through the samples.
"""

import sys

import matplotlib.pyplot as plt
import style

import dalembert as da
from dalembert import planar

BODY, WHEEL = 300.0, 40.0
"""Masses on and below the spring [kg]."""
SPRING, DAMPER, TYRE = 18e3, 1e3, 180e3
"""Stiffness of spring and tyre [N/m], passive damping [N s/m]."""
KERB, SAMPLE, DURATION = 0.05, 5e-3, 3.0
"""Height of the kerb [m], sample time and duration [s]."""
GAIN = 2.5e3
"""Damping of the skyhook [N s/m]."""


def build() -> da.System:
    system = da.System("quarter car")
    gain = system.parameter("gain", GAIN, "N s/m", bounds=(0, 10e3))
    car = system.add(planar.Particle("car", mass=BODY, position=(0, 0.6)))
    wheel = system.add(planar.Particle("wheel", mass=WHEEL, position=(0, 0.3)))
    for body in (car, wheel):
        ends = system.ground.center, body.center
        system.add(planar.PinInSlot(f"rail_{body.name}", *ends, axis=(0, 1)))
    shape = {"stiffness": SPRING, "damping": DAMPER, "free_length": 0.3}
    system.add(planar.Spring("strut", wheel.center, car.center, **shape))
    lift = TYRE * (KERB - (wheel.y - 0.3))
    system.add(planar.Force("tyre", wheel.center, (0, lift)))
    hook = system.add(da.blocks.SampledState("hook", sample_time=SAMPLE, unit="N"))
    hook.next = -gain * car.vy
    system.add(planar.Force("actuator", car.center, (0, hook.value)))
    system.add(planar.Force("reaction", wheel.center, (0, -hook.value)))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    run = da.Dynamics(duration=DURATION, step=1e-3)
    passive, active = (run.run(model, {"gain": gain}) for gain in (0.0, GAIN))
    comfort = da.rms("car.ay")
    slope = da.sensitivity(active, comfort, method="adjoint").sel(parameter="gain").item()
    numbers = {
        "passive overshoot": float(passive["car.y"].max()) - 0.6 - KERB,
        "active overshoot": float(active["car.y"].max()) - 0.6 - KERB,
        "height after a second": active["car.y"].sel(time=1.0, method="nearest").item() - 0.6,
        "rms acceleration, passive": da.evaluate(passive, comfort),
        "rms acceleration, active": da.evaluate(active, comfort),
        "its slope by the gain": slope,
    }
    for name, value in numbers.items():
        print(f"{name}: {value:.8f}")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.2))
        for motion, label, colour in (
            (passive, "passive", style.GREY),
            (active, "skyhook", style.BLUE),
        ):
            left.plot(motion.time, 100 * (motion["car.y"] - 0.6), color=colour, label=label)
        left.axhline(100 * KERB, color="0.8", zorder=0)
        left.set(xlabel="time [s]", ylabel="height of the car [cm]", title="over a kerb")
        left.legend()
        begin = active.time < 0.3
        right.step(
            active.time[begin], active["hook.value"][begin], where="post", color=style.ORANGE
        )
        right.set(xlabel="time [s]", ylabel="force [N]", title="actuator, sampled at 200 Hz")
        style.save(figure, folder, "active_suspension")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
