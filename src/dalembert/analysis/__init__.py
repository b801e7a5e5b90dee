"""Analyses: every verb of the package that solves something."""

from dalembert.analysis.assembly import solve_assembly
from dalembert.analysis.dynamics import Dynamics, solve_dynamics
from dalembert.analysis.equilibrium import Equilibrium, solve_equilibrium
from dalembert.analysis.events import Event
from dalembert.analysis.inverse_dynamics import InverseDynamics, solve_inverse_dynamics
from dalembert.analysis.kinematics import Kinematics, solve_kinematics
from dalembert.analysis.linearization import Linearization, linearize
from dalembert.analysis.nonlinear_statics import NonlinearStatics
from dalembert.analysis.solve_statics import solve_statics
from dalembert.analysis.statics import Statics

__all__ = [
    "Dynamics",
    "Equilibrium",
    "Event",
    "InverseDynamics",
    "Kinematics",
    "Linearization",
    "NonlinearStatics",
    "Statics",
    "linearize",
    "solve_assembly",
    "solve_dynamics",
    "solve_equilibrium",
    "solve_inverse_dynamics",
    "solve_kinematics",
    "solve_statics",
]
