"""Responses of all designs of a batch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.analysis.batch.solve import solve_batch
from dalembert.errors import AnalysisError
from dalembert.responses.base import Response, evaluate, scalar_measure
from dalembert.results.batch.batch import Batch
from dalembert.results.batch.samples import match_instants
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression

if TYPE_CHECKING:
    import xarray as xr

MEMORY = 2.0**28
"""Bytes of states at once where designs run again."""


def representative(batch: Batch) -> Any:
    """A run of a design that has all the outputs, where one has; None where none succeeded."""
    good = np.flatnonzero(batch.succeeded)
    if not good.size:
        return None
    return batch.design(int(good[np.argmax([_whole(batch, int(k)) for k in good])]))


def batch_response(batch: Batch, response: Response, like: Any = None) -> xr.DataArray:
    """The response of every design; NaN for those that failed.

    Measures are evaluated for all designs at once where the response looks at their outputs;
    elsewhere (integrals of runs of which only some outputs are kept) the designs run again.
    ``like`` is what ``representative`` gives.
    """
    import xarray as xr

    if response.terms != ((1.0, response),):
        return _combined(batch, response, like)
    good = np.flatnonzero(batch.succeeded)
    values, unit = np.full(len(batch), np.nan), ""
    like = representative(batch) if like is None else like
    if like is not None:
        measure = scalar_measure(like, response)
        unit = response.over(like).unit_of(like)
        values[good] = _of_designs(batch, response, like, measure, good)
    about = {"units": unit, "long_name": response.label}
    return xr.DataArray(values, batch.designs.coords, ("design",), response.label, about)


def _combined(batch: Batch, response: Response, like: Any) -> xr.DataArray:
    """The sum of its terms."""
    like = representative(batch) if like is None else like
    parts = [weight * batch_response(batch, term, like) for weight, term in response.terms]
    found = sum(parts[1:], parts[0]) + response.constant
    unit = response.unit_of(like) if like is not None else ""
    return found.rename(response.label).assign_attrs(units=unit, long_name=response.label)


def batch_responses(batch: Batch, responses: Sequence[Response]) -> xr.Dataset:
    """Several responses by their labels, and how each design ended."""
    import xarray as xr

    like = representative(batch)
    found = {r.label: batch_response(batch, r, like) for r in responses}
    return xr.Dataset({"status": batch.status, **found}, attrs=batch.about)


def _whole(batch: Batch, k: int) -> bool:
    """Whether a design has all the outputs and no other."""
    own = batch.results.get(k)
    return own is None or np.array_equal(own.time, batch.time)


def _of_one(batch: Batch, k: int, response: Response) -> float:
    """The value of a run of its own; NaN where the run ends before the response looks at it."""
    try:
        return evaluate(batch.design(int(k)), response)
    except AnalysisError:
        return float("nan")


def _elsewhere(
    batch: Batch,
    response: Response,
    times: np.ndarray,
    measure: Expression,
    reducer: Response,
    good: np.ndarray,
) -> np.ndarray:
    """Values where the response looks at other instants than the outputs: the designs run again."""
    analysis: Any = batch.analysis
    engine = analysis.batched
    together = engine is not None and getattr(engine, "same_instants", True)
    together = together and engine.serves(analysis, batch.model)
    if not together or np.any(np.diff(times) <= 0):
        return np.array([_of_one(batch, k, response) for k in good])
    again, values = replace(analysis, outputs=times), np.full(len(batch), np.nan)
    alone = [int(k) for k in good if int(k) in batch.results]
    several = np.setdiff1d(good, alone)
    states: Any = batch.samples
    width = max(1, int(MEMORY / (24.0 * times.size * states.x.shape[-1])))
    for begin in range(0, several.size, width):
        part = several[begin : begin + width]
        found = solve_batch(again, batch.model, batch.designs.some(part), False, states.workers)
        table = found.samples.table([measure])[:, 0]
        values[part] = [reducer.reduce(times, row) for row in table]
    for k in alone:
        values[k] = _of_one(batch, k, response)
    return values[good]


def _of_designs(
    batch: Batch, response: Response, like: Result, measure: Expression, good: np.ndarray
) -> np.ndarray:
    """Values of the designs that succeeded; ``like`` is the run of one of them."""
    if response.searches(like):
        return np.array([_of_one(batch, int(k), response) for k in good])
    sampled = response.sampled(like)
    reducer, columns = response.over(like), match_instants(batch.time, sampled.time)
    if np.any(columns < 0):
        return _elsewhere(batch, response, sampled.time, measure, reducer, good)
    table = batch.samples.table([measure])[:, 0]
    values = []
    for k in good:
        own: Any = batch.results.get(int(k))
        if _whole(batch, int(k)):
            values.append(reducer.reduce(sampled.time, table[k, columns]))
        elif sampled is like:  # it has ended on its own, and looks at all its outputs
            values.append(reducer.reduce(own.time, own.values(measure)))
        else:
            values.append(_of_one(batch, k, response))
    return np.array(values)
