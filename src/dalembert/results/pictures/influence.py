"""Influence of parameters on responses: relative, absolute and over bounds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dalembert.errors import AnalysisError

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

ZERO_SHARE = 1e-12
"""Threshold of a zero response, relative to its largest change."""


def relative_influence(gradient: xr.DataArray) -> xr.DataArray:
    """Logarithmic derivatives ``|p/R| ∂R/∂p``: percent of the response per percent of
    the parameter.

    The sign is that of the derivative, also for negative values. NaN if the response is zero; zero
    if the parameter is zero.

    Parameters
    ----------
    gradient : as returned by ``sensitivity``
    """
    change = absolute_influence(gradient)
    value = _labels(gradient, "response_value")
    is_zero = abs(value) <= ZERO_SHARE * abs(change).max("parameter")
    return (change / abs(value.where(~is_zero & (value != 0.0)))).assign_attrs(units="%/%")


def absolute_influence(gradient: xr.DataArray) -> xr.DataArray:
    """``|p| ∂R/∂p``: change of the response, in its unit, for 100 % more of the parameter."""
    return gradient * abs(_labels(gradient, "parameter_value"))


def range_influence(gradient: xr.DataArray) -> xr.DataArray:
    """Change of the response, to first order, from the middle to the end of a parameter's bounds.

    NaN if a parameter has no bounds on both sides.
    """
    half = (_labels(gradient, "upper") - _labels(gradient, "lower")) / 2
    return gradient * half.where(np.isfinite(half))


def by_influence(gradient: xr.DataArray) -> list[str]:
    """Names of the parameters, the most influential on any response first."""
    change = abs(absolute_influence(gradient))
    share = change / change.max("parameter").where(change.max("parameter") > 0, 1.0)
    order = np.argsort(-share.max("response").values, kind="stable")
    return [str(gradient["parameter"].values[k]) for k in order]


def gradient_table(gradient: xr.DataArray) -> pd.DataFrame:
    """One row per response and parameter, with values, units and relative influence."""
    table = gradient.to_dataset(name="derivative").assign(relative=relative_influence(gradient))
    columns = ("response", "response_value", "response_unit", "parameter", "parameter_value")
    rest = ("parameter_unit", "derivative", "relative")
    return table.to_dataframe().reset_index()[[*columns, *rest]]


def _labels(gradient: xr.DataArray, name: str) -> xr.DataArray:
    if name not in gradient.coords:
        raise AnalysisError(
            f"this array has no coordinate {name!r}; give the gradient as sensitivity returns it"
        )
    return gradient[name].reset_coords(drop=True)
