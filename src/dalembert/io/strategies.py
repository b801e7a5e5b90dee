"""Registries of analyses, strategies and responses, by their names in files."""

from __future__ import annotations

from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.analysis.equilibrium.equilibrium import Equilibrium
from dalembert.analysis.equilibrium.load_path import ArcLength
from dalembert.analysis.equilibrium.statics import Statics
from dalembert.analysis.kinematics.inverse_dynamics import InverseDynamics
from dalembert.analysis.kinematics.kinematics import Kinematics
from dalembert.analysis.modes.buckling import Buckling
from dalembert.analysis.modes.modal import Modal
from dalembert.analysis.nonsmooth.nonsmooth import Nonsmooth
from dalembert.analysis.structural.transient import Transient
from dalembert.formulations.base import Formulation
from dalembert.formulations.registry import FORMULATIONS, STABILIZATIONS
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Integrator
from dalembert.integrators.contact.contact_solver import ContactSolver
from dalembert.integrators.contact.schemes import AnticipatedImpacts, ContactScheme, MoreauJean
from dalembert.integrators.registry import INTEGRATORS
from dalembert.model.coordinates import Coordinates
from dalembert.model.registry import COORDINATES
from dalembert.responses.base import Response
from dalembert.responses.events import AtEvent
from dalembert.responses.extremes import Maximum, Minimum
from dalembert.responses.integrals import RMS, Integral, Mean, Total
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

ANALYSES: dict[str, type] = {
    "Dynamics": Dynamics,
    "Kinematics": Kinematics,
    "InverseDynamics": InverseDynamics,
    "Equilibrium": Equilibrium,
    "Modal": Modal,
    "Nonsmooth": Nonsmooth,
}

STRUCTURAL_ANALYSES: dict[str, type] = {
    "Statics": Statics,
    "Equilibrium": Equilibrium,
    "ArcLength": ArcLength,
    "Modal": Modal,
    "Buckling": Buckling,
    "Transient": Transient,
}

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
}
