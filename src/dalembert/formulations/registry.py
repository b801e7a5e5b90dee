"""Registry of formulations and stabilisations by name."""

from __future__ import annotations

from dalembert.formulations.augmented_lagrangian import AugmentedLagrangian
from dalembert.formulations.automatic_formulation import AutomaticFormulation
from dalembert.formulations.dae import DAE
from dalembert.formulations.energy_projection import EnergyProjection
from dalembert.formulations.kkt import KKT
from dalembert.formulations.null_space import NullSpace
from dalembert.formulations.penalty import Penalty
from dalembert.formulations.range_space import RangeSpace
from dalembert.formulations.stabilization import Baumgarte, Projection, Stabilization
from dalembert.formulations.velocity_partitioning import VelocityPartitioning

FORMULATIONS: dict[str, type] = {
    "RangeSpace": RangeSpace,
    "KKT": KKT,
    "NullSpace": NullSpace,
    "VelocityPartitioning": VelocityPartitioning,
    "DAE": DAE,
    "AugmentedLagrangian": AugmentedLagrangian,
    "Penalty": Penalty,
    "AutomaticFormulation": AutomaticFormulation,
}

STABILIZATIONS: dict[str, type] = {
    "Stabilization": Stabilization,
    "Baumgarte": Baumgarte,
    "Projection": Projection,
    "EnergyProjection": EnergyProjection,
}
