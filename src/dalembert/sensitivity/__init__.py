"""Gradients of responses: finite differences, direct differentiation, adjoint."""

from dalembert.sensitivity.finite_difference import FiniteDifference
from dalembert.sensitivity.gradient import Adjoint, Direct, sensitivity

__all__ = ["Adjoint", "Direct", "FiniteDifference", "sensitivity"]
