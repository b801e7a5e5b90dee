"""Analyses: every verb of the package that solves something."""

from dalembert.analysis.assembly import solve_assembly
from dalembert.analysis.dynamics import Dynamics, solve_dynamics
from dalembert.analysis.equilibrium import Equilibrium, solve_equilibrium
from dalembert.analysis.events import Event
from dalembert.analysis.inverse_dynamics import InverseDynamics, solve_inverse_dynamics
from dalembert.analysis.kinematics import Kinematics, solve_kinematics
from dalembert.analysis.linearization import Linearization, linearize
from dalembert.analysis.structural.buckling import Buckling, solve_buckling
from dalembert.analysis.structural.load_path import ArcLength, solve_load_path
from dalembert.analysis.structural.modal import Modal, solve_modes
from dalembert.analysis.structural.nonlinear_statics import NonlinearStatics
from dalembert.analysis.structural.solve_statics import solve_statics
from dalembert.analysis.structural.statics import Statics
from dalembert.analysis.structural.transient import Transient, solve_transient
from dalembert.analysis.structural.transient_equation import Rayleigh

__all__ = [
    "ArcLength",
    "Buckling",
    "Dynamics",
    "Equilibrium",
    "Event",
    "InverseDynamics",
    "Kinematics",
    "Linearization",
    "Modal",
    "NonlinearStatics",
    "Rayleigh",
    "Statics",
    "Transient",
    "linearize",
    "solve_assembly",
    "solve_buckling",
    "solve_dynamics",
    "solve_equilibrium",
    "solve_inverse_dynamics",
    "solve_kinematics",
    "solve_load_path",
    "solve_modes",
    "solve_statics",
    "solve_transient",
]
