"""Scales of parameters for relative steps and influences."""

from __future__ import annotations

import math

import numpy as np

from dalembert.symbolic.formulas.parameter import Parameter


def parameter_scale(parameter: Parameter, value: float) -> float:
    """Size of a change of 100 %: ``|p|``, for angles at least one radian.

    For a value of zero it is half the width of the bounds, the distance to a single bound, or one
    unit.

    Parameters
    ----------
    value : value of the parameter in the run, in its unit
    """
    if parameter.unit == "rad":
        return max(abs(value), 1.0)
    if value != 0.0:
        return abs(value)
    lower, upper = parameter.bounds
    if math.isfinite(upper - lower) and upper > lower:
        return (upper - lower) / 2
    distances = [abs(b) for b in (lower, upper) if math.isfinite(b) and b != 0.0]
    return min(distances, default=1.0)


def parameter_scales(motion, columns) -> np.ndarray:
    """Scales of the parameters with these numbers."""
    parameters = list(motion.model.parameters.values())
    return np.array([parameter_scale(parameters[i], float(motion.parameters[i])) for i in columns])
