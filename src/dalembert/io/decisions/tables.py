"""Tables of model files for decisions: limits, optimisation, fronts, reliability, tolerances."""

from __future__ import annotations

from functools import partial
from pkgutil import resolve_name
from typing import Any

from pydantic import Field

from dalembert.io.choices import Record, one_of
from dalembert.io.tables import table_of
from dalembert.io.values import Flag, Integer, Number, Text, list_of, one_name

Method = one_name("dalembert.sensitivity.methods:METHODS")
Names = list[Text]
Bounds = list_of(Number, 2, "lower, upper")
VARIED = "names of parameters; all with bounds by default"
LIMITS = "list of limits, tables as below"
DISTRIBUTIONS = ("Normal", "Lognormal", "Uniform", "Weibull", "Gumbel", "Truncated")
"""Classes of ``design.reliability.distributions``, which is imported when a file has one."""


class LimitTable(Record):
    """A response that a design keeps between limits."""

    response: Text
    lower: Number = None
    upper: Number = None


class CombinedTable(Record):
    """A formula of responses that is itself an aim or a limit."""

    formula: Text = Field(description="of names of responses: `torque + 0.1*mass`")
    unit: Text = Field(default="", description="shown in results")


class RobustTable(Record):
    """A response with its scatter over what ``[[random]]`` says: an aim or a limit of its own."""

    response: Text
    deviations: Number = Field(
        default=3.0, description="standard deviations added to the mean; below zero, taken away"
    )


class OptimizeTable(Record):
    """What ``dalembert optimize`` minimises or maximises."""

    minimize: Text = None
    maximize: Text = None
    vary: Names = Field(default_factory=list, description=VARIED)
    integers: Names = Field(
        default_factory=list, description="those of them that take whole numbers"
    )
    catalogues: list[dict[Text, list[Number]]] = Field(
        default_factory=list, description="sizes to choose from: tables of parameters and values"
    )
    subject_to: list[LimitTable] = Field(default_factory=list, description=LIMITS)
    beta: Number = Field(
        default=None, description="index with which all limits hold, over what `[[random]]` says"
    )
    rounds: Integer = Field(default=20, description="of optimisation and reliability, with `beta`")
    method: one_name("dalembert.design.methods.registry:OPTIMIZERS") = "slsqp"  # type: ignore[valid-type]
    gradient: Method = "auto"  # type: ignore[valid-type]
    max_iterations: Integer = 100
    tolerance: Number = 1e-8


class ParetoTable(Record):
    """Between which aims ``dalembert pareto`` lets choose."""

    minimize: Names = Field(default_factory=list, description="names of responses to make small")
    maximize: Names = Field(default_factory=list, description="names of responses to make large")
    vary: Names = Field(default_factory=list, description=VARIED)
    integers: Names = Field(default_factory=list, description="as of `[optimize]`, by evolution")
    catalogues: list[dict[Text, list[Number]]] = Field(
        default_factory=list, description="as of `[optimize]`, by evolution"
    )
    subject_to: list[LimitTable] = Field(default_factory=list, description=LIMITS)
    method: one_name("dalembert.design.pareto.pareto:METHODS") = "normal-constraint"  # type: ignore[valid-type]
    points: Integer = Field(default=15, description="along each side; population of an evolution")
    local: one_name("dalembert.design.methods.registry:OPTIMIZERS") = Field(  # type: ignore[valid-type]
        default="slsqp", description="gradient method of each point"
    )
    starts: Integer = Field(default=1, description="of each point, for fronts in pieces")
    gradient: Method = "auto"  # type: ignore[valid-type]
    max_iterations: Integer = 100
    tolerance: Number = 1e-8
    generations: Integer = Field(default=100, description="of an evolution")
    rng: Integer = Field(default=0, description="seed of an evolution or of starts")


_PARAMETER: tuple[Any, Any] = (Text, Field(description="that is random"))


def distribution(name: str) -> type:
    """The distribution of this name."""
    return resolve_name(f"dalembert.design.reliability.distributions:{name}")  # type: ignore[no-any-return]


def _cut(name: str) -> Any:
    """The table of a distribution without a parameter."""
    return table_of(name, distribution(name))


def _random(name: str) -> Any:
    """The table of a random parameter."""
    more: dict[str, Any] = {"parameter": _PARAMETER}
    if name == "Truncated":
        more["of"] = (CUT, Field(description="what is cut: a distribution without `parameter`"))
    return table_of(name, distribution(name), title=f"Random{name}", more=more)


CUT = one_of({name: partial(_cut, name) for name in DISTRIBUTIONS if name != "Truncated"})
RANDOM = one_of({name: partial(_random, name) for name in DISTRIBUTIONS})


class CorrelationTable(Record):
    """Linear correlation of two random parameters."""

    between: list_of(Text, 2, "two parameters")  # type: ignore[valid-type]
    value: Number = Field(description="between −1 and 1")


class ReliabilityTable(Record):
    """Which limits must hold, and how ``dalembert reliability`` searches for where they break."""

    limits: list[LimitTable] = Field(description="what must hold, tables as below")
    correlation: list[CorrelationTable] = Field(
        default_factory=list, description="list of `{ between = [a, b], value = 0.3 }`"
    )
    system: one_name("dalembert.design.reliability.reliability:SYSTEMS") = Field(  # type: ignore[valid-type]
        default="series", description="one limit that breaks is failure, or all must: `parallel`"
    )
    method: one_name("dalembert.design.reliability.first_order:METHODS") = "sqp"  # type: ignore[valid-type]
    starts: Integer | None = Field(
        default=None, description="searches for each limit, to find further points; 3 by default"
    )
    tolerance: Number = 1e-8
    max_iterations: Integer = 100
    samples: Integer = Field(default=0, description="of an estimate beside; none by default")
    sampling: one_name("dalembert.design.reliability.reliability_result:SAMPLINGS") = Field(  # type: ignore[valid-type]
        default="importance-sampling",
        description="how they are drawn; or `monte-carlo`, `subset-simulation`, `openturns-subset`",
    )
    rng: Integer = Field(default=0, description="seed of starts and samples")


class AllotTable(Record):
    """The cheapest tolerances that keep a response within a limit."""

    limit: Number = Field(description="of the deviation of the response, on either side")
    costs: dict[str, Number] = Field(description="parameter → cost `c` of `c/t^exponent`")
    exponent: Number = 1.0
    bounds: Bounds = Field(  # type: ignore[valid-type]
        default=None, description="least and largest tolerance"
    )
    worst_case: Flag = False


class ToleranceTable(Record):
    """Which tolerances ``dalembert tolerance`` follows to which response."""

    response: Text = Field(description="name of a response that must come out right")
    tolerances: dict[str, Number] = Field(description="parameter → half width ±t")
    sigmas: Number = Field(default=3.0, description="how many standard deviations they are")
    second_order: Flag = Field(default=True, description="the second derivatives too")
    worst_case: Flag = Field(default=True, description="the extremes within all tolerances")
    samples: Integer = Field(default=0, description="of Monte Carlo beside; none by default")
    rng: Integer = Field(default=0, description="seed of the samples")
    allot: AllotTable = Field(  # type: ignore[assignment]
        default=None, description="which tolerances would be enough, a table as below"
    )
