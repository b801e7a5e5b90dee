"""Four-bar linkage swinging under gravity, and the influence of its parameters.

Data of the book's section 5.4.3: bars of 5 kg/m between fixed pivots 1 m apart, released with
the crank upright at 1 rad/s.
"""

import math
import sys

import matplotlib.pyplot as plt
import style

import dalembert as da
from dalembert import planar


def build() -> da.System:
    system = da.System("four-bar", gravity=(0.0, -9.81))
    l1 = system.parameter("l1", 0.3, "m", bounds=(0.2, 0.4))
    l2 = system.parameter("l2", 1.0, "m", bounds=(0.8, 1.2))
    l3 = system.parameter("l3", 0.6, "m", bounds=(0.5, 0.8))
    rho = system.parameter("rho", 5.0, "kg/m")
    omega = system.parameter("omega", 1.0, "rad/s")

    crank = system.add(
        planar.Bar("crank", length=l1, mass=rho * l1, angle=math.pi / 2, angular_velocity=omega)
    )
    coupler = system.add(
        planar.Bar("coupler", length=l2, mass=rho * l2, angle=0.2, points={"P": (0.1, 0.2)})
    )
    rocker = system.add(planar.Bar("rocker", length=l3, mass=rho * l3, angle=1.2))

    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    motion = da.solve_dynamics(model, 8.0, step=0.005)
    peak = da.maximum("A.force_norm", smooth="10 N", name="peak force in A")
    angle = da.final("crank.angle", name="crank angle at 8 s")
    gradient = da.sensitivity(motion, [peak, angle], method="adjoint")
    numbers = {r.label: da.evaluate(motion, r) for r in (peak, angle)}
    numbers["energy error"] = float(abs(motion["balance_error"]).max())

    print(motion, *(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    print(gradient.to_pandas())
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), width_ratios=(1, 1.2))
        left.plot(
            motion["coupler.P.x"], motion["coupler.P.y"], color=style.PINK, lw=1, label="path of P"
        )
        style.draw(left, motion)
        left.set(xlabel="x [m]", ylabel="y [m]", title="start, and path of the coupler point P")
        for bar in ("crank", "coupler", "rocker"):
            right.plot(motion.time, motion[f"{bar}.angle"], label=bar)
        right.set(xlabel="time [s]", ylabel="angle [rad]", title="angles of the bars")
        right.legend(ncols=3)
        style.save(figure, folder, "four_bar")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
