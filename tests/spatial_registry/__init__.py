"""Every element in space, once: small models whose numbers are all parameters, and NumPy twins.

As ``registry`` for the plane: a case builds free bodies in general position with one element, and
its twin writes the same mechanics out by hand, as wrenches on the bodies.
"""

# ruff: noqa: F401, I001 (cases are registered in this order)
from __future__ import annotations

from spatial_registry.builder import Builder
from spatial_registry.cases import SPATIAL_CASES, Case, any_model_of, case, spatial_model_of
from spatial_registry.twins import context

from spatial_registry import forces, hinges, touching
