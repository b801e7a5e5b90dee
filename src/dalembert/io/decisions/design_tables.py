"""Tables of design tasks: limits, optimisation, fronts, reliability, tolerances, synthesis."""

from __future__ import annotations

from functools import partial
from pkgutil import resolve_name
from typing import Any

from pydantic import Field

from dalembert.io.choices import Record, one_of
from dalembert.io.tables import table_of
from dalembert.io.values import Count, Flag, Integer, Number, Text, list_of, one_name

Method = one_name("dalembert.sensitivity.methods:METHODS")
Names = list[Text]
Bounds = list_of(Number, 2, "lower, upper")
VARIED = "names of parameters; all with bounds by default"
LIMITS = "list of limits, tables as below"
DISTRIBUTIONS = ("Normal", "Lognormal", "Uniform", "Weibull", "Gumbel", "Truncated")
"""Classes of ``design.reliability.distributions``, imported on first use."""


class LimitTable(Record):
    """Limits on a response of a design."""

    response: Text
    lower: Number = None
    upper: Number = None


class CombinedTable(Record):
    """A formula of responses, used as objective or limit."""

    formula: Text = Field(description="formula of responses: `torque + 0.1*mass`")
    unit: Text = Field(default="", description="unit in results")


class RobustTable(Record):
    """Mean plus deviations of a response over the random parameters, as objective or limit."""

    response: Text
    deviations: Number = Field(
        default=3.0, description="standard deviations added to the mean; negative to subtract them"
    )


class OptimizeTable(Record):
    """Objective, variables and limits of ``dalembert optimize``."""

    minimize: Text = None
    maximize: Text = None
    vary: Names = Field(default_factory=list, description=VARIED)
    integers: Names = Field(default_factory=list, description="integer parameters among them")
    catalogues: list[dict[Text, list[Number]]] = Field(
        default_factory=list, description="catalogues: tables of parameters and values"
    )
    subject_to: list[LimitTable] = Field(default_factory=list, description=LIMITS)
    beta: Number = Field(
        default=None,
        description="required reliability index of all limits, over the `[[random]]` parameters",
    )
    rounds: Integer = Field(default=20, description="maximum number of rounds, with `beta`")
    method: one_name("dalembert.design.methods.registry:OPTIMIZERS") = "slsqp"  # type: ignore[valid-type]
    gradient: Method = "auto"  # type: ignore[valid-type]
    max_iterations: Integer = 100
    tolerance: Number = 1e-8


class ParetoTable(Record):
    """Objectives of the Pareto front of ``dalembert pareto``."""

    minimize: Names = Field(default_factory=list, description="names of responses to minimise")
    maximize: Names = Field(default_factory=list, description="names of responses to maximise")
    vary: Names = Field(default_factory=list, description=VARIED)
    integers: Names = Field(
        default_factory=list, description="as in `[optimize]`; evolutionary methods only"
    )
    catalogues: list[dict[Text, list[Number]]] = Field(
        default_factory=list, description="as in `[optimize]`; evolutionary methods only"
    )
    subject_to: list[LimitTable] = Field(default_factory=list, description=LIMITS)
    method: one_name("dalembert.design.pareto.pareto:METHODS") = "normal-constraint"  # type: ignore[valid-type]
    points: Integer = Field(default=15, description="points per objective; or population")
    local: one_name("dalembert.design.methods.registry:OPTIMIZERS") = Field(  # type: ignore[valid-type]
        default="slsqp", description="gradient method of each point"
    )
    starts: Count = Field(default=1, description="searches per point")
    gradient: Method = "auto"  # type: ignore[valid-type]
    max_iterations: Integer = 100
    tolerance: Number = 1e-8
    generations: Integer = Field(default=100, description="of evolutionary methods")
    rng: Integer = Field(default=0, description="seed of random numbers")


_PARAMETER: tuple[Any, Any] = (Text, Field(description="name of the random parameter"))


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
        more["of"] = (CUT, Field(description="truncated distribution, without `parameter`"))
    return table_of(name, distribution(name), title=f"Random{name}", more=more)


CUT = one_of({name: partial(_cut, name) for name in DISTRIBUTIONS if name != "Truncated"})
RANDOM = one_of({name: partial(_random, name) for name in DISTRIBUTIONS})


class CorrelationTable(Record):
    """Linear correlation of two random parameters."""

    between: list_of(Text, 2, "two parameters")  # type: ignore[valid-type]
    value: Number = Field(description="between −1 and 1")


class ReliabilityTable(Record):
    """Limit states of ``dalembert reliability``, and the search for their design points."""

    limits: list[LimitTable] = Field(description="limit states, tables as below")
    correlation: list[CorrelationTable] = Field(
        default_factory=list, description="list of `{ between = [a, b], value = 0.3 }`"
    )
    system: one_name("dalembert.design.reliability.reliability:SYSTEMS") = Field(  # type: ignore[valid-type]
        default="series",
        description="failure if any limit is violated; `parallel`: if all are",
    )
    method: one_name("dalembert.design.reliability.first_order:METHODS") = "sqp"  # type: ignore[valid-type]
    starts: Count | None = Field(
        default=None, description="searches for design points of each limit; 3 by default"
    )
    tolerance: Number = 1e-8
    max_iterations: Integer = 100
    samples: Integer = Field(default=0, description="samples of an additional estimate")
    sampling: one_name("dalembert.design.reliability.reliability_result:SAMPLINGS") = Field(  # type: ignore[valid-type]
        default="importance-sampling",
        description="or `monte-carlo`, `subset-simulation`, `openturns-subset`",
    )
    rng: Integer = Field(default=0, description="seed of starts and samples")


class AllocateTable(Record):
    """Cost-optimal tolerances that keep a response within a limit."""

    limit: Number = Field(description="limit of the deviation of the response, on both sides")
    costs: dict[str, Number] = Field(description="parameter → cost `c` of `c/t^exponent`")
    exponent: Number = 1.0
    bounds: Bounds = Field(  # type: ignore[valid-type]
        default=None, description="minimum and maximum tolerance"
    )
    worst_case: Flag = False


class ToleranceTable(Record):
    """Tolerances and the response analysed by ``dalembert tolerance``."""

    response: Text = Field(description="name of the response")
    tolerances: dict[str, Number] = Field(description="parameter → half width ±t")
    sigmas: Number = Field(default=3.0, description="number of standard deviations in a tolerance")
    second_order: Flag = Field(
        default=True, description="mean and standard deviation to second order"
    )
    worst_case: Flag = Field(default=True, description="extremes within all tolerances")
    samples: Integer = Field(default=0, description="samples of an additional Monte Carlo estimate")
    rng: Integer = Field(default=0, description="seed of the samples")
    allocate: AllocateTable = Field(  # type: ignore[assignment]
        default=None, description="allocation of tolerances, a table as below"
    )


TARGETS = ("path", "motion", "function")
"""Types of synthesis targets."""
Position = list_of(Number, 2, "x, y")


class SynthesisTable(Record):
    """Target and mechanism of ``dalembert synthesize``."""

    type: one_name(TARGETS) = Field(  # type: ignore[valid-type]
        description='`"path"`, `"motion"` or `"function"`'
    )
    linkage: one_name("dalembert.io.decisions.synthesis:KINDS") = Field(  # type: ignore[valid-type]
        default="FourBar",
        description='`"FourBar"`, `"SliderCrank"`; a six-bar: `"watt I"`, `"watt II"`, '
        '`"stephenson I"`, `"stephenson II"`, `"stephenson III"`; `"geared five-bar"`; '
        '`"own"`, the mechanism of this file',
    )
    joints: dict[Text, Position] = Field(  # type: ignore[valid-type]
        default_factory=dict,
        description="joints of a six-bar or geared five-bar: name → `[x, y]` in one position [m]",
    )
    marks: dict[Text, dict[Text, Position]] = Field(  # type: ignore[valid-type]
        default_factory=dict, description="link → point → `[x, y]` in the same position"
    )
    reach: Number = Field(
        default=None,
        description="half width of the range of the coordinates of joints and marks [m]",
    )
    ratio: Number = Field(default=None, description="gear ratio")
    point: Text = Field(
        default="",
        description="point that follows the target; not for `FourBar` and `SliderCrank`",
    )
    body: Text = Field(default="", description="guided body, for a motion")
    output: Text = Field(default="", description="measure prescribed by a function")
    vary: list[Text] = Field(
        default_factory=list, description="parameters; all with bounds by default"
    )
    speed: Number = Field(default=1.0, description="speed of the motor [rad/s]")
    points: list[Position] = Field(  # type: ignore[valid-type]
        default_factory=list, description="positions of the coupler point [m]"
    )
    file: Text = Field(
        default=None,
        description="CSV table in the same folder; its columns have the names of these keys",
    )
    coupler_angles: list[Number] = Field(
        default_factory=list, description="rotations of the coupler [rad], for a motion"
    )
    outputs: list[Number] = Field(
        default_factory=list, description="displacements of the output [rad], [m], for a function"
    )
    crank_angles: list[Number] = Field(
        default_factory=list, description="rotations of the crank [rad]; free by default"
    )
    closed: Flag = Field(default=False, description="the path returns to its first point")
    bounds: dict[str, Bounds] = Field(  # type: ignore[valid-type]
        default_factory=dict, description="dimension or parameter → `[lower, upper]`"
    )
    crank_turns: Flag = Field(default=True, description="the crank rotates fully")
    transmission: Number = Field(default=0.0, description="minimum transmission angle [rad]")
    order: Flag = Field(default=True, description="points are passed in their order")
    starts: Count = Field(default=24, description="number of optimised candidates")
    rng: Integer = Field(default=0, description="seed of the random numbers")
