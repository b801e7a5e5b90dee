"""Mechanisms with rigid contacts, for the laws of impacts and of lasting contact."""

from __future__ import annotations

import functools

import dalembert as da
from dalembert import planar, spatial

STEP_ERROR = ("their estimated error is", "the motion depends on the step of")


def other_warnings(motion: da.Motion) -> list[str]:
    """Warnings of a run with contacts except that of its estimated error."""
    return [text for text in motion.warnings if not any(part in text for part in STEP_ERROR)]


PARAMETERS = {"e": 0.6, "mu": 0.1, "length": 0.5, "spin": 3.0, "height": 0.6, "mass": 2.0}


@functools.cache
def thrown() -> da.Model:
    """Two bars on a hinge that are thrown on a floor."""
    system = da.System("thrown", gravity=(0, -9.81))
    e, mu, length, spin, height, mass = (
        system.parameter(name if name != "e" else "restitution", value)
        for name, value in PARAMETERS.items()
    )
    a = planar.Bar(
        "a",
        length=length,
        mass=mass,
        position=(0, height),
        angle=0.3,
        velocity=(1.0, 0),
        angular_velocity=spin,
    )
    b = planar.Bar("b", length=0.4, mass=1.0, angle=-0.8)
    system.add(a), system.add(b)
    system.add(planar.Revolute("hinge", a.end, b.start))
    for name, tip in (("A", a.start), ("B", a.end), ("C", b.end)):
        system.add(
            planar.UnilateralConstraint(
                name,
                tip.y,
                tip.velocity[0],
                restitution=e,
                friction=mu,
                tangential_restitution=0.1,
            )
        )
    return system.build()


def spun() -> da.Model:
    """A box in space that falls on a corner."""
    system = da.System("spun", gravity=(0, 0, -9.81))
    e, spin = system.parameter("restitution", 0.7), system.parameter("spin", 4.0)
    box = spatial.Body(
        "box",
        mass=1.2,
        inertia=(0.02, 0.03, 0.04),
        position=(0, 0, 0.5),
        rotation=da.rotation.axis_angle((1, 2, 3), 0.7),
        angular_velocity=(spin, 1.0, -2.0),
    )
    system.add(box)
    for k, (x, y, z) in enumerate((i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)):
        corner = box.point(0.1 * x, 0.15 * y, 0.05 * z)
        system.add(
            spatial.UnilateralConstraint(
                f"c{k}", corner.z, corner.velocity[0], restitution=e, friction=0.2
            )
        )
    return system.build()


def ball(gap=None, slip=None, height=1.0, **law):
    system = da.System("ball", gravity=(0, -9.81))
    particle = system.add(planar.Particle("ball", mass=1.0, position=(0, height)))
    gap = particle.y if gap is None else gap(particle)
    slip = None if slip is None else slip(particle)
    if law.get("restitution", 0.5) is None:
        law["restitution"] = system.parameter("e_n", 0.5)
    system.add(planar.UnilateralConstraint("floor", gap, slip, **{"restitution": 0.5} | law))
    return system
