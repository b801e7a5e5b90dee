"""Book example 4.1: a particle on a spring, its Cartesian equations in spherical coordinates.

With y = g(r, θ, φ) the equations m ÿ = f become M' q̈ + d' = f', where M' = Bᵀ m B, d' = Bᵀ m γ and
f' = Bᵀ f (4.8)-(4.11). A spring without free length draws an ellipse, known in closed form.
"""

import sys

import casadi as ca
import matplotlib.pyplot as plt
import numpy as np
import style

from dalembert.model.graph.equations import Equations
from dalembert.model.graph.inertia import BlockInertia
from dalembert.model.graph.transformation import change_coordinates

MASS, STIFFNESS = 0.5, 8.0
POSITION, VELOCITY = np.array([1.0, 0.2, 0.6]), np.array([-0.5, 2.2, 1.0])


def cartesian() -> Equations:
    """``m ÿ = −k y`` with y = (x, y, z), v = ẏ."""
    y, v, a = (ca.SX.sym(name, 3) for name in ("y", "v", "a"))
    none = ca.SX(0, 1)
    return Equations(
        t=ca.SX.sym("t"),
        y=y,
        v=v,
        p=none,
        a=a,
        multiplier=none,
        pose_rate=v,
        inertia=BlockInertia(MASS * ca.SX.eye(3)),
        bias=ca.SX.zeros(3),
        force=-STIFFNESS * y,
        constraints=none,
        potential=STIFFNESS * ca.sumsqr(y) / 2,
        powers=ca.SX.zeros(2),
    )


def from_spherical(q):
    """g(q): r, θ from the z axis, φ around it."""
    r, polar, around = ca.vertsplit(q)
    flat = ca.sin(polar)
    return r * ca.vertcat(flat * ca.cos(around), flat * ca.sin(around), ca.cos(polar))


def to_spherical(place) -> np.ndarray:
    x, y, z = place
    return np.array([np.hypot(np.hypot(x, y), z), np.arctan2(np.hypot(x, y), z), np.arctan2(y, x)])


def ellipse(times) -> np.ndarray:
    """(3, K) the exact motion."""
    rate = np.sqrt(STIFFNESS / MASS)
    return (
        np.outer(POSITION, np.cos(rate * times)) + np.outer(VELOCITY, np.sin(rate * times)) / rate
    )


def spherical_motion(e: Equations, times) -> tuple[np.ndarray, np.ndarray]:
    """(6, K) coordinates and speeds ``[q; q̇]``, and (K,) energy."""
    acceleration = ca.solve(e.mass, e.force - e.bias)
    system = {"x": ca.vertcat(e.y, e.v), "ode": ca.vertcat(e.pose_rate, acceleration)}
    accuracy = {"reltol": 1e-12, "abstol": 1e-12, "max_num_steps": 100_000}
    run = ca.integrator("run", "cvodes", system, 0, times, accuracy)
    start = to_spherical(POSITION)
    q = ca.SX.sym("q", 3)
    basis = ca.Function("B", [q], [ca.jacobian(from_spherical(q), q)])
    speeds = np.linalg.solve(basis(start).full(), VELOCITY)
    state = run(x0=np.concatenate([start, speeds]))["xf"].full()
    energy = ca.Function("E", [e.y, e.v], [e.kinetic_energy + e.potential])
    return state, energy(state[:3], state[3:]).full().ravel()


def main(folder=None) -> dict[str, float]:
    times = np.linspace(0, 4, 401)
    q = ca.SX.sym("q", 3)
    e = change_coordinates(cartesian(), from_spherical(q), q)
    state, energy = spherical_motion(e, times)
    place = ca.Function("g", [q], [from_spherical(q)])(state[:3]).full()
    exact = ellipse(times)
    numbers = {
        "largest error [m]": float(abs(place - exact).max()),
        "energy drift [J]": float(np.ptp(energy)),
        "r(4 s) [m]": float(state[0, -1]),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure = plt.figure(figsize=(9, 3.4))
        left = figure.add_subplot(1, 2, 1, projection="3d")
        right = figure.add_subplot(1, 2, 2)
        left.plot(*exact, color=style.GREY, lw=4, alpha=0.3, label="closed form")
        left.plot(*place, color=style.BLUE, label="from spherical equations")
        left.plot(0, 0, 0, "o", color=style.ORANGE, ms=4)
        left.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]", title="an ellipse in space")
        left.legend(loc="upper left", fontsize=8)
        for row, label in zip(state, ("r [m]", "θ [rad]", "φ [rad]"), strict=False):
            right.plot(times, row, label=label)
        for row, colour in zip(np.unwrap(to_spherical(exact)), style.COLOURS, strict=False):
            right.plot(times[::20], row[::20], "o", ms=3, color=colour, mfc="none")
        right.set(xlabel="time [s]", title="spherical coordinates, points: closed form")
        right.legend(loc="upper left")
        style.save(figure, folder, "spherical_particle")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
