"""Slider-crank turned uniformly: positions, velocities and accelerations in closed form.

Source: any textbook, e.g. R. L. Norton, *Design of Machinery*: ``x = r cos φ + √(l² − r² sin² φ)``;
the derivatives are taken by Taylor arithmetic below.
"""

from __future__ import annotations

import numpy as np

import dalembert as da
from dalembert import planar

R, L, W = 0.1, 0.35, 7.0


def mechanism() -> da.System:
    system = da.System("slider-crank")
    crank = system.add(planar.Bar("crank", length=R, angle=0.3))
    rod = system.add(planar.Bar("rod", length=L, angle=-0.1))
    slider = system.add(planar.Body("slider", angle=0.0))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, slider.center))
    system.add(planar.Prismatic("C", system.ground.point(0, 0), slider.center))
    system.add(planar.RotationalDriver("motor", system.ground, crank, 0.3 + W * da.t))
    return system


def closed_form(time):
    c, s = np.cos(0.3 + W * time), np.sin(0.3 + W * time)
    root = np.sqrt(L**2 - R**2 * s**2)
    root1 = -(R**2) * s * c * W / root
    root2 = -(R**2 * (c**2 - s**2) * W**2 + root1**2) / root
    x = np.stack([R * c + root, -R * W * s + root1, -R * W**2 * c + root2])
    sine = -R * s / L
    cosine = root / L
    rod1 = -R * c * W / (L * cosine)
    rod2 = (R * s * W**2 / L + sine * rod1**2) / cosine
    return x, np.stack([np.arcsin(sine), rod1, rod2])


def test_slider_and_rod():
    motion = da.solve_kinematics(mechanism().build(), 2.0, step=0.004)
    x, rod = closed_form(motion.time)
    for k, (measures, size) in enumerate(
        [
            (("x", "angle"), 1),
            (("vx", "angular_velocity"), W),
            (("ax", "angular_acceleration"), W**2),
        ]
    ):
        np.testing.assert_allclose(motion[f"slider.{measures[0]}"].values, x[k], atol=1e-12 * size)
        np.testing.assert_allclose(motion[f"rod.{measures[1]}"].values, rod[k], atol=1e-12 * size)
