"""Gradients of all designs of a batch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dalembert.analysis.batch.states import MarchedStates
from dalembert.errors import AnalysisError
from dalembert.processes import can_copy, checked_workers, in_copies
from dalembert.responses.base import Response
from dalembert.results.batch.batch import Batch
from dalembert.sensitivity.marching.batch_gradients import BatchAdjoint, BatchDirect, BatchGradients
from dalembert.sensitivity.methods import Adjoint, Direct

SIDE_BY_SIDE: dict[type, type[BatchGradients]] = {Adjoint: BatchAdjoint, Direct: BatchDirect}
"""Strategy → class that computes the gradients of all designs of a march together."""


def batch_gradients(
    batch: Batch, responses: Sequence[Response], columns: list[int], strategy: Any
) -> np.ndarray:
    """(designs, responses, parameters) derivatives; NaN for failed or singular designs."""
    gradients = np.full((len(batch), len(responses), len(columns)), np.nan)
    succeeded = np.flatnonzero(batch.succeeded)
    if not succeeded.size or not columns:
        return gradients
    together = np.setdiff1d(succeeded, list(batch.results))
    if isinstance(batch.samples, MarchedStates) and together.size:
        kind = SIDE_BY_SIDE.get(type(strategy))
        example = batch.design(int(together[0]))
        if kind is not None and (engine := kind(batch, responses, example, columns)).serves:
            gradients[together] = engine.gradients(together)
            succeeded = np.setdiff1d(succeeded, together)
    for k, rows in _separately(batch, responses, columns, strategy, succeeded):
        gradients[k] = rows
    return np.where(np.isfinite(gradients), gradients, np.nan)


def _separately(batch: Batch, responses, columns: list[int], strategy, designs: np.ndarray):
    """Design numbers and their gradients, each computed from its own run."""

    def gradient(k: int) -> np.ndarray:
        shape = len(responses), len(columns)
        try:
            rows = strategy.gradient(batch.design(k), responses, columns)
        except AnalysisError:  # no derivative, as at a singular position
            return np.full(shape, np.nan)
        return np.asarray(rows).reshape(shape)

    workers, waiting = checked_workers(batch.statistics.get("workers")), designs.tolist()
    for k in waiting[:1]:
        yield k, gradient(k)
    remaining = set(waiting[1:])
    if workers > 1 and len(remaining) > 1 and can_copy():
        for k, rows in in_copies(gradient, waiting[1:], workers):
            remaining.discard(k)
            yield k, rows
    for k in sorted(remaining):
        yield k, gradient(k)
