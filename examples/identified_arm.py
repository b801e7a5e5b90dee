"""Two-link arm identified from noisy angles: masses and friction, with confidence intervals.

The arm hangs under gravity and is excited by known torques. Its simulated angles have a noise of
0.01 rad. Least squares with exact gradients estimates the masses of both links, the payload and the
damping of both joints, from two runs with unknown initial angles.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

TRUE = {"m1": 3.2, "m2": 1.7, "payload": 0.8, "d1": 0.35, "d2": 0.22}
STARTS = (-1.5, -1.1)
NOISE, TORQUES = 0.01, (8.0, 3.0)


def build() -> da.System:
    system = da.System("two-link arm", gravity=(0.0, -9.81))
    m1 = system.parameter("m1", 2.5, "kg", bounds=(0.5, 10))
    m2 = system.parameter("m2", 2.5, "kg", bounds=(0.5, 10))
    payload = system.parameter("payload", 0.1, "kg", bounds=(0.0, 5))
    damping = [system.parameter(n, 0.1, "N m s", bounds=(0.0, 2)) for n in ("d1", "d2")]
    first = system.parameter("first", -1.4, "rad", bounds=(-2, 0))
    upper = system.add(planar.Bar("upper", length=0.5, mass=m1, angle=first))
    lower = system.add(planar.Bar("lower", length=0.4, mass=m2, angle=first))
    hand = system.add(planar.Particle("hand", mass=payload, position=(0.2, -0.9)))
    system.add(planar.Revolute("shoulder", system.ground.point(0, 0), upper.start))
    system.add(planar.Revolute("elbow", upper.end, lower.start))
    system.add(planar.Revolute("grip", lower.end, hand.center))
    system.add(planar.Torque("motor1", upper, TORQUES[0] * da.sin(5 * da.t)))
    system.add(planar.Torque("motor2", lower, TORQUES[1] * da.sin(9 * da.t)))
    rates = upper.angular_velocity, lower.angular_velocity - upper.angular_velocity
    system.add(planar.Torque("friction1", upper, -damping[0] * rates[0] + damping[1] * rates[1]))
    system.add(planar.Torque("friction2", lower, -damping[1] * rates[1]))
    return system


def experiments(model: da.Model, analysis: da.Dynamics) -> list[da.Experiment]:
    """What would be measured: the true arm, with noise."""
    rng, made = np.random.default_rng(3), []
    for k, start in enumerate(STARTS, start=1):
        motion = analysis.run(model, TRUE | {"first": start})
        data = {"time": motion.time}
        for angle in ("upper.angle", "lower.angle"):
            data[angle] = motion.values(angle) + rng.normal(0, NOISE, motion.time.size)
        made.append(da.Experiment(data=data, name=f"run {k}", own=["first"]))
    return made


def main(folder=None) -> dict[str, float]:
    model = build().build()
    analysis = da.Dynamics(1.5, step=0.01, outputs=76)
    measured = experiments(model, analysis)
    found = da.identify(model, measured, vary=list(TRUE), analysis=analysis)
    print(found)
    numbers = {}
    for name, (low, high) in found.interval().items():
        value = found.x[name]
        true = TRUE.get(name, STARTS[int(name[-2]) - 1] if name not in TRUE else 0.0)
        print(f"{name:>13}: {value:.4f}, 95 %: {low:.4f} … {high:.4f}, true {true}")
        numbers[name] = value
    numbers["noise"] = found.noise["upper.angle"]
    print(f"noise {numbers['noise']:.4f} rad;", *found.notes)
    if folder:
        picture(folder, found)
    return numbers


def picture(folder, found: da.IdentificationResult) -> None:
    figure, axes = plt.subplots(1, 3, figsize=(11.5, 3.6), width_ratios=(1.3, 1, 1))
    observation, predicted = found.misfit.observations[0], found.predicted[0]
    for j, column in enumerate(observation.columns):
        axes[0].plot(observation.times, observation.values[:, j], ".", ms=4, alpha=0.5)
        axes[0].plot(observation.times, predicted[:, j], color=style.COLOURS[j], label=column)
    axes[0].set(title="first run: data and model [rad]", xlabel="time [s]")
    axes[0].legend()
    interval = found.interval()
    for k, name in enumerate(TRUE):
        low, high = interval[name]
        relative = np.array([low, found.x[name], high]) / TRUE[name]
        axes[1].plot(relative[[0, 2]], [k, k], color=style.BLUE, lw=3)
        axes[1].plot(relative[1], k, "o", color=style.BLUE)
    axes[1].axvline(1, color="0.4", lw=1, ls="--")
    axes[1].set(title="95 % intervals over true values", yticks=range(len(TRUE)))
    axes[1].set_yticklabels(TRUE)
    correlation = found.correlation.values
    axes[2].imshow(correlation, cmap="RdBu_r", vmin=-1, vmax=1)
    axes[2].grid(False)
    names = list(found.x)
    axes[2].set(title="correlation", xticks=range(len(names)), yticks=range(len(names)))
    axes[2].set_xticklabels(names, rotation=70)
    axes[2].set_yticklabels(names)
    style.save(figure, folder, "identified_arm")


if __name__ == "__main__":
    main(*sys.argv[1:])
