"""Experiments: measurements and the conditions of their runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.design.identification.data_table import read_table
from dalembert.errors import AnalysisError, ExpressionError
from dalembert.options import options
from dalembert.results.analysis import Analysis
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.wording import nearest

TIMES = ("time", "t")
"""Default names of the time column."""
Measures = Mapping[str, str | Expression] | Sequence[str] | None


@options(kw_only=True)
class Experiment:
    """Measurements of one run with its conditions.

    Parameters
    ----------
    data : DataFrame, mapping of columns, or path of a .csv or .parquet file
    name : in results; by default its number
    parameters : known parameter values of this run, by name
    own : unknown parameters of this run alone, such as its initial state
    analysis : of this run; by default that of ``identify``

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
    >>> result = da.identify(system.build(), runs, vary=["mass"])
    >>> round(result.x["mass"], 4)  # x = F t²/(2 m); the second run does not depend on it
    8.0
    """

    data: Any
    name: str = ""
    parameters: Mapping[str, float] = field(default_factory=dict)
    own: Sequence[str] = ()
    analysis: Analysis | None = None


@dataclass(frozen=True)
class Observation:
    """Observation of an experiment: times, data columns and their measures.

    Attributes
    ----------
    times : (K,) [s], in order
    columns : names
    measures : an expression of the model for each column
    values : (K, columns), NaN for missing samples
    noise : (K, columns) standard deviations; NaN if they are to be estimated
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
        """(K, columns) mask of the available samples."""
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
    """Observation of an experiment, checked against the model.

    Raises
    ------
    AnalysisError
        The time column is missing, a column matches no measure, or has no or infinite numbers.
    """
    table = read_table(experiment.data)
    name = experiment.name or f"experiment {number}"
    time_column = _time_column(table, time, name)
    order = np.argsort(table[time_column], kind="stable")
    times = table[time_column][order]
    if not np.all(np.isfinite(times)):
        raise AnalysisError(f"{name}: the times in column {time_column!r} are not all numbers")
    deviations = {n for n in noise.values() if isinstance(n, str)}
    candidates = [n for n in table if n != time_column and n not in deviations]
    measured = _measures(model, measures, candidates, name)
    values = np.column_stack([table[column][order] for column in measured])
    for column, numbers in zip(measured, values.T, strict=True):
        if np.any(np.isinf(numbers)):
            raise AnalysisError(f"{name}: column {column!r} holds infinite numbers; leave them out")
        if not np.any(np.isfinite(numbers)):
            raise AnalysisError(f"{name}: column {column!r} holds no numbers; leave it out")
    sigma = np.column_stack([_noise(table, noise.get(c), order, c, name) for c in measured])
    run_analysis = experiment.analysis or analysis or _default_analysis(times, name)
    columns, expressions = tuple(measured), tuple(measured.values())
    return Observation(name, experiment, run_analysis, times, columns, expressions, values, sigma)


def _time_column(table: Mapping[str, np.ndarray], time: str | None, name: str) -> str:
    column = next((n for n in ((time,) if time else TIMES) if n in table), None)
    if column is None:
        expected = repr(time) if time else " or ".join(map(repr, TIMES))
        raise AnalysisError(
            f"{name}: the data has no column {expected} of times; name it with time=... "
            f"(columns of numbers: {', '.join(table)})"
        )
    return column


def _measures(
    model: ParametricModel, measures: Measures, columns: Sequence[str], name: str
) -> dict[str, Expression]:
    """Column → scalar measure."""
    if measures is None:
        measures = list(columns)
    requested = measures if isinstance(measures, Mapping) else {m: m for m in measures}
    expressions = {}
    for column, measure in requested.items():
        if column not in columns:
            raise AnalysisError(
                f"{name}: the data has no column {column!r} of numbers{nearest(column, columns)} "
                f"(there are: {', '.join(columns) or 'none'})"
            )
        try:
            expressions[column] = model.expression(measure)
        except ExpressionError as error:
            raise AnalysisError(
                f"{name}: column {column!r} matches no measure ({error}); assign one "
                f"with measures={{{column!r}: ...}}"
            ) from None
        if len(expressions[column]) != 1:
            raise AnalysisError(
                f"{name}: the measure of column {column!r} has {len(expressions[column])} "
                "components; use .x or .y"
            )
    if not expressions:
        raise AnalysisError(f"{name}: the data has no column besides its times")
    return expressions


def _noise(
    table: Mapping[str, np.ndarray],
    noise: float | str | None,
    order: np.ndarray,
    column: str,
    name: str,
) -> np.ndarray:
    """(K,) standard deviations of a column."""
    if isinstance(noise, str):
        if noise not in table:
            raise AnalysisError(f"{name}: the data has no column {noise!r} of deviations")
        deviations = table[noise][order]
    else:
        deviations = np.full(order.size, np.nan if noise is None else float(noise))
    if noise is not None and not np.all(deviations > 0):
        raise AnalysisError(f"{name}: the noise of column {column!r} must be above zero")
    return deviations


def _default_analysis(times: np.ndarray, name: str) -> Dynamics:
    if times[0] < 0 or times[-1] <= 0:
        raise AnalysisError(
            f"{name}: its times {times[0]:g}…{times[-1]:g} s do not begin at t = 0; give "
            "analysis=da.Dynamics(t_span=(start, end))"
        )
    return Dynamics(float(times[-1]))
