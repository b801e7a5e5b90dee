"""Gradients of responses: finite differences, direct differentiation, adjoint."""

from dalembert.sensitivity.finite_difference import FiniteDifference
from dalembert.sensitivity.gradient import sensitivity
from dalembert.sensitivity.methods import Adjoint, Direct

__all__ = ["Adjoint", "Direct", "FiniteDifference", "sensitivity"]
