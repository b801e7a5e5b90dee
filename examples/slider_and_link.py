"""Book examples 4.3 and 4.5: slider and link, constraints stated implicitly and explicitly.

The implicit form Φ(y) = 0 describes the prevented motions, and its multipliers are the reactions:
guide force and moment, two components of the pin force. The explicit form y = g(s, φ) describes the
free motions; C D = 0 and C γ = ξ relate the two (4.18)-(4.19). Both have the same motion. The link
falls from the horizontal; momentum and energy determine its speed and the guide force at the lowest
point.
"""

import sys

import casadi as ca
import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar
from dalembert.model.graph.transformation import coordinates_by

M1, M2, J1, J2, G = 2.0, 1.0, 0.02, 0.03, 9.81
A1, B1, A2 = 0.1, 0.1, 0.3  # A C1, C1 B, B C2 [m]
REACTIONS = ("$λ_1$ guide [N]", "$λ_2$ guide [N m]", "$λ_3$ pin, x [N]", "$λ_4$ pin, y [N]")


def build() -> da.System:
    system = da.System("slider and link", gravity=(0.0, -G))
    slider = system.add(
        planar.Body("slider", mass=M1, inertia=J1, position=(A1, 0), angle=0.0, velocity=(0, 0))
    )
    link = system.add(planar.Body("link", mass=M2, inertia=J2, angle=0.0, angular_velocity=0.0))
    system.add(planar.Prismatic("A", system.ground.center, slider.point(-A1, 0)))
    system.add(planar.Revolute("B", slider.point(B1, 0), link.point(-A2, 0)))
    return system


def explicit(e):
    """``y = g(q)`` with q = (s, φ), and with it D and γ (4.15)-(4.17)."""
    q = ca.SX.sym("q", 2)
    s, angle = ca.vertsplit(q)
    pin = s + A1 + B1
    g = ca.vertcat(s + A1, 0, 0, pin + A2 * ca.cos(angle), A2 * ca.sin(angle), angle)
    return coordinates_by(e, g, q)


def explicit_motion(e, times) -> np.ndarray:
    """(4, K) of ``[q; q̇]`` from the two equations ``M' q̈ = f' − d'`` (6.2)."""
    acceleration = ca.solve(e.mass, e.force - e.bias)
    system = {"x": ca.vertcat(e.y, e.v), "ode": ca.vertcat(e.pose_rate, acceleration)}
    run = ca.integrator("run", "cvodes", system, 0, times, {"reltol": 1e-12, "abstol": 1e-12})
    return run(x0=np.zeros(4))["xf"].full()


def identities(e, motion, state) -> tuple[float, float]:
    """Largest entries of C D and C γ − ξ along a motion."""
    c, xi = (motion.seen(e, x) for x in (e.jacobian, e.constraint_acceleration))
    parts = [ca.mtimes(c, motion.basis), ca.mtimes(c, motion.gamma) - xi]
    function = ca.Function("f", [motion.y, motion.v], [ca.norm_inf(ca.vec(x)) for x in parts])
    return tuple(float(abs(x.full()).max()) for x in function(state[:2], state[2:]))


def main(folder=None) -> dict[str, float]:
    model = build().build()
    lowest = da.Event(model["link.angle"] + np.pi / 2)
    run = da.solve_dynamics(model, 1.5, step=0.001, events={"lowest": lowest})
    motion = explicit(model.equations)
    state = explicit_motion(motion.apply(model.equations).with_rows([]), run.time)
    free = np.stack([run["slider.x"] - A1, run["link.angle"]])
    orthogonal, second = identities(model.equations, motion, state)
    at_lowest = run.at([run.events[0].time])
    numbers = {
        "C D": orthogonal,
        "C γ − ξ": second,
        "implicit against explicit": float(abs(free - state[:2]).max()),
        "angular velocity at the lowest point [rad/s]": float(
            at_lowest["link.angular_velocity"][0]
        ),
        "guide force at the lowest point [N]": float(-at_lowest.data.multiplier.values[0, 0]),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), width_ratios=(1, 1.6))
        for time in (0.0, 0.2, 0.3):
            style.draw(left, run, time, alpha=0.4 + 2 * time)
        left.set(xlabel="x [m]", ylabel="y [m]", title="the link falls")
        for row, label in zip(run.data.multiplier.values.T, REACTIONS, strict=True):
            right.plot(run.time, row, label=label)
        right.set(
            xlabel="time [s]", title="multipliers are joint forces and moments", ylim=(-55, 22)
        )
        right.legend(loc="upper center", ncols=4, fontsize=8)
        style.save(figure, folder, "slider_and_link")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
