"""One small model with one element in general position, and its NumPy twin."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

import dalembert as da
from registry.builder import Builder, Observer


def P(c) -> np.ndarray:
    """Place of the point P of body a."""
    return c.a.at((c.p.P_x, c.p.P_y))


def Q(c) -> np.ndarray:
    """Place of the point Q of body b."""
    return c.b.at((c.p.Q_x, c.p.Q_y))


@dataclass(frozen=True)
class Case:
    """One small model and its twin.

    Attributes
    ----------
    covers : classes this case stands for
    build : adds the elements to a builder
    residual : twin of all constraint equations, in the order of the model
    loads : twin of all applied forces but gravity: list of (body, force, place, moment)
    place : joint → twin of the place where its reaction is reported
    objective : moving the whole mechanism changes nothing inside
    scleronomic : no driver works on it
    conservative : at rest, the forces are −∂V/∂y
    dimension : 3 of bodies in space
    """

    name: str
    covers: tuple
    build: Callable[[Builder], None]
    residual: Callable | None = None
    loads: Callable | None = None
    place: dict[str, Callable] = field(default_factory=dict)
    objective: bool = True
    scleronomic: bool = True
    conservative: bool = True
    dimension: int = 2

    def model(self, gravity: bool = True, observer: Observer | None = None) -> da.Model:
        name = self.name.replace(" ", "-")
        builder = Builder(name, gravity, observer or Observer(), self.dimension)
        self.build(builder)
        return builder.system.build()

    def __repr__(self) -> str:
        return self.name


CASES: dict[str, Case] = {}


def case(name: str, *covers, **more):
    """Register the decorated function as the builder of a case."""

    def register(build):
        CASES[name] = Case(name, covers, build, **more)
        return build

    return register


@functools.cache
def model_of(name: str) -> da.Model:
    """The model of a case, built once."""
    return CASES[name].model()


def definite(formulation, model: da.Model):
    """The formulation with what it chooses at the start of a run."""
    return formulation.choose(model.equations, 0.0, model.start.y, model.nominal)
