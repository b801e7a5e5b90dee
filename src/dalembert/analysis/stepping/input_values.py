"""Checks of the values of inputs, of the lanes they belong to, and of counts."""

from __future__ import annotations

from collections.abc import Sequence
from operator import index
from typing import Any

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.text.wording import listed


def wrong_inputs(names: Sequence[str], values: Any) -> AnalysisError:
    """Error for values that are no numbers, or of another number."""
    count = f"one number, of {names[0]}" if len(names) == 1 else f"{len(names)} numbers, in the "
    order = "" if len(names) == 1 else f"order {listed(names)}"
    wanted = f"{count}{order}" if names else "none, as the stepper has no inputs"
    return AnalysisError(f"inputs are {values!r:.60}; give {wanted}")


def refuse_infinite(names: Sequence[str], values: np.ndarray) -> None:
    """Raise if an input is not finite.

    Raises
    ------
    AnalysisError
        Names the first one.
    """
    for name, value in zip(names, values, strict=True):
        if not np.isfinite(value):
            raise AnalysisError(f"input {name} is {value}; give a finite number")


def input_values(names: Sequence[str], values: Any) -> np.ndarray:
    """Inputs (nu,) of one step, finite.

    Raises
    ------
    AnalysisError
        No numbers, another number of them, or not finite.
    """
    try:
        array = np.atleast_1d(np.asarray(values, dtype=float))
    except (TypeError, ValueError):
        raise wrong_inputs(names, values) from None
    if array.shape != (len(names),):
        raise wrong_inputs(names, values)
    refuse_infinite(names, array)
    return array


def input_array(names: Sequence[str], lanes: int, values: Any, steps: bool) -> np.ndarray:
    """Inputs (lanes, nu) of all lanes, or (K, lanes, nu) of several steps.

    Parameters
    ----------
    names : of the inputs
    lanes : number of lanes
    values : an array of this shape, or without the axis of the lanes for equal values
    steps : whether there is an axis of steps

    Raises
    ------
    AnalysisError
        No numbers, or another shape.
    """
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        array = None
    leading, count = int(steps), len(names)
    if array is not None and array.ndim == leading + 1 and array.shape[-1] == count:
        array = np.broadcast_to(array[..., None, :], (*array.shape[:leading], lanes, count))
    if array is None or array.ndim != leading + 2 or array.shape[leading:] != (lanes, count):
        got = f"{values!r:.60}" if array is None else f"an array of shape {array.shape}"
        first = "steps, " if steps else ""
        raise AnalysisError(
            f"inputs are {got}; give an array of shape ({first}{lanes}, {count}), or "
            f"({first}{count},) for equal inputs of all lanes"
        )
    return array


def lane_numbers(count: int, lanes: Any) -> np.ndarray:
    """Numbers of lanes, from numbers or a mask; None for all.

    Raises
    ------
    AnalysisError
        A number that no lane has, or a mask of another length.
    """
    if lanes is None:
        return np.arange(count)
    chosen = np.atleast_1d(np.asarray(lanes))
    if chosen.dtype == bool:
        if chosen.shape != (count,):
            raise AnalysisError(
                f"lanes is a mask of shape {chosen.shape}; give one of shape ({count},)"
            )
        return np.flatnonzero(chosen)
    if chosen.size == 0:
        return np.zeros(0, dtype=int)
    whole = np.issubdtype(chosen.dtype, np.integer) and chosen.ndim == 1
    if not whole or chosen.min() < 0 or chosen.max() >= count:
        raise AnalysisError(
            f"lanes is {lanes!r:.60}; give numbers from 0 to {count - 1}, or a mask"
        )
    return chosen


def positive_count(name: str, value: Any) -> int:
    """A whole number of at least one.

    Raises
    ------
    AnalysisError
        Another value.
    """
    try:
        number = index(value)
    except TypeError:
        number = 0
    if number < 1:
        raise AnalysisError(f"{name} is {value!r:.60}; give a whole number of at least 1")
    return number
