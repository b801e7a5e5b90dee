"""Difference quotients: which values of a parameter they need, and where those may lie."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError, ModelError, UnsupportedError
from dalembert.results.result import Result
from dalembert.sensitivity.checks.scales import parameter_scale

EPS = float(np.finfo(float).eps)
ROUND_OFF, REACH = 1e-14, 0.1
"""Round-off of what a run gives, relative; share of a parameter over which responses bend."""


@dataclass(frozen=True)
class Stencil:
    """``R'(p) ≈ (1/h) Σ w_k R(p + o_k h)``, with an error ``O(h^order)``."""

    order: int
    offsets: tuple[float, ...]
    weights: tuple[float, ...]

    @property
    def mirrored(self) -> Stencil:
        """The same on the other side."""
        return Stencil(self.order, tuple(-o for o in self.offsets), tuple(-w for w in self.weights))

    @property
    def side(self) -> str:
        """Where it looks."""
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
"""Scheme → its stencil, then those of the same order to use where a value is not allowed."""


def best_step(scheme: str) -> float:
    """Relative step ``L ε^(1/(n+1))``: it balances truncation ``(h/L)^n`` and round-off ``εL/h``.

    That is the square root of ε for one-sided quotients, its cube root for central ones.
    """
    return float(REACH * ROUND_OFF ** (1 / (SCHEMES[scheme][0].order + 1)))


@dataclass(frozen=True)
class Quotient:
    """A difference quotient of one parameter, put where all its values are allowed.

    Attributes
    ----------
    column : number of the parameter
    step : ``h``, in the unit of the parameter
    stencil : Stencil
    note : why it is not the stencil asked for; usually empty
    """

    column: int
    step: float
    stencil: Stencil
    note: str = ""

    @property
    def amplification(self) -> float:
        """By how much noise of the values is larger in the quotient, at most."""
        return float(np.abs(self.stencil.weights).sum() / abs(self.step))

    def evaluate(self, p: np.ndarray, values: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """The quotient of everything that ``values`` gives."""
        places = [moved(p, self.column, offset * self.step) for offset in self.stencil.offsets]
        return np.array(self.stencil.weights) @ np.array([values(q) for q in places]) / self.step


def moved(p: np.ndarray, column: int, by: float) -> np.ndarray:
    """The parameters with one of them changed."""
    changed = p.copy()
    changed[column] += by
    return changed


def place(motion: Result, column: int, scheme: str, relative: float) -> Quotient:
    """The scheme's quotient within the bounds of the parameter and the limits of the model.

    Raises
    ------
    AnalysisError
        A step too short to change the parameter, or no side on which it fits; names both.
    """
    parameter = list(motion.model.parameters.values())[column]
    value = float(motion.parameters[column])
    step = relative * parameter_scale(parameter, value)
    step = (value + step) - value  # a step that is a difference of two numbers
    if step == 0.0:
        raise AnalysisError(
            f"a relative step of {relative:g} does not change {parameter.name} = {value:g}; "
            f"give a longer one than {EPS:.1g}"
        )
    wanted, *others = SCHEMES[scheme]
    why = refusal(motion, column, wanted.offsets, step)
    if not why:
        return Quotient(column, step, wanted)
    for stencil in others:
        if not refusal(motion, column, stencil.offsets, step):
            note = (
                f"differences of {parameter.name} look {stencil.side} only, by a scheme of order "
                f"{stencil.order}: {why}"
            )
            return Quotient(column, step, stencil, note)
    raise AnalysisError(
        f"finite differences with a step of {step:g} {parameter.unit}".rstrip()
        + f" fit on neither side of {parameter.name} = {value:g}: {why}; give a shorter step="
        f"{{{parameter.name!r}: …}}, or wider bounds"
    )


def refusal(motion: Result, column: int, offsets: Sequence[float], step: float) -> str:
    """Why these values are not allowed; empty where they are."""
    names = list(motion.model.parameters)
    for offset in sorted({min(offsets), max(offsets)} - {0.0}):
        p = moved(motion.parameters, column, offset * step)
        outside = beyond_bounds(motion, column, float(p[column]))
        if outside:
            return outside
        try:
            motion.model.values(dict(zip(names, map(float, p), strict=False)))
        except ModelError as error:
            return f"at {names[column]} = {p[column]:g} {error}"
    return ""


def beyond_bounds(motion: Result, column: int, value: float) -> str:
    """Which bound a value leaves, unless the run itself is outside; empty where none."""
    parameter = list(motion.model.parameters.values())[column]
    lower, upper = parameter.bounds
    now = float(motion.parameters[column])
    if value < lower <= now:
        return f"its lower bound is {lower:g}"
    if value > upper >= now:
        return f"its upper bound is {upper:g}"
    return ""


def checked_step(scheme: str, step: float | Mapping[str, float] | None) -> None:
    """Scheme and steps make sense by themselves.

    Raises
    ------
    UnsupportedError
        Unknown scheme, or a step that is not a positive number.
    """
    if scheme not in SCHEMES:
        raise UnsupportedError(f"scheme {scheme!r} is unknown; choose one of {', '.join(SCHEMES)}")
    for name, given in (step if isinstance(step, Mapping) else {"": step}).items():
        if given is not None and not 0 < given < np.inf:
            whose = f" of {name}" if name else ""
            raise UnsupportedError(f"step{whose} is {given}; it must be a positive number")
