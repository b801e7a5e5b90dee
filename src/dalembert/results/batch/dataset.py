"""The labelled dataset of a batch."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from dalembert.budget import check_budget
from dalembert.model.model import Model
from dalembert.results.batch.samples import Samples
from dalembert.results.components import COMPONENTS
from dalembert.results.dataset import variables
from dalembert.results.result import Result
from dalembert.symbolic.parametric_model import ParametricModel

if TYPE_CHECKING:
    import xarray as xr


class Labelled(Protocol):
    """What is needed of a batch."""

    model: ParametricModel
    samples: Samples
    results: Mapping[int, Result]

    def __len__(self) -> int: ...
    @property
    def coords(self) -> dict[str, Any]: ...
    @property
    def status(self) -> xr.DataArray: ...
    @property
    def about(self) -> dict[str, Any]: ...


def batch_dataset(batch: Labelled) -> xr.Dataset:
    """All variables of all designs.

    Raises
    ------
    BudgetError
        They are more than a task may take.
    """
    import xarray as xr

    if not isinstance(batch.model, Model):
        return _side_by_side(batch)
    layout = variables(batch.model)
    columns = [column for variable in layout for column in variable.columns]
    rows = sum(len(column) for column in columns)
    size = len(batch) * batch.samples.time.size
    check_budget(
        f"{rows} variables of {len(batch)} designs at {batch.samples.time.size} times",
        memory=16.0 * rows * size,
        cure="take batch['measure'], or ask for fewer outputs",
    )
    table, row = batch.samples.table(columns), 0
    data: dict[str, Any] = {"status": batch.status}
    coords: dict[str, Any] = batch.coords
    for variable in layout:
        width = max(len(c) for c in variable.columns)
        block = table[:, row : row + width * len(variable.columns)]
        row += block.shape[1]
        about = {"units": variable.unit, "long_name": variable.long_name}
        if variable.dimension is None:
            data[variable.name] = (("design", "time"), block[:, 0], about)
            continue
        shaped = block.reshape(len(batch), len(variable.columns), width, -1)
        shaped = shaped.transpose(0, 3, 1, 2)
        coords[variable.dimension] = list(variable.entities)
        along: tuple[str, ...] = ("design", "time", variable.dimension)
        if width > 1:
            dimension, names = COMPONENTS[width]
            coords[dimension] = list(names)
            data[variable.name] = ((*along, dimension), shaped, about)
        else:
            data[variable.name] = (along, shaped[..., 0], about)
    return xr.Dataset(data, coords, attrs=batch.about)


def _side_by_side(batch: Labelled) -> xr.Dataset:
    """Datasets of results that are kept whole, with NaN for designs that have none."""
    import xarray as xr

    found = {k: result.data for k, result in batch.results.items()}
    data: dict[str, Any] = {"status": batch.status}
    some = next(iter(found.values()), xr.Dataset())
    for name, variable in some.data_vars.items():
        if not np.issubdtype(variable.dtype, np.number):
            continue
        whole = np.full((len(batch), *variable.shape), np.nan)
        for k, dataset in found.items():
            if dataset[name].shape == variable.shape:
                whole[k] = dataset[name].values
        data[str(name)] = (("design", *variable.dims), whole, variable.attrs)
    coords = {str(n): c for n, c in some.coords.items()} | batch.coords
    return xr.Dataset(data, coords, attrs=batch.about)
