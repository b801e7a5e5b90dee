"""Tables of tasks: gradients, measurements, studies, trajectories, comparisons, reports."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import Field

from dalembert.formulations.base import Formulation
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Integrator
from dalembert.io.choices import Record, table_or
from dalembert.io.decisions.design_tables import LIMITS, LimitTable, Method, Names
from dalembert.io.strategies import TRAJECTORY_METHODS
from dalembert.io.tables import name_or_table, strategy_type
from dalembert.io.values import (
    Bound,
    Count,
    Entry,
    Flag,
    Integer,
    Number,
    NumberOrBounds,
    OwnNumber,
    Text,
    list_of,
    one_name,
)
from dalembert.model.graph.coordinates import Coordinates

SAMPLINGS = ("Grid", "LatinHypercube", "MonteCarlo", "Sobol", "Table")
"""Sampling methods of designs."""
Sampling = one_name(SAMPLINGS)
Bounds = list_of(Bound, 2, "lower, upper")


class SensitivityTable(Record):
    """Gradients computed by ``dalembert sensitivity``."""

    responses: Names = Field(default_factory=list, description="names of responses; all by default")
    wrt: Names = Field(default_factory=list, description="names of parameters; all by default")
    method: Method = "auto"  # type: ignore[valid-type]


class ExperimentTable(Record):
    """Measurements of one run and its conditions."""

    data: Text
    name: Text = ""
    parameters: dict[str, Number] = Field(
        default_factory=dict, description="name of a parameter → its value in this run"
    )
    own: Names = Field(default_factory=list, description="unknown parameters of this run only")


class IdentifyTable(Record):
    """Parameters and measurements of ``dalembert identify``."""

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
        default_factory=dict, description="column → `[lower, upper]` of an unknown lag [s]"
    )
    loss: Text = "linear"
    starts: Count = Field(default=1, description="number of searches from different values")
    rng: Integer = Field(default=0, description="seed of the starts")
    max_iterations: Integer = 100


class KnotsTable(Record):
    """Equidistant knots."""

    start: Number = Field(default=0.0, description="first [s]")
    end: Number = Field(description="last [s]")
    count: Integer = Field(description="number of knots, at least four")


class HistoryTable(Record):
    """An unknown function of time: a spline whose values at knots are parameters."""

    knots: table_or(KnotsTable, list[Number]) = Field(  # type: ignore[valid-type]
        description="times, or a table `{ start, end, count }` [s]"
    )
    value: OwnNumber = Field(default=0.0, description="initial value at all knots")
    unit: Text = Field(
        default="", description='unit of the value, also in results, such as `"kN"`; SI by default'
    )
    ends: Text = Field(
        default="not-a-knot", description="end conditions of the spline, as for `Table`"
    )

    def times(self) -> np.ndarray:
        """Times of the knots [s]."""
        if isinstance(self.knots, KnotsTable):
            return np.linspace(self.knots.start, self.knots.end, max(self.knots.count, 0))
        return np.asarray(self.knots, dtype=float)


class InvertTable(Record):
    """Measurements for the histories that ``dalembert invert`` estimates."""

    data: Text = Field(default=None, description="file of measurements in the same folder")
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
    order: Integer = Field(default=2, description="order of the derivative that is penalised")
    time: Text = Field(default=None, description="column of the times; `time` or `t` by default")
    noise: dict[str, Number] = Field(
        default_factory=dict, description="column → standard deviation; estimated by default"
    )
    max_iterations: Integer = 50


class SweepTable(Record):
    """Designs run by ``dalembert sweep``."""

    type: Sampling = "Sobol"  # type: ignore[valid-type]
    vary: dict[str, list[Number]] = Field(
        default_factory=dict,
        description="parameter → lower and upper end, of `Grid` and `Table` its values; "
        "all with bounds by default",
    )
    samples: Integer = Field(default=64, description="number of designs, of random sampling")
    rng: Integer = Field(default=0, description="seed of the random numbers")
    responses: Names = Field(default_factory=list, description="names of responses; all by default")


GUESSES = ("line", "simulate")
"""Initial guesses of a trajectory."""


class TrajectoryTable(Record):
    """Motion and controls optimised by ``dalembert trajectory``."""

    minimize: Text = Field(
        default="time", description='name of a response; `"time"` is the duration'
    )
    controls: Names = Field(description="parameters of forces that become functions of time")
    duration: NumberOrBounds = Field(description="or its bounds `[lower, upper]` [s]")
    begin: dict[Text, NumberOrBounds] = Field(
        default_factory=dict,
        description="measure → value or `[lower, upper]`; the start of the model by default",
    )
    end: dict[Text, NumberOrBounds] = Field(
        default_factory=dict, description="measure → value or `[lower, upper]`, `inf` for none"
    )
    cyclic: Names = Field(
        default_factory=list, description="measures with equal initial and final values"
    )
    subject_to: list[LimitTable] = Field(default_factory=list, description=LIMITS)
    vary: Names = Field(
        default_factory=list, description="parameters that are designed with the motion"
    )
    guess: Text = Field(
        default=None,
        description='`"line"` to the prescribed final positions, the default if there are some, '
        'or `"simulate"`',
    )
    accuracy: Number = Field(
        default=1e-3,
        description="maximum distance of the plan and the run under its controls, natural scales",
    )
    method: name_or_table(TRAJECTORY_METHODS) = "DirectCollocation"  # type: ignore[valid-type]


_COORDINATES, _FORMULATION, _STABILIZATION, _INTEGRATOR = map(
    strategy_type, (Coordinates, Formulation, Stabilization, Integrator)
)


class CompareTable(Record):
    """Strategies combined by ``dalembert compare``."""

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
        default=None, description="measure whose error is reported; all coordinates by default"
    )
    repeat: Integer = Field(default=1, description="number of timed repetitions of each run")


LIVE: Any = Field(
    default=None,
    description="whether the page runs the model again while sliders move parameters; by default "
    "if parameters have bounds and the page stays small",
)

NOTES: Any = Field(default_factory=list, description="texts of a card, such as questions")


class StructureReportTable(Record):
    """Units of the report of a structure."""

    units: Names = Field(
        default_factory=list,
        description='of the page and CSV files, as `["mm", "MPa"]`; each applies to its dimension',
    )
    live: Flag = LIVE
    notes: Names = NOTES


class ReportTable(Record):
    """Initial view of the report."""

    plots: list[list[Text]] = Field(default_factory=list, description="measures, one list per plot")
    trace: Names = Field(default_factory=list, description="points whose paths are drawn")
    units: Names = Field(
        default_factory=list,
        description='of plots and CSV files, as `["mm", "deg"]`; each applies to its dimension',
    )
    live: Flag = LIVE
    notes: Names = NOTES
