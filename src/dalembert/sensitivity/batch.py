"""Gradients of all designs of a batch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.analysis.batch.states import MarchedStates
from dalembert.analysis.batch.workers import can_copy, checked_workers, in_copies
from dalembert.errors import AnalysisError
from dalembert.responses.base import Response
from dalembert.responses.evaluation import batch_response, representative
from dalembert.results.batch.batch import Batch
from dalembert.sensitivity.marching.batch_adjoint import BatchAdjoint
from dalembert.sensitivity.marching.batch_direct import BatchDirect
from dalembert.sensitivity.marching.batch_gradients import BatchGradients
from dalembert.sensitivity.methods import Adjoint, Direct

if TYPE_CHECKING:
    import xarray as xr

SIDE_BY_SIDE: dict[type, type[BatchGradients]] = {Adjoint: BatchAdjoint, Direct: BatchDirect}
"""What takes the gradients of all designs of a march at once."""


def labelled_gradients(
    batch: Batch, responses: Sequence[Response], columns: list[int], values: np.ndarray, method: str
) -> xr.DataArray:
    """(designs, responses, parameters) numbers with their names, units and values."""
    import xarray as xr

    listed = list(batch.model.parameters.values())
    parameters = [listed[i] for i in columns]
    like = representative(batch)
    found = [batch_response(batch, response, like) for response in responses]
    along: dict[str, Any] = batch.designs.coords | {
        "response": [r.label for r in responses],
        "parameter": [p.name for p in parameters],
        "response_unit": ("response", [f.attrs["units"] for f in found]),
        "response_value": (("design", "response"), np.column_stack([f.values for f in found])),
        "parameter_unit": ("parameter", [p.unit for p in parameters]),
        "parameter_value": (("design", "parameter"), batch.designs.values[:, columns]),
        "lower": ("parameter", [p.bounds[0] for p in parameters]),
        "upper": ("parameter", [p.bounds[1] for p in parameters]),
    }
    for name in [n for n in batch.designs.varied if n in ("response", "parameter")]:
        del along[name]
    about = {"method": method, "model": batch.model.name}
    return xr.DataArray(values, along, ("design", "response", "parameter"), "gradient", about)


def batch_gradients(
    batch: Batch, responses: Sequence[Response], columns: list[int], strategy: Any
) -> np.ndarray:
    """(designs, responses, parameters) derivatives; NaN where a design failed or has none."""
    found = np.full((len(batch), len(responses), len(columns)), np.nan)
    good = np.flatnonzero(batch.succeeded)
    if not good.size or not columns:
        return found
    together = np.setdiff1d(good, list(batch.results))
    if isinstance(batch.samples, MarchedStates) and together.size:
        kind = SIDE_BY_SIDE.get(type(strategy))
        like = batch.design(int(together[0]))
        if kind is not None and (many := kind(batch, responses, like, columns)).serves:
            found[together] = many.gradients(together)
            good = np.setdiff1d(good, together)
    for k, rows in _one_by_one(batch, responses, columns, strategy, good):
        found[k] = rows
    return np.where(np.isfinite(found), found, np.nan)


def _one_by_one(batch: Batch, responses, columns: list[int], strategy, good: np.ndarray):
    """Gradients of runs of their own."""

    def gradient(k: int) -> np.ndarray:
        shape = len(responses), len(columns)
        try:
            found = strategy.gradient(batch.design(k), responses, columns)
        except AnalysisError:  # it has none there, as at a singular position
            return np.full(shape, np.nan)
        return np.asarray(found).reshape(shape)

    workers, waiting = checked_workers(batch.statistics.get("workers")), good.tolist()
    for k in waiting[:1]:
        yield k, gradient(k)
    left = set(waiting[1:])
    if workers > 1 and len(left) > 1 and can_copy():
        for k, rows in in_copies(gradient, waiting[1:], workers):
            left.discard(k)
            yield k, rows
    for k in sorted(left):
        yield k, gradient(k)
