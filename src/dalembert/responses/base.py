"""Base class of responses, and linear combinations of them.

A response samples a scalar measure along a motion, ``m_k = m(t_k)``, and reduces the samples to
a number ``R(m_1 … m_K; t_1 … t_K)``. A new response implements ``reduce``, its derivatives
``weights`` and, if it depends on the times themselves, ``time_weights``; gradients of any analysis
by any method follow.
"""

from __future__ import annotations

import numbers
from collections.abc import Sequence
from typing import Any

import numpy as np

from dalembert.analysis.dynamics.event_search import end_by_event
from dalembert.analysis.events import Occurrence
from dalembert.errors import AnalysisError, ExpressionError, UnsupportedError
from dalembert.options import options
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.wording import plain_text


@options
class Response:
    """A named scalar computed from a result: the reduction of a measure over time.

    Parameters
    ----------
    measure : name or formula, in Python also an Expression; scalar
    name : label; built from the measure if empty

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(1, 10)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> width = da.final("stone.x", name="width")  # an instance of a subclass
    >>> isinstance(width, da.Response), width.label, round(da.evaluate(motion, width), 6)
    (True, 'width', 2.0)
    """

    measure: str | Expression
    name: str = ""

    constant = 0.0
    """Constant added to the sum of the terms."""

    # sums ------------------------------------------------------------------------------
    @property
    def terms(self) -> tuple[tuple[float, Response], ...]:
        """(weight, response) of each summand; a single one, unless it is a ``Combination``."""
        return ((1.0, self),)

    def __add__(self, other: Any) -> Any:
        return _sum((1.0, self), (1.0, other))

    def __radd__(self, other: Any) -> Any:
        return _sum((1.0, other), (1.0, self))

    def __sub__(self, other: Any) -> Any:
        return _sum((1.0, self), (-1.0, other))

    def __rsub__(self, other: Any) -> Any:
        return _sum((1.0, other), (-1.0, self))

    def __mul__(self, factor: Any) -> Any:
        return _sum((self._factor(factor), self))

    def __rmul__(self, factor: Any) -> Any:
        return self * factor

    def __truediv__(self, divisor: Any) -> Any:
        return self * (1.0 / self._factor(divisor))

    def __neg__(self) -> Any:
        return _sum((-1.0, self))

    def _factor(self, factor: Any) -> float:
        if isinstance(factor, bool) or not isinstance(factor, numbers.Real) or not factor:
            raise AnalysisError(
                f"response {self.label}: the factor is {factor!r:.60}; give a number other than 0. "
                "Products of responses are formulas: da.combined('a*b', a=..., b=...)"
            )
        return float(factor)

    __array_ufunc__ = None  # NumPy scalars defer to these operators

    @property
    def label(self) -> str:
        """The name; if empty, the reduction and the measure."""
        if self.name:
            return plain_text(self.name, "name of a response")
        is_text = isinstance(self.measure, str)
        text = self.measure if is_text else getattr(self.measure, "name", "") or "formula"
        return f"{type(self).__name__.lower()}({text})"

    @property
    def declared_unit(self) -> str:
        """Unit if it is available before a run, otherwise an empty text."""
        unit = self.measure.unit if isinstance(self.measure, Expression) else ""
        return self.unit(unit) if unit else ""

    def named(self, name: str) -> Response:
        """Copy of the response with another name."""
        from dataclasses import replace

        return replace(self, name=name)

    def unit_of(self, source: Any) -> str:
        """Unit of the response for a result or model."""
        return self.unit(source.expression(self.measure).unit)

    def adapted_to(self, motion: Result) -> Response:
        """The response as it is evaluated on this result, with its quadrature rule or width."""
        return self

    def sample_times(self, motion: Result) -> np.ndarray | None:
        """Sampling times of the response, or None for the outputs of the motion."""
        return None

    def has_fixed_times(self, motion: Result) -> bool:
        """Whether the sampling times are independent of the start and the end of the run."""
        return self.sample_times(motion) is not None

    def has_adaptive_times(self, motion: Result) -> bool:
        """Whether the sampling times depend on the run and so differ from design to design."""
        return False

    def sampled(self, motion: Result) -> Result:
        """The motion at the sampling times of the response."""
        times = self.sample_times(motion)
        return motion if times is None else motion.at(times)

    def final_event(self, motion: Result) -> Occurrence | None:
        """The event that determines the last sampling time; None if all times are fixed."""
        return end_by_event(motion) if self.sample_times(motion) is None else None

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        """Value ``R`` of the samples."""
        raise NotImplementedError

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        """``∂R/∂m_k``."""
        raise NotImplementedError

    def weights_change(
        self, times: np.ndarray, samples: np.ndarray, change: np.ndarray
    ) -> np.ndarray:
        """``Σ_l ∂²R/∂m_k∂m_l ṁ_l``; zero where ``R`` is linear in the samples."""
        return np.zeros_like(samples)

    def time_weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        """``∂R/∂t_k`` at fixed samples."""
        return np.zeros(times.size)

    def jump_weight(
        self, times: np.ndarray, samples: np.ndarray, before: float, after: float
    ) -> float:
        """``∂R/∂t`` of an instant within the run at which the measure jumps."""
        return 0.0

    def time_derivatives(self, times: np.ndarray) -> np.ndarray:
        """``∂t_k/∂t_K``: shift of each sampling time per shift of the last one by an event."""
        return np.eye(1, times.size, times.size - 1).ravel()

    def reduction(self, times: np.ndarray) -> dict[str, Any]:
        """Kind and constants of the reduction in a page with outputs at ``times``, as plain data.

        Raises
        ------
        UnsupportedError
            Pages do not compute this response.
        """
        raise UnsupportedError(
            f"response {self.label}: a page does not compute {type(self).__name__}; it "
            "computes final values, values at outputs, extremes, means, rms, integrals, totals "
            "and their sums"
        )

    def unit(self, unit: str) -> str:
        """Unit of the response for a measure in ``unit``."""
        return unit


@options
class Combination(Response):
    """Linear combination ``c + Σ w_k R_k`` of responses of one result.

    Sums and differences of responses, and their products with numbers, return a combination. Its
    gradient is the combination of the gradients of its terms, by each method. The measure is the
    formula as text, for display only.

    Parameters
    ----------
    weighted : (weight, response) of each term; no term is itself a combination
    constant : ``c``

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> speed = system.parameter("speed", 10.0)
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(3, speed)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> net = da.final("stone.x") - 2 * da.maximum("stone.y") + 1
    >>> net.label, round(da.evaluate(motion, net), 6)  # 6 - 2·5 + 1
    ('final(stone.x) - 2*maximum(stone.y) + 1', -3.0)
    >>> round(da.sensitivity(motion, net).item(), 6)  # -2 v/g
    -2.0
    """

    weighted: tuple[tuple[float, Response], ...] = ()
    constant: float = 0.0

    @property
    def label(self) -> str:
        return self.name or str(self.measure)

    @property
    def terms(self) -> tuple[tuple[float, Response], ...]:
        return self.weighted

    @property
    def declared_unit(self) -> str:
        return self._common([response.declared_unit for _, response in self.weighted])

    def unit_of(self, source: Any) -> str:
        return self._common([response.unit_of(source) for _, response in self.weighted])

    def has_adaptive_times(self, motion: Result) -> bool:
        return any(response.has_adaptive_times(motion) for _, response in self.weighted)

    def _common(self, units: Sequence[str]) -> str:
        """Unit of the sum if all terms share it; terms with a factor may have any unit.

        Raises
        ------
        AnalysisError
            Terms without a factor have different units.
        """
        plain = [u for u, (w, _) in zip(units, self.weighted, strict=True) if abs(w) == 1 and u]
        distinct = list(dict.fromkeys(plain))
        if len(distinct) > 1:
            first, second = distinct[:2]
            raise AnalysisError(
                f"response {self.label}: terms in {first} and in {second} cannot be added; "
                "multiply one of them by a factor that leads from one unit to the other"
            )
        if distinct:
            return distinct[0]
        return units[0] if len(set(units)) == 1 else ""


def combined_terms(parts: Sequence[tuple[float, Any]]) -> Response:
    """``Σ w_k part_k`` of responses and numbers; weights of equal responses are added."""
    weights: dict[Response, float] = {}
    constant = 0.0
    for weight, part in parts:
        if not isinstance(part, Response):
            constant += weight * float(part)
            continue
        constant += weight * part.constant
        for factor, response in part.terms:
            weights[response] = weights.get(response, 0.0) + weight * factor
    terms = tuple((weight, response) for response, weight in weights.items())
    return Combination(_formula(terms, constant), "", terms, constant)


def _formula(weighted: Sequence[tuple[float, Response]], constant: float) -> str:
    text = ""
    for weight, response in weighted:
        factor = "" if abs(weight) == 1 else f"{abs(weight):g}*"
        text += f" {'-' if weight < 0 else '+'} {factor}{response.label}"
    if constant or not text:
        text += f" {'-' if constant < 0 else '+'} {abs(constant):g}"
    return text[3:] if text.startswith(" + ") else "-" + text[3:]


def _sum(*parts: tuple[float, Any]) -> Any:
    """Combination of responses and numbers; ``NotImplemented`` for other operands."""
    for _, part in parts:
        if isinstance(part, bool) or not isinstance(part, (Response, numbers.Real)):
            return NotImplemented
    return combined_terms(parts)


def scalar_measure(motion: Result, response: Response) -> Expression:
    """The response's measure as an expression of the model.

    Raises
    ------
    AnalysisError
        No such measure, or it is a vector; a response needs one component or a norm.
    """
    try:
        expression = motion.expression(response.measure)
    except ExpressionError as error:
        raise AnalysisError(f"response {response.label}: {error}") from None
    if len(expression) != 1:
        raise AnalysisError(
            f"response {response.label}: the measure has {len(expression)} components; "
            "take .x, .y or a norm"
        )
    return expression


def evaluate(motion: Result, response: Response) -> float:
    """Value of a response on a motion."""
    if response.terms != ((1.0, response),):
        response.unit_of(motion)  # raises if the units of the terms differ
        return response.constant + sum(w * evaluate(motion, r) for w, r in response.terms)
    sampled = response.sampled(motion)
    samples = sampled.values(scalar_measure(motion, response))
    return response.adapted_to(motion).reduce(sampled.time, samples)
