"""Names in a file → the strategy classes behind them."""

from __future__ import annotations

from dalembert.analysis.dynamics import Dynamics
from dalembert.analysis.equilibrium import Equilibrium
from dalembert.analysis.inverse_dynamics import InverseDynamics
from dalembert.analysis.kinematics import Kinematics
from dalembert.analysis.linearization import Linearization
from dalembert.formulations.kkt import Kkt
from dalembert.formulations.range_space import RangeSpace
from dalembert.formulations.stabilization import Baumgarte, Projection, Stabilization
from dalembert.integrators.runge_kutta import (
    RK4,
    DormandPrince,
    DormandPrince853,
    Euler,
    Heun,
    RKGill,
)
from dalembert.model.coordinates import AbsoluteCoordinates
from dalembert.responses.base import Response
from dalembert.responses.extremes import Maximum, Minimum
from dalembert.responses.integrals import Integral, Mean, Rms
from dalembert.responses.values import At, Final

FORMULATIONS: dict[str, type] = {"RangeSpace": RangeSpace, "Kkt": Kkt}

STABILIZATIONS: dict[str, type] = {
    "Stabilization": Stabilization,
    "Baumgarte": Baumgarte,
    "Projection": Projection,
}

INTEGRATORS: dict[str, type] = {
    "Euler": Euler,
    "Heun": Heun,
    "RK4": RK4,
    "RKGill": RKGill,
    "DormandPrince": DormandPrince,
    "DormandPrince853": DormandPrince853,
}

COORDINATES: dict[str, type] = {"AbsoluteCoordinates": AbsoluteCoordinates}

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

RESPONSES: dict[str, type[Response]] = {
    "Final": Final,
    "At": At,
    "Integral": Integral,
    "Mean": Mean,
    "Rms": Rms,
    "Maximum": Maximum,
    "Minimum": Minimum,
}
