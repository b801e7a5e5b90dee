"""Objective and limits of a trajectory, from the same responses that designs are judged by."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import casadi as ca

from dalembert.design.limit import Limit
from dalembert.design.quantity import Combined
from dalembert.design.trajectory.transcription import Rows, Transcription
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.model.model import Model
from dalembert.options import is_number
from dalembert.responses.base import Response
from dalembert.responses.extremes import Maximum, Minimum
from dalembert.responses.integrals import Integral, Mean, Rms
from dalembert.responses.values import At, Final

Conditions = Mapping[str, float | tuple[float | None, float | None]]


KNOWN = "trajectories know integral, mean, rms, maximum, final and at(0, …), and in limits minimum"


def known_response(given: Any) -> None:
    """Refuse what a trajectory cannot be judged by.

    Raises
    ------
    UnsupportedError
        A kind of response that has no place here, or one of another run.
    """
    limited = isinstance(given, Limit)
    response = given.response if limited else given
    if isinstance(response, Combined):
        for part in response.parts.values():
            known_response(part)
        return
    if not isinstance(response, Response):
        raise UnsupportedError("a response of another run; a trajectory is judged by its own")
    kinds: tuple[type, ...] = (Final, Integral, Mean, Rms, Maximum)
    first = isinstance(response, At) and response.time == 0
    if not (first or isinstance(response, kinds)) or (
        isinstance(response, Minimum) and not limited
    ):
        raise UnsupportedError(f"{response.label}: {KNOWN}")
    if limited and isinstance(response, (Maximum, Minimum)):
        _refuse_other_side(given)


def number_of(transcription: Transcription, given: Any) -> ca.MX:
    """A response, or a formula of responses, of the unknowns.

    Raises
    ------
    UnsupportedError
        A kind of response that has no place here.
    """
    if isinstance(given, Combined):
        parts = [number_of(transcription, part) for part in given.parts.values()]
        return given.function(ca.vertcat(*parts))[0]
    if not isinstance(given, Response):
        raise AnalysisError(f"{given!r:.60} is not a response; give one such as da.integral(...)")
    physics, knots = transcription.physics, transcription.knots
    function = physics.measure(given.measure)
    if isinstance(given, Final):
        return knots.at(transcription.n, function)
    if isinstance(given, At) and given.time == 0:
        return knots.at(0, function)
    if isinstance(given, (Integral, Mean)):
        total = transcription.integral(function)
        return total / transcription.duration if isinstance(given, Mean) else total
    if isinstance(given, Rms):
        square = physics.measure(physics.model.expression(given.measure) ** 2)
        mean = transcription.integral(square) / transcription.duration
        return ca.sqrt(mean + 1e-16)
    if isinstance(given, Maximum) and not isinstance(given, Minimum):
        return transcription.peak(function)
    raise UnsupportedError(f"{given.label}: {KNOWN}")


def unit_of(model: Model, given: Any) -> str:
    """Of a response, or of a formula of such."""
    if isinstance(given, Combined):
        return given.given_unit
    return str(given.unit(model.expression(given.measure).unit))


def limit_rows(transcription: Transcription, limits: Sequence[Limit]) -> list[Rows]:
    """Limits, each by its size; one of an extreme holds all the way."""
    made = []
    for limit in limits:
        response = limit.response
        extreme = isinstance(response, (Maximum, Minimum))
        if extreme:
            _refuse_other_side(limit)
            function = transcription.physics.measure(response.measure)
            both = transcription.knots.of(function), transcription.middles.of(function)
            value = ca.horzcat(*both)
        else:
            value = number_of(transcription, response)
        made.append(_row(response.label, value, limit.lower, limit.upper))
    return made


def _refuse_other_side(limit: Limit) -> None:
    """A maximum has an upper bound, a minimum a lower one."""
    upper = not isinstance(limit.response, Minimum)  # which is a maximum of the opposite
    if (limit.lower if upper else limit.upper) is not None:
        side, kind = ("lower", "maximum") if upper else ("upper", "minimum")
        raise UnsupportedError(
            f"{limit.response.label}: a {kind} of a trajectory cannot be held by its {side} side"
        )


def check_conditions(given: Any, when: str) -> None:
    """Refuse conditions at an end that are no bounds of measures.

    Raises
    ------
    AnalysisError
        No mapping, or a value that is neither a number nor a pair of a lower and an upper one.
    """
    if given is not None and not isinstance(given, Mapping):
        raise AnalysisError(f"{when} is {given!r:.60}; give a dict, measure → value or bounds")
    for name, value in (given or {}).items():
        pair = value if isinstance(value, tuple) else (value, value)
        if len(pair) != 2 or not all(b is None or is_number(b) for b in pair):
            raise AnalysisError(
                f"{when}[{name!r}] is {value!r:.60}; give a number, or (lower, upper) with None "
                "for an open side"
            )
        if None not in pair and pair[0] > pair[1]:
            raise AnalysisError(
                f"{when}[{name!r}] is {value!r:.60}: the lower bound is above the upper one"
            )


def condition_rows(
    transcription: Transcription, given: Conditions, k: int, when: str
) -> list[Rows]:
    """Measures that have values, or lie within bounds, at a knot."""
    made = []
    for measure, value in given.items():
        function = transcription.physics.measure(measure)
        lower, upper = value if isinstance(value, tuple) else (value, value)
        made.append(_row(f"{measure} {when}", transcription.knots.at(k, function), lower, upper))
    return made


def cyclic_rows(transcription: Transcription, measures: Sequence[str]) -> list[Rows]:
    """Measures that end as they began."""
    made = []
    for measure in measures:
        function, knots = transcription.physics.measure(measure), transcription.knots
        value = knots.at(transcription.n, function) - knots.at(0, function)
        made.append(Rows(f"{measure} as it began", value))
    return made


def _row(label: str, value: ca.MX, lower: float | None, upper: float | None) -> Rows:
    size = max((abs(b) for b in (lower, upper) if b is not None), default=0.0) or 1.0
    low = -ca.inf if lower is None else lower / size
    high = ca.inf if upper is None else upper / size
    return Rows(label, value / size, float(low), float(high))
