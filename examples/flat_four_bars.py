"""Two four-bars in a row that fall through the positions where all bars lie on one line.

There the constraint matrix loses rank. ``AugmentedLagrangian`` with ``Projection`` passes; the
cranks stay parallel, so the exact motion is that of one equation (IFToMM benchmark A02).
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar

COUNT, G, DURATION = 2, 9.81, 10.0


def build() -> da.System:
    system = da.System("flat four-bars", gravity=(0.0, -G))
    cranks = [
        system.add(
            planar.Bar(
                f"crank{k}",
                length=1.0,
                mass=1.0,
                angle=np.pi / 2,
                position=(k, 0.5),
                angular_velocity=-1.0,
            )
        )
        for k in range(COUNT + 1)
    ]
    for k, crank in enumerate(cranks):
        system.add(planar.Revolute(f"O{k}", system.ground.point(k, 0), crank.start))
    for k in range(COUNT):
        bar = planar.Bar(f"coupler{k}", length=1.0, mass=1.0, angle=0.0, position=(k + 0.5, 1.0))
        system.add(bar)
        system.add(planar.Revolute(f"A{k}", cranks[k].end, bar.start))
        system.add(planar.Revolute(f"B{k}", bar.end, cranks[k + 1].end))
    return system


def exact(times) -> np.ndarray:
    """Angle of the cranks, ``[(N+1)/3 + N] φ̈ = −[(N+1)/2 + N] g cos φ``."""
    ratio = ((COUNT + 1) / 2 + COUNT) / ((COUNT + 1) / 3 + COUNT) * G
    flow = solve_ivp(
        lambda t, s: [s[1], -ratio * np.cos(s[0])],
        (0, times[-1]),
        [np.pi / 2, -1.0],
        "DOP853",
        times,
        rtol=1e-13,
        atol=1e-13,
    )
    return flow.y[0]


def smallest_singular_value(angle) -> np.ndarray:
    """Of the loop equations of one window, which is how the rank is lost."""
    columns = np.array([[-np.sin(angle), np.sin(angle), 0 * angle],
                        [np.cos(angle), -np.cos(angle), 0 * angle + 1]])  # fmt: skip
    return np.linalg.svd(np.moveaxis(columns, 2, 0), compute_uv=False)[:, -1]


def main(folder=None) -> dict[str, float]:
    motion = da.solve_dynamics(
        build().build(),
        DURATION,
        formulation=da.AugmentedLagrangian(),
        integrator=da.DormandPrince(1e-9, 1e-9),
        outputs=501,
    )
    angle, found = exact(motion.time), motion["crank0.angle"].values
    flat = np.flatnonzero(np.diff(np.sign(np.sin(found))))
    x, y = (float(motion[f"crank0.end.{axis}"][-1]) for axis in "xy")
    numbers = {
        "singular positions passed": float(flat.size),
        "x of the first crank's end after 10 s [m]": x,
        "y of the first crank's end after 10 s [m]": y,
        "largest error of the angle [rad]": float(abs(found - angle).max()),
        "largest error of the energy [J]": float(abs(motion.data.balance_error).max()),
        "maximum |C v̇ − ξ|": motion.statistics["maximum |C v̇ − ξ|"],
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), width_ratios=(1, 1.4))
        for time, alpha in ((0.0, 0.9), (0.5, 0.35), (1.0, 0.6)):
            style.draw(left, motion, time, alpha=alpha)
        left.set(xlabel="x [m]", ylabel="y [m]", title="two windows")
        right.plot(motion.time, np.degrees(found))
        right.set(
            xlabel="time [s]",
            ylabel="angle of the cranks [°]",
            title="all bars on one line where a dashed line is crossed",
        )
        for level in range(-9, 1):
            right.axhline(180 * level, color="0.6", lw=0.8, ls="--")
        measure = right.twinx()
        measure.plot(motion.time, smallest_singular_value(found), color=style.ORANGE, lw=0.9)
        measure.set_ylabel("smallest singular value of a window", color=style.ORANGE)
        measure.grid(False)
        style.save(figure, folder, "flat_four_bars")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
