"""Samples of a batch: measures of all designs at common instants, and their dataset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from dalembert.budget import check_budget
from dalembert.model.graph.model import Model
from dalembert.results.files.contents import COMPONENTS
from dalembert.results.result import Result
from dalembert.results.variables import variables
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.parametric_model import ParametricModel

if TYPE_CHECKING:
    import xarray as xr


TIME_TOLERANCE = 1e-12
"""Tolerance of equal times, relative to the run."""


class Samples(Protocol):
    """Measures of all designs at the same instants; NaN where a design did not reach them."""

    @property
    def time(self) -> np.ndarray:
        """(K,) instants, or numbers of load cases."""
        ...

    def table(self, measures: Sequence[Expression]) -> np.ndarray:
        """(designs, rows, K) all components of measures, stacked by rows."""
        ...


@dataclass(eq=False)
class Gathered:
    """Samples of results from separate runs.

    Attributes
    ----------
    count : number of designs
    results : number of the design → its result, if it has one
    """

    count: int
    results: Mapping[int, Result]

    @cached_property
    def time(self) -> np.ndarray:
        """Instants of the successful designs, else of the one with the longest run."""
        completed = [r for r in self.results.values() if r.status.success] or list(
            self.results.values()
        )
        return max((r.time for r in completed), key=np.size, default=np.zeros(0))

    def table(self, measures: Sequence[Expression]) -> np.ndarray:
        rows = sum(len(measure) for measure in measures)
        table = np.full((self.count, rows, self.time.size), np.nan)
        for k, result in self.results.items():
            write_samples(table[k], self.time, result, measures)
        return table


def write_samples(
    table: np.ndarray, time: np.ndarray, result: Result, measures: Sequence[Expression]
) -> None:
    """Write the measures of one result into the columns (rows, K) of its instants."""
    columns = match_instants(time, result.time)
    matched = columns >= 0
    values = [np.asarray(result.values(m), dtype=float) for m in measures]
    rows = np.vstack([v.reshape(result.time.size, -1).T for v in values])
    table[:, columns[matched]] = rows[:, matched]


def match_instants(time: np.ndarray, requested: np.ndarray) -> np.ndarray:
    """Index of each requested instant in ``time``, −1 if absent."""
    if not time.size or not requested.size:
        return np.full(requested.size, -1)
    slack = TIME_TOLERANCE * max(abs(float(time[0])), abs(float(time[-1])))
    after = np.clip(np.searchsorted(time, requested), 0, time.size - 1)
    before = np.maximum(after - 1, 0)
    nearer = abs(time[before] - requested) < abs(time[after] - requested)
    index = np.where(nearer, before, after)
    return np.where(abs(time[index] - requested) <= slack, index, -1)


def complex_amplitudes(batch: Any, measure: str | Expression) -> xr.DataArray:
    """Complex amplitudes of a measure of harmonic responses, by design, frequency and input."""
    import xarray as xr

    first: Any = next(iter(batch.results.values()))
    table = np.full((len(batch), batch.samples.time.size, len(first.inputs)), np.nan, complex)
    for k, result in batch.results.items():
        columns = match_instants(batch.samples.time, result.time)
        table[k, columns[columns >= 0]] = result.complex_values(measure)[columns >= 0]
    coords = {**batch.coords, "input": first.inputs}
    attributes = {"units": first.output(measure).unit}
    name = measure if isinstance(measure, str) else measure.name
    data = xr.DataArray(table, coords, ["design", "frequency", "input"], name, attributes)
    return data.isel(input=0, drop=True) if len(first.inputs) == 1 else data


class BatchData(Protocol):
    """Interface of a batch that ``batch_dataset`` reads."""

    model: ParametricModel
    samples: Samples
    results: Mapping[int, Result]

    def __len__(self) -> int: ...
    @property
    def coords(self) -> dict[str, Any]: ...
    @property
    def status(self) -> xr.DataArray: ...
    @property
    def attributes(self) -> dict[str, Any]: ...


def batch_dataset(batch: BatchData) -> xr.Dataset:
    """Dataset of all variables of all designs.

    Raises
    ------
    BudgetError
        The dataset exceeds the memory budget.
    """
    import xarray as xr

    if "frequency" in batch.coords or not isinstance(batch.model, Model):
        return _stacked(batch)
    layout = variables(batch.model)
    columns = [column for variable in layout for column in variable.columns]
    rows = sum(len(column) for column in columns)
    size = len(batch) * batch.samples.time.size
    check_budget(
        f"{rows} variables of {len(batch)} designs at {batch.samples.time.size} times",
        memory=16.0 * rows * size,
        cure="take batch['measure'], or request fewer outputs",
    )
    table, row = batch.samples.table(columns), 0
    data: dict[str, Any] = {"status": batch.status}
    coords: dict[str, Any] = batch.coords
    for variable in layout:
        width = max(len(c) for c in variable.columns)
        block = table[:, row : row + width * len(variable.columns)]
        row += block.shape[1]
        attributes = {"units": variable.unit, "long_name": variable.long_name}
        if variable.dimension is None:
            data[variable.name] = (("design", "time"), block[:, 0], attributes)
            continue
        shaped = block.reshape(len(batch), len(variable.columns), width, -1)
        shaped = shaped.transpose(0, 3, 1, 2)
        coords[variable.dimension] = list(variable.entities)
        dims: tuple[str, ...] = ("design", "time", variable.dimension)
        if width > 1:
            dimension, names = COMPONENTS[width]
            coords[dimension] = list(names)
            data[variable.name] = ((*dims, dimension), shaped, attributes)
        else:
            data[variable.name] = (dims, shaped[..., 0], attributes)
    return xr.Dataset(data, coords, attrs=batch.attributes)


def _stacked(batch: BatchData) -> xr.Dataset:
    """Stacked datasets of stored results, with NaN for designs without one."""
    import xarray as xr

    datasets = {k: result.data for k, result in batch.results.items()}
    data: dict[str, Any] = {"status": batch.status}
    first = next(iter(datasets.values()), xr.Dataset())
    for name, variable in first.data_vars.items():
        if not np.issubdtype(variable.dtype, np.number):
            continue
        values = np.full((len(batch), *variable.shape), np.nan)
        for k, dataset in datasets.items():
            if dataset[name].shape == variable.shape:
                values[k] = dataset[name].values
        data[str(name)] = (("design", *variable.dims), values, variable.attrs)
    coords = {str(n): c for n, c in first.coords.items()} | batch.coords
    return xr.Dataset(data, coords, attrs=batch.attributes)
