"""Objective, limits and boundary conditions of a trajectory from responses and measures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from dalembert.design.limit import Limit
from dalembert.design.quantity import Combined, Objective
from dalembert.design.trajectory.transcription import Rows, Transcription
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.model.graph.model import Model
from dalembert.options import is_number
from dalembert.responses.base import Response
from dalembert.responses.extremes import Maximum, Minimum
from dalembert.responses.integrals import RMS, Integral, Mean
from dalembert.responses.values import At, Final

Conditions = Mapping[str, float | tuple[float | None, float | None]]

SUPPORTED = (
    "trajectories support integral, mean, rms, maximum, final and at(0, …), and in limits minimum"
)
"""Part of error messages for other responses."""


def check_response(quantity: Objective | Limit) -> None:
    """Check that a response is available as objective or limit of a trajectory.

    Raises
    ------
    UnsupportedError
        The kind of response is not supported, or it belongs to another run.
    """
    limit = quantity if isinstance(quantity, Limit) else None
    response = quantity.response if isinstance(quantity, Limit) else quantity
    if isinstance(response, Combined):
        for part in response.parts.values():
            check_response(part)
        return
    if not isinstance(response, Response):
        raise UnsupportedError("a response of another run; a trajectory is judged by its own")
    kinds: tuple[type, ...] = (Final, Integral, Mean, RMS, Maximum)
    first = isinstance(response, At) and response.time == 0
    if not (first or isinstance(response, kinds)) or (
        isinstance(response, Minimum) and limit is None
    ):
        raise UnsupportedError(f"{response.label}: {SUPPORTED}")
    if limit is not None and isinstance(response, (Maximum, Minimum)):
        _check_limit_side(limit)


def response_value(transcription: Transcription, response: Objective) -> ca.MX:
    """A response, or a formula of responses, as a function of the unknowns.

    Raises
    ------
    UnsupportedError
        The kind of response is not supported.
    """
    if isinstance(response, Combined):
        parts = [response_value(transcription, part) for part in response.parts.values()]
        return response.function(ca.vertcat(*parts))[0]
    if not isinstance(response, Response):
        raise AnalysisError(
            f"{response!r:.60} is not a response; give one such as da.integral(...)"
        )
    physics, knots = transcription.physics, transcription.knots
    function = physics.measure(response.measure)
    if isinstance(response, Final):
        return knots.at(transcription.n, function)
    if isinstance(response, At) and response.time == 0:
        return knots.at(0, function)
    if isinstance(response, (Integral, Mean)):
        total = transcription.integral(function)
        return total / transcription.duration if isinstance(response, Mean) else total
    if isinstance(response, RMS):
        square = physics.measure(physics.model.expression(response.measure) ** 2)
        mean = transcription.integral(square) / transcription.duration
        return ca.sqrt(mean + 1e-16)
    if isinstance(response, Maximum) and not isinstance(response, Minimum):
        return transcription.peak(function)
    raise UnsupportedError(f"{response.label}: {SUPPORTED}")


def unit_of(model: Model, response: Objective) -> str:
    """Unit of a response, or of a formula of responses."""
    if isinstance(response, Response):
        return str(response.unit(model.expression(response.measure).unit))
    return response.declared_unit if isinstance(response, Combined) else ""


def limit_rows(transcription: Transcription, limits: Sequence[Limit]) -> list[Rows]:
    """Rows of limits, scaled; limits on extremes become path constraints."""
    rows = []
    for limit in limits:
        response = limit.response
        extreme = isinstance(response, (Maximum, Minimum))
        if extreme:
            _check_limit_side(limit)
            function = transcription.physics.measure(response.measure)
            columns = transcription.knots.of(function), transcription.middles.of(function)
            value = ca.horzcat(*columns)
        else:
            value = response_value(transcription, response)
        rows.append(_row(response.label, value, limit.lower, limit.upper))
    return rows


def _check_limit_side(limit: Limit) -> None:
    """Check that limits of maxima are upper bounds and limits of minima lower bounds."""
    upper = not isinstance(limit.response, Minimum)  # a subclass of Maximum
    if (limit.lower if upper else limit.upper) is not None:
        side, kind = ("lower", "maximum") if upper else ("upper", "minimum")
        raise UnsupportedError(
            f"{limit.response.label}: a {kind} of a trajectory cannot have a {side} bound"
        )


def check_conditions(conditions: Conditions | None, when: str) -> None:
    """Check that the conditions at an end are values or bounds of measures.

    Raises
    ------
    AnalysisError
        The conditions are not a mapping, or a value is neither a number nor a pair of bounds.
    """
    if conditions is not None and not isinstance(conditions, Mapping):
        raise AnalysisError(f"{when} is {conditions!r:.60}; give a dict, measure → value or bounds")
    for name, value in (conditions or {}).items():
        pair = value if isinstance(value, tuple) else (value, value)
        if len(pair) != 2 or not all(b is None or is_number(b) for b in pair):
            raise AnalysisError(
                f"{when}[{name!r}] is {value!r:.60}; give a number, or (lower, upper) with None "
                "for an open side"
            )
        low, high = pair
        if low is not None and high is not None and low > high:
            raise AnalysisError(
                f"{when}[{name!r}] is {value!r:.60}: the lower bound is above the upper one"
            )


def condition_rows(
    transcription: Transcription, conditions: Conditions, k: int, when: str
) -> list[Rows]:
    """Rows of measures with values or bounds at a knot."""
    rows = []
    for measure, value in conditions.items():
        function = transcription.physics.measure(measure)
        lower, upper = value if isinstance(value, tuple) else (value, value)
        rows.append(_row(f"{measure} {when}", transcription.knots.at(k, function), lower, upper))
    return rows


def cyclic_rows(transcription: Transcription, measures: Sequence[str]) -> list[Rows]:
    """Rows of measures with equal values at both ends."""
    rows = []
    for measure in measures:
        function, knots = transcription.physics.measure(measure), transcription.knots
        value = knots.at(transcription.n, function) - knots.at(0, function)
        rows.append(Rows(f"{measure} as it began", value))
    return rows


def _row(label: str, value: ca.MX, lower: float | None, upper: float | None) -> Rows:
    size = max((abs(b) for b in (lower, upper) if b is not None), default=0.0) or 1.0
    low = -ca.inf if lower is None else lower / size
    high = ca.inf if upper is None else upper / size
    return Rows(label, value / size, float(low), float(high))
