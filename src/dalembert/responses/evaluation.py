"""Values of responses for a result or a batch, and lists of responses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from dalembert.analysis.batch.solve import solve_batch
from dalembert.errors import AnalysisError
from dalembert.responses import base
from dalembert.responses.base import Response, scalar_measure
from dalembert.results.batch.batch import Batch
from dalembert.results.batch.samples import match_instants
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.arguments import check_arguments

if TYPE_CHECKING:
    import xarray as xr

MEMORY = 2.0**28
"""Upper limit of the memory for states of designs that are rerun together [bytes]."""


@overload
def evaluate(result: Result, response: Response) -> float: ...
@overload
def evaluate(result: Batch, response: Response) -> xr.DataArray: ...
@overload
def evaluate(result: Batch, response: Sequence[Response]) -> xr.Dataset: ...


@check_arguments
def evaluate(
    result: Result | Batch, response: Response | Sequence[Response]
) -> float | xr.DataArray | xr.Dataset:
    """Value of a response.

    Parameters
    ----------
    result : result or batch on which the response is evaluated
    response : a response; for a batch also a sequence of responses

    Returns
    -------
    float, xarray.DataArray or xarray.Dataset
        For a batch, an array along ``design`` with NaN for failed designs; for several responses, a
        dataset with an array for each label.

    Raises
    ------
    AnalysisError
        The model has no such measure, or the measure is not a scalar.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> speed = system.parameter("speed", 5.0)
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(1, speed)))
    >>> many = da.solve_dynamics(system.build(), 1.0, step=0.01, parameters={"speed": [4.0, 6.0]})
    >>> da.evaluate(many, da.maximum("stone.y")).values.round(4)  # v²/(2 g) of each design
    array([0.8, 1.8])
    """
    if isinstance(result, Batch):
        if isinstance(response, Response):
            return batch_response(result, response)
        return batch_responses(result, as_responses(response))
    assert isinstance(response, Response)
    return base.evaluate(result, response)


def as_responses(responses: Response | Sequence[Response]) -> list[Response]:
    """One response or several as a list with distinct labels.

    Raises
    ------
    AnalysisError
        An entry is not a response, the list is empty, or a label occurs twice.
    """
    is_sequence = isinstance(responses, Sequence) and not isinstance(responses, str)
    as_list: list[Response] = list(responses) if is_sequence else [responses]  # type: ignore
    if not as_list:
        raise AnalysisError("no response is given; give at least one, such as da.final(measure)")
    for response in as_list:
        if not isinstance(response, Response):
            raise AnalysisError(
                f"{response!r} is not a response; give one such as da.final(measure)"
            )
    labels = [r.label for r in as_list]
    duplicate = next((label for label in labels if labels.count(label) > 1), None)
    if duplicate:
        raise AnalysisError(f"two responses are called {duplicate!r}; name them")
    return as_list


def expanded(responses: Sequence[Response]) -> tuple[list[Response], np.ndarray]:
    """Distinct terms of all responses, and their (responses, terms) weights."""
    terms = dict.fromkeys(term for response in responses for _, term in response.terms)
    index = {term: k for k, term in enumerate(terms)}
    weights = np.zeros((len(responses), len(terms)))
    for row, response in zip(weights, responses, strict=True):
        for weight, term in response.terms:
            row[index[term]] += weight
    return list(terms), weights


def representative(batch: Batch) -> Any:
    """Run of a successful design, preferably one with all outputs; None if no design succeeded."""
    good = np.flatnonzero(batch.succeeded)
    if not good.size:
        return None
    return batch.design(int(good[np.argmax([_has_all_outputs(batch, int(k)) for k in good])]))


def batch_response(batch: Batch, response: Response, like: Any = None) -> xr.DataArray:
    """The response of every design; NaN for designs that failed.

    Measures are evaluated for all designs at once if the response samples the outputs of the batch.
    Otherwise, as for integrals of runs that store only some outputs, the designs are rerun.
    ``like`` is the run returned by ``representative``.
    """
    import xarray as xr

    if response.terms != ((1.0, response),):
        return _combined(batch, response, like)
    good = np.flatnonzero(batch.succeeded)
    values, unit = np.full(len(batch), np.nan), ""
    like = representative(batch) if like is None else like
    if like is not None:
        measure = scalar_measure(like, response)
        unit = response.adapted_to(like).unit_of(like)
        values[good] = _design_values(batch, response, like, measure, good)
    attributes = {"units": unit, "long_name": response.label}
    return xr.DataArray(values, batch.designs.coords, ("design",), response.label, attributes)


def _combined(batch: Batch, response: Response, like: Any) -> xr.DataArray:
    """Linear combination of the terms."""
    like = representative(batch) if like is None else like
    parts = [weight * batch_response(batch, term, like) for weight, term in response.terms]
    total = sum(parts[1:], parts[0]) + response.constant
    unit = response.unit_of(like) if like is not None else ""
    return total.rename(response.label).assign_attrs(units=unit, long_name=response.label)


def batch_responses(batch: Batch, responses: Sequence[Response]) -> xr.Dataset:
    """Several responses by label, and the status of each design."""
    import xarray as xr

    like = representative(batch)
    values = {r.label: batch_response(batch, r, like) for r in responses}
    return xr.Dataset({"status": batch.status, **values}, attrs=batch.attributes)


def _has_all_outputs(batch: Batch, k: int) -> bool:
    """Whether the outputs of a design are exactly those of the batch."""
    single = batch.results.get(k)
    return single is None or np.array_equal(single.time, batch.time)


def _single_value(batch: Batch, k: int, response: Response) -> float:
    """Value on the run of a single design; NaN if the run ends before a sampling time."""
    try:
        return base.evaluate(batch.design(int(k)), response)
    except AnalysisError:
        return float("nan")


def _rerun_values(
    batch: Batch,
    response: Response,
    times: np.ndarray,
    measure: Expression,
    reducer: Response,
    good: np.ndarray,
) -> np.ndarray:
    """Values at sampling times that are not outputs of the batch: the designs are rerun."""
    analysis: Any = batch.analysis
    engine = analysis.batched
    batched = engine is not None and getattr(engine, "same_instants", True)
    batched = batched and engine.serves(analysis, batch.model)
    if not batched or np.any(np.diff(times) <= 0):
        return np.array([_single_value(batch, k, response) for k in good])
    rerun, values = replace(analysis, outputs=times), np.full(len(batch), np.nan)
    single = [int(k) for k in good if int(k) in batch.results]
    together = np.setdiff1d(good, single)
    states: Any = batch.samples
    width = max(1, int(MEMORY / (24.0 * times.size * states.x.shape[-1])))
    for begin in range(0, together.size, width):
        part = together[begin : begin + width]
        batch_part = solve_batch(
            rerun, batch.model, batch.designs.some(part), False, states.workers
        )
        table = batch_part.samples.table([measure])[:, 0]
        values[part] = [reducer.reduce(times, row) for row in table]
    for k in single:
        values[k] = _single_value(batch, k, response)
    return values[good]


def _design_values(
    batch: Batch, response: Response, like: Result, measure: Expression, good: np.ndarray
) -> np.ndarray:
    """Values of the successful designs; ``like`` is the run of one of them."""
    if response.has_adaptive_times(like):
        return np.array([_single_value(batch, int(k), response) for k in good])
    sampled = response.sampled(like)
    reducer, columns = response.adapted_to(like), match_instants(batch.time, sampled.time)
    if np.any(columns < 0):
        return _rerun_values(batch, response, sampled.time, measure, reducer, good)
    table = batch.samples.table([measure])[:, 0]
    values = []
    for k in good:
        single: Any = batch.results.get(int(k))
        if _has_all_outputs(batch, int(k)):
            values.append(reducer.reduce(sampled.time, table[k, columns]))
        elif sampled is like:  # ended early; the response samples all its outputs
            values.append(reducer.reduce(single.time, single.values(measure)))
        else:
            values.append(_single_value(batch, k, response))
    return np.array(values)
