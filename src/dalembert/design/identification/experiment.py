"""An experiment: what was measured, and under what conditions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.design.identification.table import read_table
from dalembert.errors import AnalysisError, ExpressionError
from dalembert.options import options
from dalembert.results.result import Analysis
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.wording import nearest

TIMES = ("time", "t")
"""Names of the column of times where none is given."""
Measures = Mapping[str, str | Expression] | Sequence[str] | None


@options(kw_only=True)
class Experiment:
    """Measurements of one run, with the conditions it was made under.

    Parameters
    ----------
    data : DataFrame, mapping of columns, or path of a .csv or .parquet file
    name : in results; its number by default
    parameters : values that this run had, by name
    own : parameters that are unknown and this run's own, such as its initial state
    analysis : how this run is simulated; by default as the others

    Examples
    --------
    >>> import numpy as np
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("sledge")
    >>> speed, push = system.parameter("speed", 0.0), system.parameter("push", 0.0, "N")
    >>> mass = system.parameter("mass", 5.0, "kg", bounds=(1, 20))
    >>> sledge = system.add(planar.Particle("sledge", mass=mass, velocity=(speed, 0)))
    >>> force = system.add(planar.Force("force", sledge.center, (push, 0)))
    >>> t = np.linspace(0, 1, 11)
    >>> first = da.Experiment(data={"t": t, "sledge.x": t**2 / 4}, parameters={"push": 4.0})
    >>> other = da.Experiment(data={"t": t, "sledge.x": t}, parameters={"speed": 1.0})
    >>> runs = [first, other]
    >>> found = da.identify(system.build(), runs, vary=["mass"])
    >>> round(found.x["mass"], 4)  # x = F t²/(2 m); the second run tells nothing of it
    8.0
    """

    data: Any
    name: str = ""
    parameters: Mapping[str, float] = field(default_factory=dict)
    own: Sequence[str] = ()
    analysis: Analysis | None = None


@dataclass(frozen=True)
class Observation:
    """An experiment made ready: times, columns of the data, and the measures they belong to.

    Attributes
    ----------
    times : (K,) [s], in order
    columns : names
    measures : an expression of the model for each column
    values : (K, columns), NaN where a sample is missing
    noise : (K, columns) standard deviations; NaN where they are to be estimated
    """

    name: str
    experiment: Experiment
    analysis: Analysis
    times: np.ndarray
    columns: tuple[str, ...]
    measures: tuple[Expression, ...]
    values: np.ndarray
    noise: np.ndarray

    @property
    def present(self) -> np.ndarray:
        """(K, columns) which samples there are."""
        return np.isfinite(self.values)


def observe(
    model: ParametricModel,
    experiment: Experiment,
    number: int,
    measures: Measures,
    time: str | None,
    noise: Mapping[str, float | str],
    analysis: Analysis | None,
) -> Observation:
    """The data of an experiment, checked against the model.

    Raises
    ------
    AnalysisError
        No times, columns that match no measure, no or infinite numbers.
    """
    table = read_table(experiment.data)
    name = experiment.name or f"experiment {number}"
    clock = _clock(table, time, name)
    order = np.argsort(table[clock], kind="stable")
    times = table[clock][order]
    if not np.all(np.isfinite(times)):
        raise AnalysisError(f"{name}: the times in column {clock!r} are not all numbers")
    deviations = {n for n in noise.values() if isinstance(n, str)}
    rest = [n for n in table if n != clock and n not in deviations]
    found = _measures(model, measures, rest, name)
    values = np.column_stack([table[column][order] for column in found])
    for column, numbers in zip(found, values.T, strict=True):
        if np.any(np.isinf(numbers)):
            raise AnalysisError(f"{name}: column {column!r} holds infinite numbers; leave them out")
        if not np.any(np.isfinite(numbers)):
            raise AnalysisError(f"{name}: column {column!r} holds no number at all; leave it out")
    given = np.column_stack([_noise(table, noise.get(c), order, c, name) for c in found])
    chosen = experiment.analysis or analysis or _default(times, name)
    columns, expressions = tuple(found), tuple(found.values())
    return Observation(name, experiment, chosen, times, columns, expressions, values, given)


def _clock(table: Mapping[str, np.ndarray], time: str | None, name: str) -> str:
    clock = next((n for n in ((time,) if time else TIMES) if n in table), None)
    if clock is None:
        wanted = repr(time) if time else " or ".join(map(repr, TIMES))
        raise AnalysisError(
            f"{name}: the data has no column {wanted} of times; name it with time=... "
            f"(columns of numbers: {', '.join(table)})"
        )
    return clock


def _measures(
    model: ParametricModel, measures: Measures, columns: Sequence[str], name: str
) -> dict[str, Expression]:
    """Column → scalar measure."""
    if measures is None:
        measures = list(columns)
    asked = measures if isinstance(measures, Mapping) else {m: m for m in measures}
    found = {}
    for column, measure in asked.items():
        if column not in columns:
            raise AnalysisError(
                f"{name}: the data has no column {column!r} of numbers{nearest(column, columns)} "
                f"(there are: {', '.join(columns) or 'none'})"
            )
        try:
            found[column] = model.expression(measure)
        except ExpressionError as error:
            raise AnalysisError(
                f"{name}: column {column!r} matches no measure ({error}); say what it measures "
                f"with measures={{{column!r}: ...}}"
            ) from None
        if len(found[column]) != 1:
            raise AnalysisError(
                f"{name}: the measure of column {column!r} has {len(found[column])} components; "
                "take .x or .y"
            )
    if not found:
        raise AnalysisError(f"{name}: the data has no column beside its times")
    return found


def _noise(
    table: Mapping[str, np.ndarray], given: Any, order: np.ndarray, column: str, name: str
) -> np.ndarray:
    """(K,) standard deviations of a column."""
    if isinstance(given, str):
        if given not in table:
            raise AnalysisError(f"{name}: the data has no column {given!r} of deviations")
        made = table[given][order]
    else:
        made = np.full(order.size, np.nan if given is None else float(given))
    if given is not None and not np.all(made > 0):
        raise AnalysisError(f"{name}: the noise of column {column!r} must be above zero")
    return made


def _default(times: np.ndarray, name: str) -> Dynamics:
    if times[0] < 0 or times[-1] <= 0:
        raise AnalysisError(
            f"{name}: its times {times[0]:g}…{times[-1]:g} s do not begin at t = 0; give "
            "analysis=da.Dynamics(t_span=(start, end))"
        )
    return Dynamics(float(times[-1]))
