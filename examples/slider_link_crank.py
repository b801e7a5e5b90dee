"""Book examples 6.2 and 6.4: slider, link and crank, the loop cut at D.

Joint coordinates of the open chain q = (s, θ2, θ3), two closing equations, one degree of freedom.
With the independent speed u = θ̇3 the others follow if det W = l2 cos θ2 is not zero, which holds
for the whole turn with these lengths (Fig. 6.4). The system is conservative: after a turn the crank
has its initial speed.
"""

import math
import sys

import casadi as ca
import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

A, B, L1, L2, L3 = 2.0, 1.0, 0.8, 1.0, 0.5
ANGLE, SPEED = 0.5, 14.0  # of the crank at the start
NAMES = ("A.displacement", "link.angle", "crank.angle")


def inclination(crank_angle):
    """θ2 of the closed loop."""
    return np.arcsin((B + L3 * np.sin(crank_angle) - L1) / L2)


def build() -> da.System:
    system = da.System("slider, link and crank", gravity=(0.0, -9.81))
    slider = system.add(
        planar.Body("slider", mass=1.5, inertia=0.1, position=(1.5, L1 / 2), angle=0.0)
    )
    slider.add_point("A", (0, -L1 / 2))
    slider.add_point("B", (0, L1 / 2))
    link = system.add(planar.Bar("link", length=L2, mass=0.9, angle=inclination(ANGLE)))
    crank = system.add(
        planar.Bar("crank", length=L3, mass=0.6, angle=ANGLE, angular_velocity=SPEED)
    )
    system.add(planar.Prismatic("A", system.ground.center, slider.point("A")))
    system.add(planar.Revolute("B", slider.point("B"), link.start))
    system.add(planar.Revolute("D", crank.end, link.end))
    system.add(planar.Revolute("E", system.ground.point(A, B), crank.start))
    system.add(
        planar.Spring(
            "spring", system.ground.center, slider.point("A"), stiffness=10.0, free_length=1.2
        )
    )
    return system


def partition_determinant(view) -> ca.Function:
    """det W of ``[U W] = C_II`` with W the columns of ṡ and θ̇2, a function of q."""
    e = view.equations
    dependent = [view.names.index(name) for name in NAMES[:2]]
    w = ca.densify(e.jacobian[:, dependent])
    return ca.Function("det", [e.y], [w[0, 0] * w[1, 1] - w[0, 1] * w[1, 0]])


def positions(view, angles) -> np.ndarray:
    """(3, K) closed positions over the angle of the crank, in the order of the view."""
    theta2 = inclination(angles)
    s = A + L3 * np.cos(angles) - L2 * np.cos(theta2)
    by_name = dict(zip(NAMES, (s, theta2, angles), strict=True))
    return np.stack([by_name[name] for name in view.names])


def main(folder=None) -> dict[str, float]:
    model = build().build()
    coordinates = da.JointCoordinates(cut=("D",), angles="absolute")
    view = coordinates.view(model)
    angles = np.linspace(0, 2 * math.pi, 361)
    determinants = abs(partition_determinant(view)(positions(view, angles)).full().ravel())
    turn = da.Event(model["crank.angle"] - (ANGLE + 2 * math.pi))
    run = da.solve_dynamics(
        model,
        1.5,
        coordinates=coordinates,
        formulation=da.VelocityPartitioning(independent=("crank.angle",)),
        integrator=da.DormandPrince853(1e-10, 1e-10),
        events={"turn": turn},
        outputs=601,
    )
    after = run.at([run.events[0].time])
    numbers = {
        "joint coordinates": float(len(view.names)),
        "closing equations": float(view.equations.constraint_count),
        "smallest |det W| [m]": float(determinants.min()),
        "crank's speed after one turn [rad/s]": float(after["crank.angular_velocity"][0]),
        "loop open by at most [m]": float(abs(run["position_violation"]).max()),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, middle, right) = plt.subplots(
            1, 3, figsize=(11, 3.3), width_ratios=(1.2, 1, 1.2)
        )
        for time, alpha in ((0.0, 1.0), (0.2, 0.35)):
            style.draw(left, run, time, alpha)
        left.set(xlabel="x [m]", ylabel="y [m]", title="slider, link and crank")
        middle.plot(np.degrees(angles), determinants, color=style.ORANGE)
        middle.set(
            xlabel="θ3 [deg]",
            title="|det W| [m] (Fig. 6.4)",
            ylim=(0, 1.05),
            xticks=range(0, 361, 90),
        )
        for joint in ("A", "B", "D", "E"):
            right.plot(run.time, run[f"{joint}.force_norm"], label=joint)
        right.set(xlabel="time [s]", title="forces in the joints [N]")
        right.legend(ncols=4)
        style.save(figure, folder, "slider_link_crank")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
