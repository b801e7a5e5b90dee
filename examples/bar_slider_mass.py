"""Book example 7.2: bar, slider on the bar and a mass on a string, with the forces in the joints.

Three joint coordinates describe the open system. Five open-constraint coordinates z, which remain
zero, describe the motions that the joints prevent: their directions E = ∂g/∂z are a pseudo-inverse
of the constraint matrix, C E = I, and yield the reactions one by one, λ = Eᵀ(f − d − M(D q̈ + γ))
(7.13), whereas the projection (6.3) inverts C M⁻¹ Cᵀ.
"""

import sys

import casadi as ca
import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

G, LOAD, STRING = 9.81, 0.9, 0.6
TO_BAR, A_C2, C2_B = 0.45, 0.12, 0.08  # O C1, A C2, C2 B [m]
REACTIONS = (
    "$λ_1$ pin, x [N]",
    "$λ_2$ pin, y [N]",
    "$λ_3$ guide [N]",
    "$λ_4$ guide [N m]",
    "$λ_5$ string [N]",
)


def build() -> da.System:
    system = da.System("bar, slider and mass", gravity=(0.0, -G))
    bar = system.add(
        planar.Body(
            "bar",
            mass=2.0,
            inertia=0.15,
            angle=-0.9,
            angular_velocity=0.0,
            points={"O": (-TO_BAR, 0), "end": (TO_BAR, 0)},
        )
    )
    slider = system.add(
        planar.Body(
            "slider",
            mass=0.7,
            inertia=0.02,
            position=(0.42, -0.53),
            velocity=(0, 0),
            points={"A": (-A_C2, 0), "B": (C2_B, 0)},
        )
    )
    load = system.add(planar.Particle("load", mass=LOAD, position=(0.45, -1.19), velocity=(0, 0)))
    system.add(planar.Revolute("O", system.ground.center, bar.point("O")))
    system.add(planar.Prismatic("guide", bar.point("O"), slider.point("A")))
    system.add(planar.RigidLink("string", slider.point("B"), load.center, length=STRING))
    spring = planar.Spring(
        "spring", bar.point("O"), slider.point("A"), stiffness=90.0, free_length=0.5
    )
    system.add(spring)
    return system


def pseudo_inverse(view) -> tuple[float, float]:
    """Largest entries of C D and of C E − I at the start."""
    bodies, basis = view.model.equations, view.motion.basis
    (c,) = view.moved([bodies.jacobian])
    d, e = basis.times(ca.SX.eye(3)), basis.opened_times(ca.SX.eye(5))
    parts = [ca.norm_inf(ca.vec(x)) for x in (ca.mtimes(c, d), ca.mtimes(c, e) - ca.SX.eye(5))]
    start = view.model.start
    q, _ = view.reduce.function(0.0, start.y, start.v, [])
    return tuple(float(x) for x in ca.Function("f", [view.equations.y], parts)(q))


def main(folder=None) -> dict[str, float]:
    model = build().build()
    runs = [
        da.solve_dynamics(model, 1.5, step=0.001, coordinates=da.JointCoordinates(reactions=scheme))
        for scheme in ("augmented", "projected")
    ]
    run, projected = runs
    multiplier = run.data.multiplier.values
    along = run["slider.B.position"].values - run["load.position"].values
    pull = LOAD * (run["load.acceleration"].values + np.array([0.0, G]))  # Newton for the mass
    tension = np.sum(pull * along, axis=1) / STRING
    orthogonal, unit = pseudo_inverse(da.JointCoordinates().view(model))
    numbers = {
        "C D": orthogonal,
        "C E − I": unit,
        "λ by (7.13) from λ by (6.3)": float(
            abs(multiplier - projected.data.multiplier.values).max() / abs(multiplier).max()
        ),
        "string force from Newton's law [N]": float(abs(multiplier[:, 4] - tension).max()),
        "smallest string force [N]": float(multiplier[:, 4].min()),
        "energy error [J]": float(abs(run["balance_error"]).max()),
    }
    print(*(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), width_ratios=(1, 1.6))
        for time, alpha in ((0.0, 1.0), (0.4, 0.35)):
            style.draw(left, run, time, alpha)
        left.set(xlabel="x [m]", ylabel="y [m]", title="bar, slider and mass")
        for row, label in zip(multiplier.T, REACTIONS, strict=True):
            right.plot(run.time, row, label=label)
        right.set(xlabel="time [s]", title="reactions, no matrix inverted (7.13)")
        right.legend(ncols=3, fontsize=8, loc="upper center")
        right.set_ylim(top=right.get_ylim()[1] * 1.6)
        style.save(figure, folder, "bar_slider_mass")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
