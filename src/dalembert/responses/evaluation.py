"""Values of responses for a result or a batch, and lists of responses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, overload

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.responses import base
from dalembert.responses.base import Response
from dalembert.results.batch.batch import Batch
from dalembert.results.result import Result
from dalembert.text.spelling import spelled

if TYPE_CHECKING:
    import xarray as xr


@overload
def evaluate(result: Result, response: Response) -> float: ...
@overload
def evaluate(result: Batch, response: Response) -> xr.DataArray: ...
@overload
def evaluate(result: Batch, response: Sequence[Response]) -> xr.Dataset: ...


@spelled
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
        from dalembert.responses.batch import batch_response, batch_responses

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
    terms = list(dict.fromkeys(term for response in responses for _, term in response.terms))
    weights = np.zeros((len(responses), len(terms)))
    for row, response in zip(weights, responses, strict=True):
        for weight, term in response.terms:
            row[terms.index(term)] += weight
    return terms, weights
