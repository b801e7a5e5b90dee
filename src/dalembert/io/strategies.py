"""Names in a file → the strategy classes behind them."""

from __future__ import annotations

from dalembert.analysis.dynamics import Dynamics
from dalembert.analysis.equilibrium import Equilibrium
from dalembert.analysis.inverse_dynamics import InverseDynamics
from dalembert.analysis.kinematics import Kinematics
from dalembert.analysis.linearization import Linearization
from dalembert.analysis.structural.buckling import Buckling
from dalembert.analysis.structural.load_path import ArcLength
from dalembert.analysis.structural.modal import Modal
from dalembert.analysis.structural.nonlinear_statics import NonlinearStatics
from dalembert.analysis.structural.statics import Statics
from dalembert.analysis.structural.transient import Transient
from dalembert.formulations.registry import FORMULATIONS, STABILIZATIONS
from dalembert.integrators.registry import INTEGRATORS
from dalembert.model.registry import COORDINATES
from dalembert.responses.base import Response
from dalembert.responses.events import AtEvent
from dalembert.responses.extremes import Maximum, Minimum
from dalembert.responses.integrals import Integral, Mean, Rms, Total
from dalembert.responses.values import At, Final

STRATEGIES: dict[str, dict[str, type]] = {
    "coordinates": COORDINATES,
    "formulation": FORMULATIONS,
    "stabilization": STABILIZATIONS,
    "integrator": INTEGRATORS,
}
"""Kind of field → its registry."""

ANALYSES: dict[str, type] = {
    "Dynamics": Dynamics,
    "Kinematics": Kinematics,
    "InverseDynamics": InverseDynamics,
    "Equilibrium": Equilibrium,
    "Linearization": Linearization,
}

STRUCTURAL_ANALYSES: dict[str, type] = {
    "Statics": Statics,
    "NonlinearStatics": NonlinearStatics,
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
    "Rms": Rms,
    "Total": Total,
    "Maximum": Maximum,
    "Minimum": Minimum,
}
