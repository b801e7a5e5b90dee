"""N four-bars in a row (IFToMM benchmark A02) against their exact equation of one coordinate.

The cranks stay parallel, so ((N+1)/3 + N) phi'' = -((N+1)/2 + N) g/L cos phi. The run ends before
all bars align, where the mechanism may change its branch.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar


def build(n: int = 2) -> da.System:
    system = da.System(f"N four-bar, N = {n}", gravity=(0.0, -9.81))
    length = system.parameter("length", 1.0, "m")
    m_crank = system.parameter("m_crank", 1.0, "kg")
    m_coupler = system.parameter("m_coupler", 1.0, "kg")
    omega = system.parameter("omega", -1.0, "rad/s")
    cranks = []
    for k in range(n + 1):
        speed = omega if k == 0 else None
        crank = planar.Bar(
            f"crank{k}", length=length, mass=m_crank, angle=math.pi / 2, angular_velocity=speed
        )
        cranks.append(system.add(crank))
    couplers = [
        system.add(planar.Bar(f"coupler{k}", length=1.0, mass=m_coupler, angle=0.0))
        for k in range(1, n + 1)
    ]
    for k, crank in enumerate(cranks):
        system.add(planar.Revolute(f"O{k}", system.ground.point(k, 0), crank.start))
    for k, coupler in enumerate(couplers, 1):
        system.add(planar.Revolute(f"A{k}", cranks[k - 1].end, coupler.start))
        system.add(planar.Revolute(f"B{k}", coupler.end, cranks[k].end))
    return system


def exact(n: int, times: np.ndarray) -> np.ndarray:
    """Crank angle."""
    factor = ((n + 1) / 2 + n) / ((n + 1) / 3 + n) * 9.81
    solved = solve_ivp(
        lambda t, s: (s[1], -factor * math.cos(s[0])),
        (0, times[-1]),
        (math.pi / 2, -1.0),
        method="DOP853",
        t_eval=times,
        rtol=1e-13,
        atol=1e-13,
    )
    return solved.y[0]


def main(folder=None) -> dict[str, float]:
    numbers = {}
    for n in (1, 2, 4):
        motion = da.solve_dynamics(build(n).build(), 0.6, step=0.001)
        angle = exact(n, motion.time)
        numbers[f"error N={n}"] = float(abs(motion["crank0.angle"].values - angle).max())
        print(
            f"N = {n}: {motion.model.diagnosis.coordinates} coordinates, "
            f"angle within {numbers[f'error N={n}']:.1e} rad, "
            f"energy within {float(abs(motion['balance_error']).max()):.1e} J"
        )
        if folder and n == 2:
            figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.3), width_ratios=(1.4, 1))
            for time, alpha in ((0, 0.2), (0.35, 0.45), (0.55, 1)):
                style.draw(left, motion, time, alpha)
            left.set(title="start, 0.35 s and 0.55 s", xlabel="x [m]", ylabel="y [m]")
            right.plot(
                motion.time, motion["crank0.angle"], label="all five bars, absolute coordinates"
            )
            right.plot(
                motion.time[::60],
                angle[::60],
                "o",
                mfc="none",
                color=style.ORANGE,
                label="exact equation",
            )
            right.set(title="crank angle [rad]", xlabel="time [s]")
            right.legend()
            style.save(figure, folder, "n_four_bar")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
