"""The mechanisms, and where their observed points are by somebody else's account if there is one.

Data of the double four-bar, Bricard's mechanism and the slider–crank: IFToMM library of
computational benchmark problems.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.mechanism import GROUND, Body, Joint, Mechanism, along

GRAVITY = 9.81


def rod(x: float, y: float, angle: float, velocity=(0.0, 0.0), spin: float = 0.0) -> Body:
    """A uniform rod of 1 m and 1 kg in the plane."""
    c, s = math.cos(angle), math.sin(angle)
    axes = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    return Body(1.0, (1e-3, 1 / 12, 1 / 12), (x, y, 0), axes, (*velocity, 0), (0, 0, spin))


def pin(first: int, second: int, x: float, y: float) -> Joint:
    return Joint("revolute", first, second, (x, y, 0.0))


def pendulum() -> tuple[Mechanism, np.ndarray]:
    """A rod released level; its end after 2 s by the equation of its angle."""
    made = Mechanism(
        "pendulum",
        (0, -GRAVITY, 0),
        [rod(0.5, 0.0, 0.0)],
        [pin(GROUND, 0, 0.0, 0.0)],
        (0, (1, 0, 0)),
        planar=True,
    )
    return made, _angle(lambda q: -1.5 * GRAVITY * math.cos(q), 0.0, 0.0, 2.0)


def four_bars(count: int) -> tuple[Mechanism, np.ndarray]:
    """N four-bars in a row, all cranks upright; the top of the first after 1 s, exactly.

    ``[(N+1)/3 + N] φ̈ = −[(N+1)/2 + N] g cos φ``.
    """
    bodies, joints, last = [], [], GROUND
    for i in range(count + 1):
        crank = len(bodies)
        bodies.append(rod(i, 0.5, math.pi / 2, (0.5, 0.0), -1.0))
        joints.append(pin(GROUND, crank, i, 0.0))
        if last != GROUND:
            bodies.append(rod(i - 0.5, 1.0, 0.0, (1.0, 0.0)))
            joints += [pin(last, crank + 1, i - 1, 1.0), pin(crank + 1, crank, i, 1.0)]
        last = crank
    name = "four-bar" if count == 1 else f"{count} four-bars"
    made = Mechanism(name, (0, -GRAVITY, 0), bodies, joints, (0, (0, 1, 0)), planar=True)
    ratio = ((count + 1) / 2 + count) / ((count + 1) / 3 + count)
    return made, _angle(lambda q: -ratio * GRAVITY * math.cos(q), math.pi / 2, -1.0, 1.0)


def _angle(acceleration, start: float, speed: float, end: float) -> np.ndarray:
    """End of a rod of 1 m whose angle follows an equation."""
    done = solve_ivp(
        lambda t, s: [s[1], acceleration(s[0])],
        (0, end),
        [start, speed],
        method="DOP853",
        rtol=1e-13,
        atol=1e-14,
    )
    return np.array([math.cos(done.y[0, -1]), math.sin(done.y[0, -1]), 0.0])


def bricard() -> tuple[Mechanism, np.ndarray]:
    """Five rods and the ground on six hinges; one equation is redundant. The point after 1 s."""
    points = np.array([(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)], float)
    axes = [(0, 1, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0)]
    bodies = []
    for start, end in pairwise(points):
        inertia = np.where(np.abs(end - start) > 0.5, 1 / 600, 1.01 / 12)
        bodies.append(Body(1.0, tuple(inertia), tuple((start + end) / 2)))
    joints = [
        Joint("revolute", k - 1 if k else GROUND, k if k < 5 else GROUND, points[k], along(axes[k]))
        for k in range(6)
    ]
    made = Mechanism("Bricard", (0, -GRAVITY, 0), bodies, joints, (1, points[2]), redundant=True)
    return made, np.array([0.2744813193, -0.8867079387, -0.4623300027])


def slider_crank() -> tuple[Mechanism, np.ndarray]:
    """Spatial slider–crank; the slider after 1 s by the equation of its one freedom."""
    pivot, tip, slider = np.array([0, 0.1, 0.12]), np.array([0, 0.1, 0.2]), np.array([0.2, 0, 0])
    way = (slider - tip) / 0.3
    across = np.cross((1, 0, 0), way)
    across /= np.linalg.norm(across)
    bodies = [
        Body(0.12, (1e-4, 1e-5, 1e-4), (pivot + tip) / 2, velocity=(0, -0.24, 0), spin=(6, 0, 0)),
        Body(
            0.5,
            (4e-4, 4e-3, 4e-3),
            (tip + slider) / 2,
            np.column_stack([way, np.cross(across, way), across]),
            (0.12, -0.24, 0),
            (1.92, -0.96, 0.48),
        ),
        Body(2.0, (1e-4, 1e-4, 1e-4), slider, velocity=(0.24, 0, 0)),
    ]
    cross = np.column_stack([across, (1, 0, 0), np.cross(across, (1, 0, 0))])
    joints = [
        Joint("revolute", GROUND, 0, pivot, along((1, 0, 0))),
        Joint("spherical", 0, 1, tip),
        Joint("universal", 1, 2, slider, cross),
        Joint("prismatic", GROUND, 2, slider, along((1, 0, 0))),
    ]
    made = Mechanism("slider-crank", (0, 0, -GRAVITY), bodies, joints, (2, slider))
    return made, np.array([0.211721661394, 0.0, 0.0])


def chain(count: int) -> Mechanism:
    """Bodies of 1 m and 1 kg on hinges about y and z in turn, released stretched along x."""
    bodies = [Body(1.0, (0.01, 0.02, 0.015), (k + 0.5, 0, 0)) for k in range(count)]
    joints = [
        Joint("revolute", k - 1, k, (k, 0, 0), along(((0, 1, 0), (0, 0, 1))[k % 2]))
        for k in range(count)
    ]
    name = "7-link arm" if count == 7 else f"{count}-link chain"
    return Mechanism(name, (0, 0, -GRAVITY), bodies, joints, (count - 1, (count, 0, 0)))


def loop(count: int) -> Mechanism:
    """Rods on ball joints from wall to wall, along a bow that leans; its middle falls."""
    angles = np.linspace(0.0, math.pi, count + 1)
    points = np.column_stack([-np.cos(angles), 0.4 * np.sin(angles), 0.8 * np.sin(angles)])
    bodies = []
    for start, end in pairwise(points):
        length = np.linalg.norm(end - start)
        axes = along(end - start)[:, [2, 0, 1]]
        inertia = (0.02 * length**2, length**2 / 12, length**2 / 12)
        bodies.append(Body(1.0, inertia, (start + end) / 2, axes))
    joints = [
        Joint("spherical", k - 1, k if k < count else GROUND, points[k]) for k in range(count + 1)
    ]
    middle = count // 2
    return Mechanism(f"loop of {count}", (0, 0, -GRAVITY), bodies, joints, (middle, points[middle]))
