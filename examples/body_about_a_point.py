"""Book example 4.2: a body in free flight, its equations in a frame fixed to it at any point A.

First the coordinates of the centre C are replaced by those of A, then their rates by the velocity
of A in body axes. These are quasi-velocities, which are not rates of coordinates. The mass matrix
is full and d' does not vanish, but C follows its parabola.
"""

import sys

import casadi as ca
import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.transformation import change_coordinates, change_speeds

XI, ETA = 0.45, -0.1  # C in the frame at A [m]
MASS, INERTIA, G = 2.0, 0.15, 9.81
CENTRE, THROWN, ANGLE, SPIN = np.array([0.0, 0.5]), np.array([2.0, 5.5]), 0.4, 7.0


def build() -> da.System:
    system = da.System("thrown body", gravity=(0.0, -G))
    system.add(planar.Body("body", mass=MASS, inertia=INERTIA, position=(0, 0), angle=0.0))
    return system


def about_point(e: Equations) -> Equations:
    """From (x_C, y_C, θ) and their rates to (x_A, y_A, θ) and (v_Aξ, v_Aη, ω)."""
    place = ca.SX.sym("place", 3)
    c, s = ca.cos(place[2]), ca.sin(place[2])
    turned = ca.blockcat([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    centre = place + ca.mtimes(turned, ca.DM([XI, ETA, 0]))
    return change_speeds(change_coordinates(e, centre, place), turned, ca.SX.sym("u", 3))


def turn(angle, vector) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])


def flight(times) -> tuple[np.ndarray, np.ndarray]:
    """(2, K) places of C and A in closed form: a parabola and a steady spin."""
    centre = CENTRE[:, None] + np.outer(THROWN, times) + np.outer([0, -G / 2], times**2)
    angle = ANGLE + SPIN * times
    return centre, centre - turn(angle, (np.full_like(times, XI), np.full_like(times, ETA)))


def motion_about_point(e: Equations, times) -> np.ndarray:
    """(6, K) of ``[y'; v']``, started as the body was thrown."""
    acceleration = ca.solve(e.mass, e.force - e.bias)
    system = {"x": ca.vertcat(e.y, e.v), "ode": ca.vertcat(e.pose_rate, acceleration)}
    run = ca.integrator("run", "cvodes", system, 0, times, {"reltol": 1e-12, "abstol": 1e-12})
    place = CENTRE - turn(ANGLE, (XI, ETA))
    velocity = turn(-ANGLE, THROWN) - SPIN * np.array([-ETA, XI])  # v_A = v_C − ω × ρ, body axes
    return run(x0=[*place, ANGLE, *velocity, SPIN])["xf"].full()


def main(folder=None) -> dict[str, float]:
    times = np.linspace(0, 1.2, 241)
    e = about_point(build().build().equations)
    state = motion_about_point(e, times)
    centre, point = flight(times)
    mass = ca.Function("M", [e.y, e.p], [ca.densify(e.mass)])(state[:3, 0], []).full()
    numbers = {
        "largest error of A [m]": float(abs(state[:2] - point).max()),
        "moment of inertia about A [kg m^2]": float(mass[2, 2]),
        "angular velocity at the end [rad/s]": float(state[5, -1]),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4))
        left.plot(*state[:2], label="A, from quasi-velocities", color=style.BLUE)
        left.plot(*point[:, ::12], "o", ms=3, mfc="none", color=style.BLUE, label="A, closed form")
        left.plot(*centre, "--", color=style.ORANGE, label="C, a parabola", lw=1.2)
        for k in range(0, 241, 24):
            left.plot(*np.stack([state[:2, k], centre[:, k]], axis=1), color=style.GREY, lw=0.8)
        left.set(xlabel="x [m]", ylabel="y [m]", title="thrown body")
        left.set_aspect("equal", adjustable="datalim")
        left.legend(fontsize=8)
        for row, label in zip(state[3:5], ("$v_{Aξ}$", "$v_{Aη}$"), strict=True):
            right.plot(times, row, label=label)
        right.set(xlabel="time [s]", ylabel="[m/s]", title="velocity of A along the body's axes")
        right.legend(loc="upper right")
        style.save(figure, folder, "body_about_a_point")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
