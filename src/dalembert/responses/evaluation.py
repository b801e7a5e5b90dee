"""The front door: values of responses, of one result or of a batch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, overload

from dalembert.responses import base
from dalembert.responses.base import Response
from dalembert.responses.several import as_responses
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
    result : what it is taken of
    response : of a batch also several

    Returns
    -------
    float, xarray.DataArray or xarray.Dataset
        Of a batch an array along ``design``, NaN where a design failed; of several responses a
        dataset with their labels.

    Raises
    ------
    AnalysisError
        No such measure, or it is no single number.

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
