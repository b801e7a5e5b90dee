"""Names in a file → the strategy classes behind them."""

from __future__ import annotations

from dalembert.analysis.dynamics import Dynamics
from dalembert.analysis.equilibrium import Equilibrium
from dalembert.analysis.inverse_dynamics import InverseDynamics
from dalembert.analysis.kinematics import Kinematics
from dalembert.analysis.linearization import Linearization
from dalembert.formulations.augmented_lagrangian import AugmentedLagrangian
from dalembert.formulations.dae import Dae
from dalembert.formulations.energy_projection import EnergyProjection
from dalembert.formulations.kkt import Kkt
from dalembert.formulations.null_space import NullSpace
from dalembert.formulations.penalty import Penalty
from dalembert.formulations.range_space import RangeSpace
from dalembert.formulations.stabilization import Baumgarte, Projection, Stabilization
from dalembert.formulations.velocity_partitioning import VelocityPartitioning
from dalembert.integrators.backward_euler import BackwardEuler, Trapezoidal
from dalembert.integrators.bdf import Bdf
from dalembert.integrators.generalized_alpha import HHT, GeneralizedAlpha
from dalembert.integrators.newmark import Newmark
from dalembert.integrators.radau import Radau
from dalembert.integrators.runge_kutta import (
    RK4,
    DormandPrince,
    DormandPrince853,
    Euler,
    Heun,
    RKGill,
)
from dalembert.integrators.sundials import Cvodes, Ida
from dalembert.model.coordinates import AbsoluteCoordinates
from dalembert.model.joint_coordinates import JointCoordinates
from dalembert.responses.base import Response
from dalembert.responses.extremes import Maximum, Minimum
from dalembert.responses.integrals import Integral, Mean, Rms
from dalembert.responses.values import At, Final

FORMULATIONS: dict[str, type] = {
    "RangeSpace": RangeSpace,
    "Kkt": Kkt,
    "NullSpace": NullSpace,
    "VelocityPartitioning": VelocityPartitioning,
    "Dae": Dae,
    "AugmentedLagrangian": AugmentedLagrangian,
    "Penalty": Penalty,
}

STABILIZATIONS: dict[str, type] = {
    "Stabilization": Stabilization,
    "Baumgarte": Baumgarte,
    "Projection": Projection,
    "EnergyProjection": EnergyProjection,
}

INTEGRATORS: dict[str, type] = {
    "Euler": Euler,
    "Heun": Heun,
    "RK4": RK4,
    "RKGill": RKGill,
    "DormandPrince": DormandPrince,
    "DormandPrince853": DormandPrince853,
    "BackwardEuler": BackwardEuler,
    "Trapezoidal": Trapezoidal,
    "Newmark": Newmark,
    "HHT": HHT,
    "GeneralizedAlpha": GeneralizedAlpha,
    "Radau": Radau,
    "Bdf": Bdf,
    "Cvodes": Cvodes,
    "Ida": Ida,
}

COORDINATES: dict[str, type] = {
    "AbsoluteCoordinates": AbsoluteCoordinates,
    "JointCoordinates": JointCoordinates,
}

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
