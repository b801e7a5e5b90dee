"""Torques of hip and knee from measured positions of knee and ankle: inverse dynamics of a leg.

A leg swings in the sagittal plane. Cameras measure its knee and ankle 60 times a second, with an
error of 2 mm. Second differences of these data are half noise. Splines of the joint angles, with a
smoothing by cross validation, are accurate except at the very ends. The data are synthetic, so the
true torques are known.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

G, NOISE, RATE = 9.81, 2e-3, 60
THIGH = {"length": 0.42, "mass": 7.4}
SHANK = {"length": 0.43, "mass": 3.4}
FOOT = 1.1
SWING = 2 * np.pi / 1.1


def angles(t) -> tuple[np.ndarray, np.ndarray]:
    """Of hip and knee, from the downward line and from the thigh [rad]."""
    hip = 0.15 + 0.38 * np.cos(SWING * t) - 0.05 * np.sin(2 * SWING * t)
    knee = -0.5 - 0.4 * np.cos(SWING * t + 2.2) - 0.15 * np.cos(2 * SWING * t)
    return hip, knee


def build(knots) -> tuple[da.System, list[da.InputHistory]]:
    system = da.System("leg", gravity=(0.0, -G))
    hip0, knee0 = angles(0.0)
    hip = da.input_history(system, "hip", knots, float(hip0), "rad")
    knee = da.input_history(system, "knee", knots, float(knee0), "rad")
    down = -np.pi / 2
    thigh = system.add(planar.Bar("thigh", angle=down + float(hip0), **THIGH))
    shank = system.add(planar.Bar("shank", angle=down + float(hip0 + knee0), **SHANK))
    foot = system.add(planar.Particle("foot", mass=FOOT, position=(0.1, -0.8)))
    system.add(planar.Revolute("H", system.ground.point(0, 0), thigh.start))
    system.add(planar.Revolute("K", thigh.end, shank.start))
    system.add(planar.Revolute("F", shank.end, foot.center))
    system.add(planar.RotationalDriver("hip_motor", system.ground, thigh, hip.value + down))
    system.add(planar.RotationalDriver("knee_motor", thigh, shank, knee.law))
    return system, [hip, knee]


def seen(times, noise: float) -> dict[str, np.ndarray]:
    """Positions of knee and ankle, as cameras give them."""
    hip, knee = angles(times)
    first, second = hip - np.pi / 2, hip + knee - np.pi / 2
    rng, found = np.random.default_rng(11), {"time": times}
    place = np.zeros((2, times.size))
    for name, angle, part in (("knee", first, THIGH), ("ankle", second, SHANK)):
        place = place + part["length"] * np.stack([np.cos(angle), np.sin(angle)])
        for axis, values in zip("xy", place, strict=True):
            found[f"{name}.{axis}"] = values + rng.normal(0, noise, times.size)
    return found


def main(folder=None) -> dict[str, float]:
    times = np.arange(0, 1.1 + 1e-9, 1 / RATE)
    knots = np.linspace(0, times[-1], 20)
    system, histories = build(knots)
    model = system.build()
    measures = {
        f"{marker}.{axis}": f"{end}.end.{axis}"
        for marker, end in (("knee", "thigh"), ("ankle", "shank"))
        for axis in "xy"
    }
    duration, data = float(times[-1]), seen(times, NOISE)
    found = da.invert(
        *(model, data, measures, histories),
        analysis=da.Kinematics(duration, outputs=23),
        noise=dict.fromkeys(measures, NOISE),
        smoothing="cross-validation",
        order=3,
    )
    run = da.solve_inverse_dynamics(model, duration, outputs=times.size, parameters=found.x)
    made = {"smooth": np.stack([run[f"{j}_motor.effort"].values for j in ("hip", "knee")])}
    made["raw"] = torques(*differences(data))
    true = torques(*exact(times))
    inner = slice(8, -8)  # a natural spline has no curvature at its ends
    size = np.sqrt(np.mean(true[:, inner] ** 2, axis=1))
    numbers = {}
    for name, torque in made.items():
        off = np.sqrt(np.mean((torque - true)[:, inner] ** 2, axis=1)) / size
        numbers |= {f"{name} hip": off[0], f"{name} knee": off[1]}
    numbers["misfit"] = found.misfit_norm / np.sqrt(4 * times.size)
    print(*(f"{name}: {value:.4g}" for name, value in numbers.items()), sep="\n")
    if folder:
        picture(folder, run, made, true, found)
    return numbers


def exact(t) -> tuple[np.ndarray, ...]:
    """(2, K) angles, rates and second rates of the true motion."""
    h = 1e-4
    now, before, after = (np.stack(angles(t + s)) for s in (0.0, -h, h))
    return now, (after - before) / (2 * h), (after - 2 * now + before) / h**2


def differences(data) -> tuple[np.ndarray, ...]:
    """(2, K) the same by differences of what was seen, not smoothed."""
    knee, ankle = (np.stack([data[f"{m}.x"], data[f"{m}.y"]]) for m in ("knee", "ankle"))
    links = [np.arctan2(part[0], -part[1]) for part in (knee, ankle - knee)]
    now = np.stack([links[0], links[1] - links[0]])
    speed = np.gradient(now, data["time"], axis=1)
    return now, speed, np.gradient(speed, data["time"], axis=1)


def torques(now, speed, rate) -> np.ndarray:
    """(2, K) of hip and knee by Lagrange's equations of the two links, in closed form."""
    (l1, m1), (l2, m2) = ((p["length"], p["mass"]) for p in (THIGH, SHANK))
    a, b = now[0], now[0] + now[1]  # from the downward line
    w, v, dw, dv = speed[0], speed.sum(axis=0), rate[0], rate.sum(axis=0)
    i1 = m1 * l1**2 / 3 + (m2 + FOOT) * l1**2
    i2 = m2 * l2**2 / 3 + FOOT * l2**2
    c = (m2 / 2 + FOOT) * l1 * l2
    first = i1 * dw + c * np.cos(b - a) * dv - c * np.sin(b - a) * v**2
    first = first + (m1 / 2 + m2 + FOOT) * G * l1 * np.sin(a)
    second = i2 * dv + c * np.cos(b - a) * dw + c * np.sin(b - a) * w**2
    second = second + (m2 / 2 + FOOT) * G * l2 * np.sin(b)
    return np.stack([first + second, second])


def picture(folder, run, made, true, found) -> None:
    figure, axes = plt.subplots(1, 3, figsize=(11.5, 3.6))
    for time, alpha in ((0.0, 1.0), (0.3, 0.5), (0.6, 0.25)):
        style.draw(axes[0], run, time, alpha)
    axes[0].set(title="leg at three instants", xlabel="x [m]", ylabel="y [m]")
    for k, joint in enumerate(("hip", "knee")):
        colour = style.COLOURS[k]
        axes[1].plot(run.time, made["raw"][k], color=colour, lw=0.6, alpha=0.4)
        axes[1].plot(run.time, made["smooth"][k], color=colour, label=joint)
        axes[1].plot(run.time, true[k], color="0.2", lw=1, ls="--", label="true" if k else None)
    axes[1].set(title="torques [N m]; thin: not smoothed", xlabel="time [s]", ylim=(-45, 60))
    axes[1].legend(ncols=3)
    axes[2].loglog(found.curve.misfit, found.curve.roughness)
    axes[2].loglog(found.misfit_norm, found.roughness_norm, "o", color=style.ORANGE)
    axes[2].set(title="L-curve, and the smoothing chosen", xlabel="misfit", ylabel="roughness")
    axes[2].xaxis.set_minor_formatter(plt.NullFormatter())
    style.save(figure, folder, "gait_torques")


if __name__ == "__main__":
    main(*sys.argv[1:])
