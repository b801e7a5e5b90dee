"""How large a change of a parameter is: what steps and influences are relative to."""

from __future__ import annotations

import math

import numpy as np

from dalembert.symbolic.formulas.parameter import Parameter


def parameter_scale(parameter: Parameter, value: float) -> float:
    """Size of a change of 100 %: ``|p|``, for angles at least one radian.

    Zero has no size of its own: there it is half the width of the bounds, the distance to the one
    that is given, or one unit.

    Parameters
    ----------
    value : of the parameter in the run, in its unit
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
    """Sizes of some parameters of a result, by number."""
    listed = list(motion.model.parameters.values())
    return np.array([parameter_scale(listed[i], float(motion.parameters[i])) for i in columns])
