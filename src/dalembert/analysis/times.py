"""Times given as texts or formulas of parameters: ``"20 ms"``, ``"2*pi/omega"``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

import casadi as ca
import numpy as np

from dalembert.analysis.served import need_model
from dalembert.errors import AnalysisError, ModelError
from dalembert.results.designs import are_designs
from dalembert.results.result import Analysis
from dalembert.symbolic.expression import Expression
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.units.amounts import check_unit

Time = float | str | Expression
"""Seconds, a text with a unit, or a formula of parameters."""
Times = int | Sequence[Time] | np.ndarray
"""A count, or times."""
TIMES = ("duration", "step", "outputs", "t_span", "time")
"""Options that hold times."""


A = TypeVar("A", bound=Analysis[Any, Any])


def analysis_of(
    kind: type[A], verb: str, model: ParametricModel, parameters: Any, **options: Any
) -> A:
    """The analysis that a verb was asked for, with its times in seconds.

    Raises
    ------
    AnalysisError
        It has no such option, tells the nearest; or a time that is none.
    """
    return kind.of(verb, **in_seconds(options, model, parameters, verb))


def in_seconds(
    options: Mapping[str, Any], model: ParametricModel, parameters: Any, verb: str
) -> dict[str, Any]:
    """Options of an analysis with numbers in place of texts and formulas of time.

    Formulas are taken at the parameters of the run and then stay: gradients are at fixed times.

    Raises
    ------
    AnalysisError
        Another dimension than time, or what is known in a motion only.
    """
    return {
        name: _settled(value, name, model, parameters, verb) if name in TIMES else value
        for name, value in options.items()
    }


def _settled(value: Any, name: str, model: ParametricModel, parameters: Any, verb: str) -> Any:
    if isinstance(value, (list, tuple)):
        made = [_settled(one, name, model, parameters, verb) for one in value]
        return tuple(made) if isinstance(value, tuple) else made
    if not isinstance(value, (str, Expression)):
        return value
    need_model(model, verb)
    try:
        formula = model.expression(value)
        if formula.unit:
            check_unit(formula.unit, "s", name, repr(value))
    except ModelError as error:
        raise AnalysisError(f"{name}: {error.message}") from None
    symbols = {parameter.sx.name(): k for k, parameter in enumerate(model.parameters.values())}
    used = ca.symvar(formula.sx)
    foreign = [symbol.name() for symbol in used if symbol.name() not in symbols]
    if foreign:
        raise AnalysisError(
            f"{name} is {value!r}, which has {foreign[0]}; give a number or a formula of parameters"
        )
    if used and are_designs(parameters):
        raise AnalysisError(
            f"{name} is {value!r}, which differs from design to design; give all one number"
        )
    p = model.nominal if are_designs(parameters) else model.values(parameters)
    function = ca.Function("time", [ca.vertcat(*used)], [formula.sx])
    return float(function([p[symbols[symbol.name()]] for symbol in used]))
