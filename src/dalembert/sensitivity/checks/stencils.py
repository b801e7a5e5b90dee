"""Scales of parameters and stencils of difference quotients within bounds and limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError, ModelError, UnsupportedError
from dalembert.results.result import Result
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


EPS = float(np.finfo(float).eps)
ROUND_OFF, REACH = 1e-14, 0.1
"""Relative round-off of responses, and relative scale of their nonlinearity in a parameter [-]."""


@dataclass(frozen=True)
class Stencil:
    """``R'(p) ≈ (1/h) Σ w_k R(p + o_k h)`` with truncation error ``O(h^order)``."""

    order: int
    offsets: tuple[float, ...]
    weights: tuple[float, ...]

    @property
    def mirrored(self) -> Stencil:
        """The stencil mirrored to the other side."""
        return Stencil(self.order, tuple(-o for o in self.offsets), tuple(-w for w in self.weights))

    @property
    def side(self) -> str:
        """Side of the offsets, in words."""
        if min(self.offsets) < 0 < max(self.offsets):
            return "both sides"
        return "upwards" if max(self.offsets) > 0 else "downwards"


FIRST = Stencil(1, (0.0, 1.0), (-1.0, 1.0))
SECOND = Stencil(2, (0.0, 0.5, 1.0), (-3.0, 4.0, -1.0))
FOURTH = Stencil(4, (0.0, 0.25, 0.5, 0.75, 1.0), (-25 / 3, 16.0, -12.0, 16 / 3, -1.0))
CENTRAL = Stencil(2, (-1.0, 1.0), (-0.5, 0.5))
RICHARDSON = Stencil(4, (-1.0, -0.5, 0.5, 1.0), (1 / 6, -4 / 3, 4 / 3, -1 / 6))

SCHEMES: Mapping[str, tuple[Stencil, ...]] = {
    "forward": (FIRST, FIRST.mirrored),
    "backward": (FIRST.mirrored, FIRST),
    "central": (CENTRAL, SECOND, SECOND.mirrored),
    "richardson": (RICHARDSON, FOURTH, FOURTH.mirrored),
}
"""Scheme → its stencil, then replacements of the same order for inadmissible values."""


def best_step(scheme: str) -> float:
    """Relative step ``L ε^(1/(n+1))``: it balances truncation ``(h/L)^n`` and round-off ``εL/h``.

    It scales with the square root of ε for one-sided quotients, the cube root for central ones.
    """
    return float(REACH * ROUND_OFF ** (1 / (SCHEMES[scheme][0].order + 1)))


@dataclass(frozen=True)
class Quotient:
    """Difference quotient of one parameter with admissible values.

    Attributes
    ----------
    column : number of the parameter
    step : ``h``, in the unit of the parameter
    stencil : Stencil
    note : reason for a replaced stencil; usually empty
    """

    column: int
    step: float
    stencil: Stencil
    note: str = ""

    @property
    def amplification(self) -> float:
        """Upper bound of the amplification of noise of the values."""
        return float(np.abs(self.stencil.weights).sum() / abs(self.step))

    def evaluate(self, p: np.ndarray, values: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """Quotients of all entries of ``values``."""
        points = [shifted(p, self.column, offset * self.step) for offset in self.stencil.offsets]
        return np.array(self.stencil.weights) @ np.array([values(q) for q in points]) / self.step


def shifted(p: np.ndarray, column: int, by: float) -> np.ndarray:
    """The parameters with one of them changed."""
    changed = p.copy()
    changed[column] += by
    return changed


def quotient_within_bounds(motion: Result, column: int, scheme: str, relative: float) -> Quotient:
    """Quotient of a scheme within the bounds of the parameter and the limits of the model.

    Raises
    ------
    AnalysisError
        A step too short to change the parameter, or one that fits on neither side.
    """
    parameter = list(motion.model.parameters.values())[column]
    value = float(motion.parameters[column])
    step = relative * parameter_scale(parameter, value)
    step = (value + step) - value  # exactly representable as a difference
    if step == 0.0:
        raise AnalysisError(
            f"a relative step of {relative:g} does not change {parameter.name} = {value:g}; "
            f"give a longer one than {EPS:.1g}"
        )
    standard, *replacements = SCHEMES[scheme]
    reason = refusal(motion, column, standard.offsets, step)
    if not reason:
        return Quotient(column, step, standard)
    for stencil in replacements:
        if not refusal(motion, column, stencil.offsets, step):
            note = (
                f"differences of {parameter.name} look {stencil.side} only, by a scheme of order "
                f"{stencil.order}: {reason}"
            )
            return Quotient(column, step, stencil, note)
    raise AnalysisError(
        f"finite differences with a step of {step:g} {parameter.unit}".rstrip()
        + f" fit on neither side of {parameter.name} = {value:g}: {reason}; give a shorter step="
        f"{{{parameter.name!r}: …}}, or wider bounds"
    )


def refusal(motion: Result, column: int, offsets: Sequence[float], step: float) -> str:
    """Reason why these values are inadmissible; ``""`` if they are admissible."""
    names = list(motion.model.parameters)
    for offset in sorted({min(offsets), max(offsets)} - {0.0}):
        p = shifted(motion.parameters, column, offset * step)
        outside = beyond_bounds(motion, column, float(p[column]))
        if outside:
            return outside
        try:
            motion.model.values(dict(zip(names, map(float, p), strict=False)))
        except ModelError as error:
            return f"at {names[column]} = {p[column]:g} {error}"
    return ""


def beyond_bounds(motion: Result, column: int, value: float) -> str:
    """Bound that a value violates and the run does not; ``""`` if none."""
    parameter = list(motion.model.parameters.values())[column]
    lower, upper = parameter.bounds
    now = float(motion.parameters[column])
    if value < lower <= now:
        return f"its lower bound is {lower:g}"
    if value > upper >= now:
        return f"its upper bound is {upper:g}"
    return ""


def checked_step(scheme: str, step: float | Mapping[str, float] | None) -> None:
    """Raise for an unknown scheme or an invalid step.

    Raises
    ------
    UnsupportedError
        Unknown scheme, or a step that is not a positive number.
    """
    if scheme not in SCHEMES:
        raise UnsupportedError(f"scheme {scheme!r} is unknown; choose one of {', '.join(SCHEMES)}")
    for name, value in (step if isinstance(step, Mapping) else {"": step}).items():
        if value is not None and not 0 < value < np.inf:
            of = f" of {name}" if name else ""
            raise UnsupportedError(f"step{of} is {value}; it must be a positive number")
