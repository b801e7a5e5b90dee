"""Responses of all designs of a batch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.responses.base import Response, evaluate, scalar_measure
from dalembert.results.batch import Batch
from dalembert.results.batch_samples import places
from dalembert.results.result import Result
from dalembert.symbolic.expression import Expression

if TYPE_CHECKING:
    import xarray as xr


def batch_response(batch: Batch, response: Response) -> xr.DataArray:
    """The response of every design; NaN for those that failed.

    Measures are evaluated for all designs at once where the response looks at their outputs;
    elsewhere (integrals of runs of which only some outputs are kept) design by design.
    """
    import xarray as xr

    good = np.flatnonzero(batch.succeeded)
    values, unit = np.full(len(batch), np.nan), ""
    if good.size:
        like: Result = batch.design(int(good[0]))
        measure = scalar_measure(like, response)
        unit = response.over(like).unit(measure.unit)
        values[good] = _of_designs(batch, response, like, measure, good)
    about = {"units": unit, "long_name": response.label}
    return xr.DataArray(values, batch.designs.coords, ("design",), response.label, about)


def batch_responses(batch: Batch, responses: Sequence[Response]) -> xr.Dataset:
    """Several responses by their labels, and how each design ended."""
    import xarray as xr

    found = {r.label: batch_response(batch, r) for r in responses}
    return xr.Dataset({"status": batch.status, **found}, attrs=batch.about)


def _of_designs(
    batch: Batch, response: Response, like: Result, measure: Expression, good: np.ndarray
) -> np.ndarray:
    """Values of the designs that succeeded; ``like`` is the run of one of them."""
    sampled = response.sampled(like)
    reducer, columns = response.over(like), places(batch.time, sampled.time)
    if np.any(columns < 0):
        return np.array([evaluate(batch.design(int(k)), response) for k in good])
    table = batch.samples.table([measure])[:, 0]
    values = []
    for k in good:
        own: Any = batch.results.get(int(k))
        if own is None or np.array_equal(own.time, batch.time):
            values.append(reducer.reduce(sampled.time, table[k, columns]))
        elif sampled is like:  # it has ended on its own, and looks at all its outputs
            values.append(reducer.reduce(own.time, own.values(measure)))
        else:
            values.append(evaluate(batch.design(int(k)), response))
    return np.array(values)
