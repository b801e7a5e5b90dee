"""Formulations of the constrained equations and stabilisations of their constraints."""

from dalembert.formulations.augmented_lagrangian import AugmentedLagrangian
from dalembert.formulations.base import Formulation
from dalembert.formulations.dae import Dae
from dalembert.formulations.energy_projection import EnergyProjection
from dalembert.formulations.kkt import Kkt
from dalembert.formulations.null_space import NullSpace
from dalembert.formulations.penalty import Penalty
from dalembert.formulations.range_space import RangeSpace
from dalembert.formulations.stabilization import Baumgarte, Projection, Stabilization
from dalembert.formulations.velocity_partitioning import VelocityPartitioning

__all__ = [
    "AugmentedLagrangian",
    "Baumgarte",
    "Dae",
    "EnergyProjection",
    "Formulation",
    "Kkt",
    "NullSpace",
    "Penalty",
    "Projection",
    "RangeSpace",
    "Stabilization",
    "VelocityPartitioning",
]
