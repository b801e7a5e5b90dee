"""Designs: sets of parameter values of a model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.wording import unknown

if TYPE_CHECKING:
    import pandas as pd

    Column = float | np.ndarray | Sequence[float]
    ManyDesigns = Mapping[str, Column] | np.ndarray | Sequence[Mapping[str, float]] | pd.DataFrame
    """Values of parameters of many designs."""

FORMS = (
    "give name → numbers or arrays of one length, a table (designs, parameters), a DataFrame or a "
    "list of dicts"
)


def are_designs(parameters: Any) -> bool:
    """Whether parameter values describe a batch: arrays, a table, or a list of dicts."""
    if parameters is None:
        return False
    if isinstance(parameters, Mapping):
        return any(np.ndim(value) for value in parameters.values())
    if isinstance(parameters, np.ndarray):
        return parameters.ndim != 1
    return _is_frame(parameters) or isinstance(parameters, Sequence)


@dataclass(frozen=True, eq=False)
class Designs:
    """Values of the parameters of a model, a row for each design.

    Attributes
    ----------
    names : of all parameters
    values : (designs, parameters); NaN for designs that are refused
    varied : names of the parameters given per design
    units : of all parameters
    """

    names: tuple[str, ...]
    values: np.ndarray
    varied: tuple[str, ...]
    units: tuple[str, ...]

    @classmethod
    def of(cls, model: ParametricModel, parameters: Any) -> Designs:
        """Designs from any of their forms; other parameters keep the values of the model.

        Raises
        ------
        AnalysisError
            Unknown names, different lengths, wrong shapes, no designs, or not numeric.
        """
        names = tuple(model.parameters)
        columns = _columns(parameters, names)
        for name in columns:
            _refuse_unknown(name, names)
        numbers = {name: _numbers(name, value) for name, value in columns.items()}
        lengths = {name: value.size for name, value in numbers.items() if value.ndim}
        if len(set(lengths.values())) > 1:
            listed = ", ".join(f"{name} has {size}" for name, size in lengths.items())
            raise AnalysisError(f"designs of one batch need arrays of one length: {listed}")
        count = next(iter(lengths.values()), 1)
        if not count:
            raise AnalysisError("the batch has no design; give at least one")
        values = np.tile([float(p.value) for p in model.parameters.values()], (count, 1))
        for name, value in numbers.items():
            values[:, names.index(name)] = value
        units = tuple(p.unit for p in model.parameters.values())
        return cls(names, values.reshape(count, len(names)), tuple(lengths), units)

    @property
    def count(self) -> int:
        return self.values.shape[0]

    def __len__(self) -> int:
        return self.count

    def some(self, index: np.ndarray) -> Designs:
        """A subset of the designs."""
        return Designs(self.names, self.values[index], self.varied, self.units)

    def named(self, k: int) -> dict[str, float]:
        """Name → value of one design."""
        return dict(zip(self.names, self.values[k].tolist(), strict=True))

    @property
    def coords(self) -> dict[str, Any]:
        """Coordinates along ``design``: its number, and the parameters that vary."""
        units = dict(zip(self.names, self.units, strict=True))
        coords: dict[str, Any] = {"design": np.arange(self.count)}
        for name in self.varied:
            column = self.values[:, self.names.index(name)]
            coords[name] = ("design", column, {"units": units[name], "long_name": name})
        return coords


def _columns(parameters: Any, names: tuple[str, ...]) -> dict[str, Any]:
    """Name → value or values, from any form of designs."""
    if isinstance(parameters, Mapping):
        return dict(parameters)
    if isinstance(parameters, np.ndarray):
        if parameters.ndim != 2 or parameters.shape[1] != len(names):
            raise AnalysisError(
                f"a table of designs has a column for each of the {len(names)} parameters "
                f"({', '.join(names) or 'none'}); its shape is {parameters.shape}"
            )
        return dict(zip(names, parameters.T, strict=True))
    if _is_frame(parameters):
        return {str(name): parameters[name].to_numpy() for name in parameters.columns}
    rows: list[Any] = list(parameters) if isinstance(parameters, Sequence) else [None]
    if isinstance(parameters, str) or not all(isinstance(row, Mapping) for row in rows):
        raise AnalysisError(f"parameters of a batch are {parameters!r:.60}; {FORMS}")
    if not rows:
        raise AnalysisError("the batch has no design; give at least one")
    row_names = list(dict.fromkeys(name for row in rows for name in row))
    for k, row in enumerate(rows):
        if missing := [name for name in row_names if name not in row]:
            raise AnalysisError(f"design {k} gives no {', '.join(missing)}, others do; give all")
    return {name: [row[name] for row in rows] for name in row_names}


def _numbers(name: str, value: Any) -> np.ndarray:
    """A number or a column of numbers."""
    try:
        numbers = np.asarray(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise AnalysisError(f"{name} is {value!r:.60}; {FORMS}") from None
    if numbers.ndim > 1:
        raise AnalysisError(
            f"{name} has the shape {numbers.shape}; give a number, or one for each design in one "
            "dimension (ravel() a grid)"
        )
    return numbers


def _refuse_unknown(name: Any, names: tuple[str, ...]) -> None:
    if name not in names:
        raise AnalysisError(unknown("parameter", name, names))


def _is_frame(value: Any) -> bool:
    return hasattr(value, "columns") and hasattr(value, "to_numpy")
