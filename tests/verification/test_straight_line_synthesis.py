"""Four-bar through six points on a line, timing free: the case of Cabrera et al. (2002).

The coupler point passes (20, 20), (20, 25) … (20, 45). Best published sum of squared distances:
4.077e-5, recomputed from the design of Itani (IMECE2019-10262).
"""

from __future__ import annotations

import itertools
import math

import pytest

import dalembert as da
from dalembert import planar

ANGLES = [f"theta{k}" for k in range(6)]


def law(angles: list):
    """Polynomial in time through the crank angles at 0, 1 … 5."""
    total = 0
    for k, angle in enumerate(angles):
        share = math.prod([(da.t - j) / (k - j) for j in range(6) if j != k], start=1)
        total = total + angle * share
    return total


def build() -> da.Model:
    system = da.System("six points on a line")
    start = {
        "g": 20,
        "d": 8,
        "c": 25,
        "f": 25,
        "l": 45,
        "x0": 58,
        "y0": 15,
        "eta": 0,
        "gamma": 1.57,
    }
    bounds = dict.fromkeys("gdcf", (5, 60)) | {"l": (0, 85), "x0": (-60, 60), "y0": (-60, 60)}
    bounds |= {"eta": (-math.pi, math.pi), "gamma": (0, 2 * math.pi)}
    p = {n: system.parameter(n, v, bounds=bounds[n]) for n, v in start.items()}
    angles = [
        system.parameter(name, 3.95 - 0.35 * k, bounds=(-2 * math.pi, 4 * math.pi))
        for k, name in enumerate(ANGLES)
    ]
    cos, sin = da.cos, da.sin
    crank = system.add(planar.Bar("crank", length=p["d"], angle=angles[0]))
    point = (p["l"] * cos(p["eta"]) - p["c"] / 2, p["l"] * sin(p["eta"]))
    coupler = system.add(planar.Bar("coupler", length=p["c"], angle=2.9, points={"P": point}))
    follower = system.add(planar.Bar("follower", length=p["f"], angle=2.2))
    base = system.ground.point(p["x0"], p["y0"])
    other = system.ground.point(
        p["x0"] + p["g"] * cos(p["gamma"]), p["y0"] + p["g"] * sin(p["gamma"])
    )
    system.add(planar.Revolute("O", base, crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, follower.end))
    system.add(planar.Revolute("C", other, follower.start))
    system.add(planar.RotationalDriver("motor", system.ground, crank, law(angles)))
    return system.build()


@pytest.mark.thorough
def test_straight_line():
    """The crank can turn, the order of the points is kept, and the sum beats the best printed."""
    model, far = build(), math.radians(3)
    points = [da.at(float(k), f"coupler.P.{u}", name=f"{u}{k}") for k in range(6) for u in "xy"]
    targets = [v for k in range(6) for v in (20.0, 20.0 + 5 * k)]
    squares = da.SumOfSquares(points, targets, name="squared distances")
    grashof = ("c + f - d - g", "g + f - d - c", "g + c - d - f")
    order = [f"{a} - {b}" for a, b in itertools.pairwise(ANGLES)]
    limits = [da.Limit(da.final(one), lower=0.0) for one in grashof]
    limits += [da.Limit(da.final(one), lower=far) for one in order]
    limits.append(da.Limit(da.final("theta0 - theta5"), upper=2 * math.pi))
    best = da.optimize(
        model,
        squares,
        subject_to=limits,
        analysis=da.Kinematics(duration=5.0, outputs=6),
        vary=list(model.parameters),
        tolerance=1e-6,
        max_iterations=100,
    )
    assert best.fun <= 4.1e-5, best
    assert best.violation <= 1e-6
    assert best.motion.status.success
