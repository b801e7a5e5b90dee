"""Tables of design tasks: limits, optimisation, fronts, reliability, tolerances, synthesis."""

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
"""Classes of ``design.reliability.distributions``, imported on first use."""


class LimitTable(Record):
    """Limits on a response of a design."""

    response: Text
    lower: Number = None
    upper: Number = None


class CombinedTable(Record):
    """A formula of responses, used as objective or limit."""

    formula: Text = Field(description="of names of responses: `torque + 0.1*mass`")
    unit: Text = Field(default="", description="shown in results")


class RobustTable(Record):
    """Mean plus deviations of a response over the random parameters, as objective or limit."""

    response: Text
    deviations: Number = Field(
        default=3.0, description="standard deviations added to the mean; negative to subtract them"
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
        default=None,
        description="required reliability index of all limits, over the `[[random]]` parameters",
    )
    rounds: Integer = Field(default=20, description="of optimisation and reliability, with `beta`")
    method: one_name("dalembert.design.methods.registry:OPTIMIZERS") = "slsqp"  # type: ignore[valid-type]
    gradient: Method = "auto"  # type: ignore[valid-type]
    max_iterations: Integer = 100
    tolerance: Number = 1e-8


class ParetoTable(Record):
    """Objectives of the Pareto front of ``dalembert pareto``."""

    minimize: Names = Field(default_factory=list, description="names of responses to minimise")
    maximize: Names = Field(default_factory=list, description="names of responses to maximise")
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
        default="series", description="failure of any limit; or of all limits: `parallel`"
    )
    method: one_name("dalembert.design.reliability.first_order:METHODS") = "sqp"  # type: ignore[valid-type]
    starts: Integer | None = Field(
        default=None, description="searches for each limit, to find further points; 3 by default"
    )
    tolerance: Number = 1e-8
    max_iterations: Integer = 100
    samples: Integer = Field(
        default=0, description="of an additional estimate by sampling; none by default"
    )
    sampling: one_name("dalembert.design.reliability.reliability_result:SAMPLINGS") = Field(  # type: ignore[valid-type]
        default="importance-sampling",
        description="how they are drawn; or `monte-carlo`, `subset-simulation`, `openturns-subset`",
    )
    rng: Integer = Field(default=0, description="seed of starts and samples")


class AllotTable(Record):
    """Cost-optimal tolerances that keep a response within a limit."""

    limit: Number = Field(description="of the deviation of the response, on either side")
    costs: dict[str, Number] = Field(description="parameter → cost `c` of `c/t^exponent`")
    exponent: Number = 1.0
    bounds: Bounds = Field(  # type: ignore[valid-type]
        default=None, description="minimum and maximum tolerance"
    )
    worst_case: Flag = False


class ToleranceTable(Record):
    """Tolerances and the response analysed by ``dalembert tolerance``."""

    response: Text = Field(description="name of the response that is analysed")
    tolerances: dict[str, Number] = Field(description="parameter → half width ±t")
    sigmas: Number = Field(default=3.0, description="how many standard deviations they are")
    second_order: Flag = Field(default=True, description="the second derivatives too")
    worst_case: Flag = Field(default=True, description="the extremes within all tolerances")
    samples: Integer = Field(
        default=0, description="of an additional Monte Carlo estimate; none by default"
    )
    rng: Integer = Field(default=0, description="seed of the samples")
    allot: AllotTable = Field(  # type: ignore[assignment]
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
        description="of a six-bar or geared five-bar: joint → `[x, y]` in one position [m]",
    )
    marks: dict[Text, dict[Text, Position]] = Field(  # type: ignore[valid-type]
        default_factory=dict, description="link of it → point → `[x, y]` in the same position"
    )
    reach: Number = Field(
        default=None,
        description="half width of the range of the coordinates of joints and marks [m]",
    )
    ratio: Number = Field(default=None, description="of the speeds of gears")
    point: Text = Field(
        default="",
        description="of all but `FourBar` and `SliderCrank`: point that follows the target",
    )
    body: Text = Field(default="", description="body that is guided, of a motion")
    output: Text = Field(default="", description="measure prescribed by a function")
    vary: list[Text] = Field(
        default_factory=list, description="parameters; all with bounds by default"
    )
    speed: Number = Field(default=1.0, description="of the motor [rad/s]")
    points: list[Position] = Field(  # type: ignore[valid-type]
        default_factory=list, description="positions of the coupler point [m]"
    )
    file: Text = Field(
        default=None,
        description="CSV table in the same folder instead, columns named as these keys",
    )
    coupler_angles: list[Number] = Field(
        default_factory=list, description="of a motion: rotations of the coupler [rad]"
    )
    outputs: list[Number] = Field(
        default_factory=list, description="of a function: displacements of the output [rad], [m]"
    )
    crank_angles: list[Number] = Field(
        default_factory=list, description="rotations of the crank [rad]; free if none are given"
    )
    closed: Flag = Field(default=False, description="the path returns to its first point")
    bounds: dict[str, Bounds] = Field(  # type: ignore[valid-type]
        default_factory=dict, description="dimension or parameter → `[lower, upper]`"
    )
    crank_turns: Flag = Field(default=True, description="the crank rotates fully")
    transmission: Number = Field(default=0.0, description="minimum transmission angle [rad]")
    order: Flag = Field(default=True, description="points are passed in their order")
    starts: Integer = Field(default=24, description="number of candidates that are refined")
    rng: Integer = Field(default=0, description="seed of the random numbers")
