"""Systems in which every number is a parameter."""

from __future__ import annotations

from dataclasses import dataclass

from twins import CENTER, turn

import dalembert as da
from dalembert import planar, spatial

GRAVITY = (0.4, -9.81, 1.7)


@dataclass(frozen=True)
class Observer:
    """Turns, shifts and boosts the whole mechanism; nothing inside it may notice."""

    angle: float = 0.0
    shift: tuple[float, float] = (0.0, 0.0)
    boost: tuple[float, float] = (0.0, 0.0)


MOMENTS = (1.0, 1.2, 0.7, 0.1, -0.2, 0.15)
"""Moments and products of inertia of bodies in space, to scale."""
AXES = {"a": (0.3, -0.5, 1.0), "b": (1.0, 0.4, 0.2), "arm": (-0.2, 1.0, 0.3)}
"""About which they are turned at first."""


class Builder:
    """A system in which every number is a parameter."""

    def __init__(self, name: str, gravity: bool, observer: Observer, dimension: int = 2):
        self.observer, self.system = observer, da.System(name)
        if gravity:
            vector = self.numbers(
                **dict(zip(("gx", "gy", "gz")[:dimension], GRAVITY, strict=False))
            )
            self.system = da.System(name, gravity=vector)
            for parameter in vector:
                self.system.parameters[parameter.name] = parameter
        self.ground = self.system.ground

    def number(self, name: str, value: float):
        return self.system.parameter(name, value)

    def numbers(self, **values: float) -> tuple:
        return tuple(self.number(n, v) for n, v in values.items())

    def point(self, body, name: str, x: float, y: float):
        """Point of a body at parametric body coordinates ``<name>_x``, ``<name>_y``."""
        return body.point(*self.numbers(**{f"{name}_x": x, f"{name}_y": y}))

    def body(self, name: str, pose, speed, mass=1.3, inertia=0.21, kind=planar.Body, **more):
        place = turn(self.observer.angle, pose[:2]) + self.observer.shift
        speeds = turn(self.observer.angle, speed[:2]) + self.observer.boost
        arguments = {
            "mass": self.number(f"{name}_m", mass),
            "position": self.numbers(**{f"{name}_x0": place[0], f"{name}_y0": place[1]}),
            "velocity": self.numbers(**{f"{name}_vx0": speeds[0], f"{name}_vy0": speeds[1]}),
        }
        if not issubclass(kind, planar.Particle):
            angle = pose[2] + self.observer.angle
            arguments["angle"] = self.number(f"{name}_angle0", angle)
            arguments["angular_velocity"] = self.number(f"{name}_w0", speed[2])
            if inertia is not None:
                arguments["inertia"] = self.number(f"{name}_J", inertia)
        return self.add(kind(name, **arguments, **more))

    def pair(self, b=(1.1, 0.5, -0.6)):
        """Two free bodies in general position."""
        return (
            self.body("a", (0.3, -0.2, 0.4), (0.5, -0.3, 0.7)),
            self.body("b", b, (-0.2, 0.4, -1.1), 0.8, 0.13),
        )

    def points(self):
        """A point on each of two free bodies: ``P`` on a, ``Q`` on b."""
        a, b = self.pair()
        return self.point(a, "P", 0.31, 0.12), self.point(b, "Q", -0.22, 0.17)

    def add(self, element):
        return self.system.add(element)

    # in space -----------------------------------------------------------------------------------
    def solid(self, name: str, place, turned, speed, spin, mass=1.3, size=0.2):
        """A free body whose mass centre is not its origin; ``turned`` about ``AXES[name]``."""
        angle, away = self.number(f"{name}_turn0", turned), self.number(f"{name}_c", 1.0)
        moment = self.number(f"{name}_J", size)
        return self.add(
            spatial.Body(
                name,
                mass=self.number(f"{name}_m", mass),
                inertia=[moment * share for share in MOMENTS],
                center_of_mass=[away * share for share in CENTER],
                position=self.numbers(**_components(f"{name}_{{}}0", place)),
                rotation=da.rotation.axis_angle(AXES[name], angle),
                velocity=self.numbers(**_components(f"{name}_v{{}}0", speed)),
                angular_velocity=self.numbers(**_components(f"{name}_w{{}}0", spin)),
            )
        )

    def solids(self, b=(0.9, 0.5, -0.4)):
        """Two free bodies in general position."""
        return (
            self.solid("a", (0.3, -0.2, 0.1), 0.4, (0.5, -0.3, 0.2), (0.7, 0.2, -0.4)),
            self.solid("b", b, -0.3, (-0.2, 0.4, 0.1), (-0.3, 0.5, 0.6), 0.8, 0.13),
        )

    def spot(self, body, name: str, place):
        """Point of a body at parametric coordinates ``<name>_x``, ``<name>_y``, ``<name>_z``."""
        return body.point(*self.numbers(**_components(f"{name}_{{}}", place)))

    def spots(self):
        """A point on each of two free bodies: ``P`` on a, ``Q`` on b."""
        a, b = self.solids()
        return self.spot(a, "P", (0.31, 0.12, -0.2)), self.spot(b, "Q", (-0.22, 0.17, 0.1))

    def hold(self, body, name: str, place, axis, x=None):
        """Frame of a body: parametric place, axis ``<name>_z…`` and x axis ``<name>_x…``."""
        arguments = {"axis": self.numbers(**_components(f"{name}_z{{}}", axis))}
        if x is not None:
            arguments["x"] = self.numbers(**_components(f"{name}_x{{}}", x))
        return body.frame(self.numbers(**_components(f"{name}_o{{}}", place)), **arguments)

    def holds(self, complete: bool = True, axis=(0.2, 0.4, 1.1), x=(0.9, 0.3, 0.1)):
        """A frame on each of two free bodies, ``P`` on a and ``Q`` on b, with x axes or without."""
        a, b = self.solids()
        return (
            self.hold(
                a, "P", (0.31, 0.12, -0.2), (0.3, -0.2, 1.2), (1.1, 0.2, 0.3) if complete else None
            ),
            self.hold(b, "Q", (-0.22, 0.17, 0.1), axis, x if complete else None),
        )


def _components(pattern: str, vector) -> dict[str, float]:
    return {pattern.format(letter): value for letter, value in zip("xyz", vector, strict=True)}
