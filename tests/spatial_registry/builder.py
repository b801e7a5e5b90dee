"""Systems in space in which every number is a parameter."""

from __future__ import annotations

import numpy as np

import dalembert as da
from dalembert import spatial


class Builder:
    """A system in which every number is a parameter."""

    def __init__(self, name: str, gravity: bool = True):
        self.system = da.System(name)
        if gravity:
            vector = self.vector("g", (0.4, -0.7, -9.6))
            self.system = da.System(name, gravity=vector)
            for parameter in vector:
                self.system.parameters[parameter.name] = parameter

    def number(self, name: str, value: float):
        return self.system.parameter(name, value)

    def vector(self, name: str, values) -> tuple:
        return tuple(self.number(f"{name}_{k}", x) for k, x in zip("xyzuvw", values, strict=False))

    def solid(self, name, place, turn, velocity, spin, kind=spatial.Body, **more):
        arguments = {
            "position": self.vector(f"{name}_r0", place),
            "velocity": self.vector(f"{name}_v0", velocity),
        }
        if kind is not spatial.Particle:
            size = float(np.linalg.norm(turn))
            axis = self.vector(f"{name}_n0", np.array(turn) / size)
            angle = self.number(f"{name}_angle0", size)
            arguments["rotation"] = da.rotation.axis_angle(axis, angle)
            arguments["angular_velocity"] = self.vector(f"{name}_w0", spin)
        return self.system.add(kind(name, **arguments, **more))

    def body(self, name, place, turn, velocity, spin, mass=1.3):
        moments = np.array([0.21, 0.17, 0.13, 0.02, -0.01, 0.03]) * mass
        return self.solid(
            name,
            place,
            turn,
            velocity,
            spin,
            mass=self.number(f"{name}_m", mass),
            inertia=self.vector(f"{name}_J", moments),
            center_of_mass=self.vector(f"{name}_c", (0.03, -0.02, 0.04)),
        )

    def pair(self):
        """Two free bodies in general position."""
        return (
            self.body("a", (0.3, -0.2, 0.1), (0.4, -0.3, 0.6), (0.5, -0.3, 0.2), (0.7, -0.4, 0.3)),
            self.body(
                "b", (1.1, 0.5, -0.3), (-0.3, 0.5, 0.2), (-0.2, 0.4, 0.1), (-1.1, 0.3, 0.5), 0.8
            ),
        )

    def points(self):
        """A point on each of two free bodies: ``P`` on a, ``Q`` on b."""
        a, b = self.pair()
        return a.point(*self.vector("P", (0.31, 0.12, -0.2))), b.point(
            *self.vector("Q", (-0.22, 0.17, 0.05))
        )

    def frames(self):
        """A frame on each of two free bodies."""
        a, b = self.pair()
        return (
            a.frame(
                self.vector("P", (0.31, 0.12, -0.2)),
                axis=self.vector("axis_i", (0.2, 0.3, 1.1)),
                x=self.vector("x_i", (1.0, 0.1, 0.2)),
            ),
            b.frame(
                self.vector("Q", (-0.22, 0.17, 0.05)),
                rotation=da.rotation.bryant(*self.vector("turn_j", (0.3, 0.2, -0.1))),
            ),
        )

    def hinge(self):
        """Two bodies on a hinge."""
        return self.system.add(spatial.Revolute("J", *self.frames()))

    def add(self, element):
        return self.system.add(element)
