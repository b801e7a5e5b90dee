"""Tables of model files for tasks: gradients, measurements, studies, comparisons, reports."""

from __future__ import annotations

from pydantic import Field

from dalembert.io.choices import Record, table_or
from dalembert.io.strategies import STRATEGIES_OF
from dalembert.io.tables import strategy_type
from dalembert.io.values import Bound, Entry, Integer, Number, OwnNumber, Text, list_of, one_name

Method = one_name("dalembert.sensitivity.methods:METHODS")
SAMPLINGS = ("Grid", "LatinHypercube", "MonteCarlo", "Sobol", "Table")
"""How designs are chosen."""
Sampling = one_name(SAMPLINGS)
Names = list[Text]
Bounds = list_of(Bound, 2, "lower, upper")


class SensitivityTable(Record):
    """Which gradients ``dalembert sensitivity`` computes."""

    responses: Names = Field(default_factory=list, description="names of responses; all by default")
    wrt: Names = Field(default_factory=list, description="names of parameters; all by default")
    method: Method = "auto"  # type: ignore[valid-type]


class ExperimentTable(Record):
    """Measurements of one run, with the conditions it was made under."""

    data: Text
    name: Text = ""
    parameters: dict[str, Number] = Field(
        default_factory=dict, description="name of a parameter → value that this run had"
    )
    own: Names = Field(
        default_factory=list, description="parameters that are unknown and this run's own"
    )


class IdentifyTable(Record):
    """Which parameters ``dalembert identify`` finds from which measurements."""

    data: Text = None
    experiments: list[ExperimentTable] = Field(
        default_factory=list, description="list of runs, tables as below, instead of `data`"
    )
    measures: dict[str, Text] = Field(
        default_factory=dict,
        description="column → measure or formula; columns named as measures by default",
    )
    vary: Names = Field(
        default_factory=list, description="names of parameters; all with bounds by default"
    )
    time: Text = None
    noise: dict[str, Number] = Field(
        default_factory=dict, description="column → standard deviation; estimated by default"
    )
    delays: dict[str, Bounds] = Field(  # type: ignore[valid-type]
        default_factory=dict, description="column → `[least, most]` of an unknown lag [s]"
    )
    loss: Text = "linear"
    starts: Integer = Field(default=1, description="searches, from further values between bounds")
    rng: Integer = Field(default=0, description="seed of the starts")
    max_iterations: Integer = 100


class KnotsTable(Record):
    """Knots at even distances."""

    start: Number = Field(default=0.0, description="first [s]")
    end: Number = Field(description="last [s]")
    count: Integer = Field(description="how many, four at least")


class HistoryTable(Record):
    """An unknown function of time: a spline whose values at knots are parameters."""

    knots: table_or(KnotsTable, list[Number]) = Field(  # type: ignore[valid-type]
        description="times, or a table `{ start, end, count }` [s]"
    )
    value: OwnNumber = Field(default=0.0, description="at all knots at first")
    unit: Text = Field(
        default="", description='of the value, as `"kN"`, and shown in results; SI by default'
    )
    ends: Text = Field(default="not-a-knot", description="of the spline, as of `Table`")


class InvertTable(Record):
    """From which measurements ``dalembert invert`` finds the histories of the file."""

    data: Text = Field(default=None, description="file of measurements beside this one")
    measures: dict[str, Text] = Field(
        default_factory=dict,
        description="column → measure or formula; columns named as measures by default",
    )
    vary: Names = Field(
        default_factory=list, description="further unknown parameters, such as initial values"
    )
    smoothing: Entry = Field(
        default="likelihood",
        description='`"likelihood"`, `"cross-validation"`, `"l-curve"`, `"discrepancy"` (needs '
        "noise), or a number",
    )
    order: Integer = Field(default=2, description="of the derivative that is to be small")
    time: Text = Field(default=None, description="column of the times; `time` or `t` by default")
    noise: dict[str, Number] = Field(
        default_factory=dict, description="column → standard deviation; estimated by default"
    )
    max_iterations: Integer = 50


class SweepTable(Record):
    """Which designs ``dalembert sweep`` runs."""

    type: Sampling = "Sobol"  # type: ignore[valid-type]
    vary: dict[str, list[Number]] = Field(
        default_factory=dict,
        description="parameter → lower and upper end, of `Grid` and `Table` its values; "
        "all with bounds by default",
    )
    samples: Integer = Field(default=64, description="how many designs, where they are drawn")
    rng: Integer = Field(default=0, description="seed of what is drawn")
    responses: Names = Field(default_factory=list, description="names of responses; all by default")


_COORDINATES, _FORMULATION, _STABILIZATION, _INTEGRATOR = map(strategy_type, STRATEGIES_OF)


class CompareTable(Record):
    """What ``dalembert compare`` combines."""

    formulations: list[_FORMULATION] = Field(default_factory=list)  # type: ignore[valid-type]
    integrators: list[_INTEGRATOR] = Field(default_factory=list)  # type: ignore[valid-type]
    stabilizations: list[_STABILIZATION] = Field(default_factory=list)  # type: ignore[valid-type]
    coordinates: list[_COORDINATES] = Field(default_factory=list)  # type: ignore[valid-type]
    steps: list[Number] = Field(
        default_factory=list, description="of integrators with fixed steps [s]"
    )
    tolerances: list[Number] = Field(
        default_factory=list, description="of integrators that control their steps"
    )
    measure: Text = Field(
        default=None, description="whose error is told; all coordinates by default"
    )
    repeat: Integer = Field(default=1, description="how often each run is timed")


class StructureReportTable(Record):
    """In which units the report of a structure shows its numbers."""

    units: Names = Field(
        default_factory=list,
        description='of the page and of CSV files, as `["mm", "MPa"]`; each serves its dimension',
    )


class ReportTable(Record):
    """What the report shows first."""

    plots: list[list[Text]] = Field(default_factory=list, description="measures, one list per plot")
    trace: Names = Field(default_factory=list, description="points whose paths are drawn")
    units: Names = Field(
        default_factory=list,
        description='of plots and of CSV files, as `["mm", "deg"]`; each serves its dimension',
    )
