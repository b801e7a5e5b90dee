"""Registries of analyses, strategies and responses, by their names in files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import Any

from dalembert.formulations.base import Formulation
from dalembert.formulations.registry import FORMULATIONS, STABILIZATIONS
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Integrator
from dalembert.integrators.contact.contact_solver import ContactSolver
from dalembert.integrators.contact.schemes import AnticipatedImpacts, ContactScheme, MoreauJean
from dalembert.integrators.registry import INTEGRATORS
from dalembert.model.graph.coordinates import Coordinates
from dalembert.model.graph.registry import COORDINATES
from dalembert.responses.base import Response
from dalembert.responses.events import AtEvent
from dalembert.responses.extremes import Maximum, Minimum
from dalembert.responses.integrals import RMS, Integral, Mean, Total
from dalembert.responses.peaks import Peak
from dalembert.responses.random_rms import RandomRMS
from dalembert.responses.values import At, Final

STRATEGIES_OF: dict[type, dict[str, type]] = {
    Coordinates: COORDINATES,
    Formulation: FORMULATIONS,
    Stabilization: STABILIZATIONS,
    Integrator: INTEGRATORS,
    ContactScheme: {"AnticipatedImpacts": AnticipatedImpacts, "MoreauJean": MoreauJean},
    ContactSolver: {"ContactSolver": ContactSolver},
}
"""File type of a field → its registry."""
STRATEGIES: dict[str, dict[str, type]] = {
    "coordinates": COORDINATES,
    "formulation": FORMULATIONS,
    "stabilization": STABILIZATIONS,
    "integrator": INTEGRATORS,
}
"""Key of an analysis → the registry of its strategies."""


class PublicClasses(Mapping[str, Any]):
    """Public classes by their names, each imported when it is accessed."""

    def __init__(self, *names: str):
        self.names = names

    def __getitem__(self, name: str) -> Any:
        if name not in self.names:
            raise KeyError(name)
        return getattr(import_module("dalembert"), name)

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)


ANALYSES = PublicClasses(
    "Dynamics",
    "Kinematics",
    "InverseDynamics",
    "Equilibrium",
    "Modal",
    "FrequencyResponse",
    "RandomResponse",
    "Nonsmooth",
)
STRUCTURAL_ANALYSES = PublicClasses(
    "Statics",
    "Equilibrium",
    "ArcLength",
    "Modal",
    "Buckling",
    "FrequencyResponse",
    "RandomResponse",
    "Dynamics",
)
TRAJECTORY_METHODS = PublicClasses("DirectCollocation", "MultipleShooting")

RESPONSES: dict[str, type[Response]] = {
    "Final": Final,
    "At": At,
    "AtEvent": AtEvent,
    "Integral": Integral,
    "Mean": Mean,
    "RMS": RMS,
    "Total": Total,
    "Maximum": Maximum,
    "Minimum": Minimum,
    "Peak": Peak,
    "RandomRMS": RandomRMS,
}
