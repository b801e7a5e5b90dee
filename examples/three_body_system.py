"""Book examples 6.1 and 6.3: three bodies, three joint coordinates, three derivations.

A bar on a pin, a slider on the bar held by a spring, a second bar hanging from the slider. In the
joint coordinates q = (φ, s, θ) of Fig. 6.1b the library computes M̄ = DᵀMD, d̄ = Dᵀ(Mγ + d), f̄ =
Dᵀf (6.2); by hand they fill a page. The Gibbs-Appell function yields them by differentiation
(6.13).
"""

import sys

import casadi as ca
import matplotlib.pyplot as plt
import numpy as np
import style
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar
from dalembert.model.graph.derivation import gibbs_appell
from dalembert.model.graph.transformation import coordinates_by

G, K, FREE = 9.81, 60.0, 0.5
M1, M2, M3, J1, J2, J3 = 2.0, 0.8, 1.1, 0.12, 0.01, 0.05
A1, A2, A3 = 0.4, 0.1, 0.3  # O C1, C2 A, A C3 [m]


def build() -> da.System:
    system = da.System("three bodies", gravity=(0.0, -G))
    bar = system.add(
        planar.Body(
            "bar",
            mass=M1,
            inertia=J1,
            angle=-0.6,
            angular_velocity=0.0,
            points={"O": (-A1, 0), "end": (0.6, 0)},
        )
    )
    slider = system.add(
        planar.Body("slider", mass=M2, inertia=J2, position=(0.45, -0.3), velocity=(0, 0))
    )
    rod = system.add(
        planar.Body(
            "rod",
            mass=M3,
            inertia=J3,
            angle=-1.2,
            angular_velocity=0.0,
            points={"A": (-A3, 0), "tip": (A3, 0)},
        )
    )
    pin = system.ground.center
    system.add(planar.Revolute("O", pin, bar.point("O")))
    system.add(planar.Prismatic("guide", bar.point("O"), slider.center))
    system.add(planar.Revolute("A", slider.point(A2, 0), rod.point("A")))
    system.add(planar.Spring("spring", pin, slider.center, stiffness=K, free_length=FREE))
    return system


def by_hand(q, u):
    """M̂, d̂ and f̂, from the accelerations of the mass centres in the axes of the bar."""
    (phi, s, theta), (w, ds, turn) = q, u
    r, c3, s3 = s + A2, A3 * np.cos(theta - phi), A3 * np.sin(theta - phi)
    mass = np.array(
        [
            [J1 + M1 * A1**2 + J2 + M2 * s**2 + M3 * r**2, 0, M3 * r * c3],
            [0, M2 + M3, -M3 * s3],
            [M3 * r * c3, -M3 * s3, J3 + M3 * A3**2],
        ]
    )
    bias = np.array(
        [
            2 * M2 * s * ds * w + M3 * r * (2 * ds * w - turn**2 * s3),
            -(M2 * s + M3 * r) * w**2 - M3 * turn**2 * c3,
            M3 * (r * w**2 * s3 + 2 * ds * w * c3),
        ]
    )
    force = np.array(
        [
            -G * np.cos(phi) * (M1 * A1 + M2 * s + M3 * r),
            -G * np.sin(phi) * (M2 + M3) - K * (s - FREE),
            -G * np.cos(theta) * M3 * A3,
        ]
    )
    return mass, bias, force


def motion_by_hand(q, times) -> np.ndarray:
    """(6, K) of ``[q; q̇]`` from the equations above, by another integrator."""

    def rate(_, x):
        mass, bias, force = by_hand(x[:3], x[3:])
        return np.concatenate([x[3:], np.linalg.solve(mass, force - bias)])

    start = np.concatenate([q, np.zeros(3)])
    return solve_ivp(rate, times[[0, -1]], start, "DOP853", times, rtol=1e-12, atol=1e-12).y


def differences(view, states) -> tuple[float, float]:
    """Along a motion: M̄, d̄, f̄ from those by hand, and the Gibbs-Appell equations from these."""
    e, bodies = view.equations, view.model.equations
    transformation = coordinates_by(bodies, view.motion.pose, e.y, e.v)
    appell = gibbs_appell(bodies, transformation)
    parts = ca.Function("f", [e.y, e.v], [e.mass, e.bias, e.force])
    derived = ca.Function("S", [e.y, e.v, transformation.a], [appell])
    worst, second = 0.0, 0.0
    for q, u in zip(states[:3].T, states[3:].T, strict=True):
        mass, bias, force = by_hand(q, u)
        found = [x.full().squeeze() for x in parts(q, u)]
        worst = max(
            worst, *(abs(a - b).max() for a, b in zip(found, (mass, bias, force), strict=True))
        )
        any_rates = np.array([0.6, -1.1, 2.3])
        left = derived(q, u, any_rates).full().ravel()
        second = max(second, abs(left - (mass @ any_rates + bias - force)).max())
    return worst, second


def main(folder=None) -> dict[str, float]:
    model = build().build()
    coordinates = da.JointCoordinates(angles="absolute")
    run = da.solve_dynamics(
        model,
        2.0,
        coordinates=coordinates,
        integrator=da.DormandPrince853(1e-11, 1e-11),
        outputs=201,
    )
    relative = da.solve_dynamics(
        model, 2.0, coordinates=da.JointCoordinates(), integrator=run.analysis.integrator
    )
    slide = np.hypot(run["slider.x"], run["slider.y"])
    found = np.stack([run["bar.angle"], slide, run["rod.angle"]])
    states = motion_by_hand(found[:, 0], run.time)
    hand, appell = differences(coordinates.view(model), states)
    numbers = {
        "M̄, d̄, f̄ from those by hand": float(hand),
        "Gibbs-Appell from those by hand": float(appell),
        "motion from that by hand": float(abs(found - states[:3]).max()),
        "relative from absolute angles": float(
            abs(relative["rod.angle"][-1] - run["rod.angle"][-1])
        ),
        "energy error [J]": float(abs(run["balance_error"]).max()),
    }
    print(*(f"{name}: {value:.3g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), width_ratios=(1, 1.5))
        for time, alpha in ((0.0, 0.35), (0.3, 0.6), (0.6, 1.0)):
            style.draw(left, run, time, alpha)
        left.set(xlabel="x [m]", ylabel="y [m]", title="three bodies fall")
        right.plot(run.time, run["bar.angle"], label="φ bar [rad]")
        right.plot(run.time, run["rod.angle"], label="θ rod [rad]")
        right.plot(run.time, slide, label="s slider [m]")
        right.set(xlabel="time [s]", title="joint coordinates", ylim=(-2.9, 2))
        right.legend(ncols=3, loc="upper center")
        style.save(figure, folder, "three_body_system")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
