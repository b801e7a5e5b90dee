"""Tables of model files for tasks: gradients, optimisation, identification, studies, reports."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, WithJsonSchema

from dalembert.design.methods.registry import OPTIMIZERS
from dalembert.io.choices import Record
from dalembert.io.strategies import STRATEGIES_OF
from dalembert.io.tables import strategy_type
from dalembert.io.values import Bound, Integer, Number, Text, list_of, shown
from dalembert.sensitivity.methods import METHODS
from dalembert.text import nearest


def _one_name(known: Iterable[str]) -> Any:
    """One of these names."""
    names = list(known)

    def check(value: Any) -> str:
        if not isinstance(value, str) or value not in names:
            near = nearest(value, names)
            raise ValueError(f"unknown method {shown(value)}{near}; known: {', '.join(names)}")
        return value

    return Annotated[str, BeforeValidator(check), WithJsonSchema({"enum": names})]


Method = _one_name(METHODS)
Optimizing = _one_name(OPTIMIZERS)
SAMPLINGS = ("Grid", "LatinHypercube", "MonteCarlo", "Sobol", "Table")
"""How designs are chosen."""
Sampling = _one_name(SAMPLINGS)
Names = list[Text]
Bounds = list_of(Bound, 2, "lower, upper")


class SensitivityTable(Record):
    """Which gradients ``dalembert sensitivity`` computes."""

    responses: Names = Field(default_factory=list, description="names of responses; all by default")
    wrt: Names = Field(default_factory=list, description="names of parameters; all by default")
    method: Method = "auto"  # type: ignore[valid-type]


class LimitTable(Record):
    """A response that an optimal design keeps between limits."""

    response: Text
    lower: Number = None
    upper: Number = None


class OptimizeTable(Record):
    """What ``dalembert optimize`` minimises or maximises."""

    minimize: Text = None
    maximize: Text = None
    vary: Names = Field(
        default_factory=list, description="names of parameters; all with bounds by default"
    )
    integers: Names = Field(
        default_factory=list, description="those of them that take whole numbers"
    )
    catalogues: list[dict[Text, list[Number]]] = Field(
        default_factory=list, description="sizes to choose from: tables of parameters and values"
    )
    subject_to: list[LimitTable] = Field(default_factory=list)
    method: Optimizing = "slsqp"  # type: ignore[valid-type]
    gradient: Method = "auto"  # type: ignore[valid-type]
    max_iterations: Integer = 100
    tolerance: Number = 1e-8


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
    max_iterations: Integer = 100


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


class ReportTable(Record):
    """What the report shows first."""

    plots: list[list[Text]] = Field(default_factory=list, description="measures, one list per plot")
    trace: Names = Field(default_factory=list, description="points whose paths are drawn")
    units: Names = Field(
        default_factory=list,
        description='of plots and of CSV files, as `["mm", "deg"]`; each serves its dimension',
    )
