"""Times given as texts or formulas of parameters: ``"20 ms"``, ``"2*pi/omega"``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Self, TypeVar

import casadi as ca
import numpy as np

from dalembert.analysis.requirements import need_model
from dalembert.errors import AnalysisError, ModelError, UnknownNameError
from dalembert.results.analysis import Analysis
from dalembert.results.batch.designs import are_designs
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.wording import similar
from dalembert.units.amounts import check_unit

Time = float | str | Expression
"""Seconds, a text with a unit, or a formula of parameters."""
Times = int | Sequence[Time] | np.ndarray
"""A count, or times."""
TIMES = ("duration", "step", "outputs", "t_span", "time")
"""Options whose values are times."""
ACCEPTED = "give a number in seconds, a text with a unit such as '5 ms', or a formula of parameters"


A = TypeVar("A", bound=Analysis[Any, Any])


class FollowingTime(float):
    """A time that follows parameters: its value in a run, and its formula.

    Pickled, it becomes a plain number.
    """

    formula: Expression

    def __new__(cls, seconds: float, formula: Expression) -> Self:
        time = super().__new__(cls, seconds)
        time.formula = formula
        return time

    def __repr__(self) -> str:
        return f"{float(self)!r} = {self.formula.sx}"

    def __str__(self) -> str:
        return float.__repr__(self)

    def __reduce__(self) -> tuple[type[float], tuple[float]]:
        return float, (float(self),)


def evaluate_times(analysis: A, model: ParametricModel, parameters: Any) -> A:
    """The analysis with the times that follow parameters evaluated at these values.

    Raises
    ------
    AnalysisError
        A formula has no finite value.
    """
    formulas = {name: _formulas(getattr(analysis, name, None)) for name in TIMES}
    follows = {name: formula for name, formula in formulas.items() if formula is not None}
    if not follows:
        return analysis
    return replace(analysis, **in_seconds(follows, model, parameters, type(analysis).__name__))  # type: ignore[type-var]


def follow_parameters(analysis: Analysis[Any, Any]) -> bool:
    """Whether any time of the analysis follows parameters."""
    return any(_formulas(getattr(analysis, name, None)) is not None for name in TIMES)


def slopes(time: Any, model: ParametricModel, p: np.ndarray) -> np.ndarray:
    """(n,) derivatives of a time by all parameters; zero for a plain number."""
    gradient = np.zeros(len(model.parameters))
    if isinstance(time, FollowingTime):
        symbols = ca.vertcat(*(parameter.sx for parameter in model.parameters.values()))
        jacobian = ca.Function("slopes", [symbols], [ca.jacobian(time.formula.sx, symbols)])
        gradient[:] = jacobian(p[: gradient.size]).full().ravel()
    return gradient


def _formulas(value: Any) -> Any:
    """Formulas in place of the numbers they define; None if no number follows parameters."""
    if isinstance(value, FollowingTime):
        return value.formula
    if not isinstance(value, (list, tuple)):
        return None
    formulas = [_formulas(item) for item in value]
    if all(item is None for item in formulas):
        return None
    return type(value)(a if b is None else b for a, b in zip(value, formulas, strict=True))


def analysis_of(
    kind: type[A], verb: str, model: ParametricModel, parameters: Any, **options: Any
) -> A:
    """The analysis of a model with the options of a call, its times in seconds.

    Raises
    ------
    AnalysisError
        Unknown option (names the nearest one), a value that is no time, or another kind of model.
    """
    analysis = kind.of(verb, **in_seconds(options, model, parameters, verb))
    need_model(model, verb)
    return analysis.for_model(model)


def in_seconds(
    options: Mapping[str, Any], model: ParametricModel, parameters: Any, verb: str
) -> dict[str, Any]:
    """Options of an analysis with numbers in place of texts and formulas of time.

    Times from formulas of parameters are ``FollowingTime`` objects.

    Raises
    ------
    AnalysisError
        Another dimension than time, or a formula of measures.
    """
    return {
        name: _seconds(value, name, model, parameters, verb) if name in TIMES else value
        for name, value in options.items()
    }


def _seconds(value: Any, name: str, model: ParametricModel, parameters: Any, verb: str) -> Any:
    if isinstance(value, (list, tuple)):
        items = [_seconds(item, name, model, parameters, verb) for item in value]
        return tuple(items) if isinstance(value, tuple) else items
    if not isinstance(value, (str, Expression)):
        return value
    need_model(model, verb)
    try:
        formula = model.expression(value)
        if formula.unit:
            check_unit(formula.unit, "s", name, repr(value))
    except UnknownNameError as error:
        raise AnalysisError(_unknown(name, value, error.name, list(model.parameters))) from None
    except ModelError as error:
        raise AnalysisError(f"{name}: {error.message}") from None
    symbols = {parameter.sx.name(): k for k, parameter in enumerate(model.parameters.values())}
    used = ca.symvar(formula.sx)
    foreign = [symbol.name() for symbol in used if symbol.name() not in symbols]
    if foreign:
        raise AnalysisError(f"{name} is {value!r}, which has {foreign[0]}; {ACCEPTED}")
    if used and are_designs(parameters):
        raise AnalysisError(
            f"{name} is {value!r}, which differs from design to design; give all one number"
        )
    p = model.nominal if are_designs(parameters) else model.values(parameters)
    function = ca.Function("time", [ca.vertcat(*used)], [formula.sx])
    seconds = float(function([p[symbols[symbol.name()]] for symbol in used]))
    return FollowingTime(seconds, formula) if used else seconds


def _unknown(option: str, value: Any, unknown: str, parameters: list[str]) -> str:
    """Message about a time with an unknown name in its text."""
    reason = "no time" if value == unknown else f"no time: {unknown!r} is no parameter"
    names = similar(unknown, parameters)
    nearest = f" (nearest parameter: {names[0]})" if names else ""
    count = "give a number of outputs, or times: " if option == "outputs" else ""
    return f"{option} is {value!r}, which is {reason}; {count}{ACCEPTED}{nearest}"
