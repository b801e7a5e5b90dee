"""One small model in space, and its NumPy twin."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, field

import registry

import dalembert as da
from spatial_registry.builder import Builder


@dataclass(frozen=True)
class Case:
    """One small model and its twin.

    Attributes
    ----------
    covers : classes this case stands for
    build : adds the elements to a builder
    loads : twin of all applied forces but gravity: list of (body, force, place, moment)
    conservative : at rest, the forces are those of the potential
    """

    name: str
    covers: tuple
    build: Callable[[Builder], None]
    loads: Callable = field(default=lambda c: [])
    conservative: bool = True

    def model(self, gravity: bool = True) -> da.Model:
        builder = Builder(self.name.replace(" ", "-"), gravity)
        self.build(builder)
        return builder.system.build()


SPATIAL_CASES: dict[str, Case] = {}
"""Names begin with ``spatial``."""


def case(name: str, *covers, **more):
    """Register the decorated function as the builder of a case."""

    def register(build):
        SPATIAL_CASES[f"spatial {name}"] = Case(name, covers, build, **more)
        return build

    return register


@functools.cache
def spatial_model_of(name: str) -> da.Model:
    """The model of a case, built once."""
    return SPATIAL_CASES[name].model()


def any_model_of(name: str) -> da.Model:
    """The model of a case in the plane or in space."""
    return spatial_model_of(name) if name in SPATIAL_CASES else registry.model_of(name)
