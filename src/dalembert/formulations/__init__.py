"""Formulations of the constrained equations and stabilisations of their constraints."""

from dalembert.formulations.base import Formulation
from dalembert.formulations.kkt import Kkt
from dalembert.formulations.range_space import RangeSpace
from dalembert.formulations.stabilization import Baumgarte, Projection, Stabilization

__all__ = ["Baumgarte", "Formulation", "Kkt", "Projection", "RangeSpace", "Stabilization"]
