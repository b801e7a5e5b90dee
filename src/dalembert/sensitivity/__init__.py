"""Gradients of responses: finite differences, direct differentiation, adjoint."""

from dalembert.sensitivity.checks.certificate import Certificate
from dalembert.sensitivity.checks.finite_difference import FiniteDifference
from dalembert.sensitivity.checks.step_study import StepStudy, step_study
from dalembert.sensitivity.gradient import sensitivity
from dalembert.sensitivity.methods import Adjoint, Direct
from dalembert.sensitivity.second_order import hessian_product
from dalembert.sensitivity.structural.eigenvalue_slopes import eigenvalue_slopes

__all__ = [
    "Adjoint",
    "Certificate",
    "Direct",
    "FiniteDifference",
    "StepStudy",
    "eigenvalue_slopes",
    "hessian_product",
    "sensitivity",
    "step_study",
]
