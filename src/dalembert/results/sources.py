"""Formulas behind the numbers and columns of a payload.

A payload is plain data. Numbers that follow from parameters and columns that follow from the
motion carry their formulas, with which a page evaluates them for other parameters.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

Place = tuple[str | int, ...]
"""Keys and indices that lead to a value of a payload."""


class Number(float):
    """Number with its formula of parameters, a scalar SX; copies of it are plain."""

    __slots__ = ("sx",)
    sx: ca.SX

    def __new__(cls, value: float, sx: ca.SX) -> Number:
        number = super().__new__(cls, value)
        number.sx = sx
        return number

    def __reduce__(self) -> tuple[type, tuple[float]]:
        return float, (float(self),)


class Formulated(list[Any]):
    """Numbers with their formulas; copies of it are plain."""

    __slots__ = ("sx",)

    def __init__(self, values: Iterable[Any], sx: ca.SX):
        super().__init__(values)
        self.sx = sx

    def __reduce__(self) -> tuple[type, tuple[list[Any]]]:
        return list, (list(self),)


class Column(Formulated):
    """Values over time with their formula, a scalar SX."""


class States(Formulated):
    """Columns of several states with the formulas of their entries.

    Parameters
    ----------
    values : a column of n numbers for each state
    sx : (n,) formulas; entries with a constant one keep their values
    """


class Blocks(Formulated):
    """Values of several formulas over the states, one after the other.

    Parameters
    ----------
    values : (K m,)
    sx : (m,) formulas; values of a constant one remain
    """


@dataclass(frozen=True, eq=False)
class Row:
    """Scalar over time.

    Attributes
    ----------
    sx : SX of coordinates, speeds, accelerations, multipliers, time and parameters
    work : factors of the dissipated energy and of the energy input, which are added
    relative : whether the value at the first output is subtracted
    drawn : whether only pictures use it, so that no derivatives are required
    """

    sx: ca.SX
    work: tuple[float, float] = (0.0, 0.0)
    relative: bool = False
    drawn: bool = False

    def __truediv__(self, factor: float) -> Row:
        """The row in another unit."""
        dissipated, supplied = self.work
        return Row(self.sx / factor, (dissipated / factor, supplied / factor), self.relative)


Source = ca.SX | Row
"""Formula of a column."""


def as_row(source: Source) -> Row:
    """The row of a formula."""
    return Row(source) if isinstance(source, ca.SX) else source


class Series(dict[str, Any]):
    """Series of a payload with the formula of its ``values``; None if it has none."""

    def __init__(self, source: Source | None, **entries: Any):
        super().__init__(entries)
        self.source = source


class InitialPicture(dict[str, Any]):
    """Primitive of a scene that has no formulas: it remains that of the initial parameters.

    Parameters
    ----------
    owner : name of the body or element
    """

    def __init__(self, owner: str, entries: dict[str, Any]):
        super().__init__(entries)
        self.owner = owner


@dataclass(frozen=True, eq=False)
class Track:
    """Components over time and their formulas.

    Attributes
    ----------
    values : (K, n) ; sx : (n,) formulas, None if there are none
    """

    values: np.ndarray
    sx: ca.SX | None

    def named(self, names: Sequence[str]) -> dict[str, list[float]]:
        """Name of a component → its column."""
        formulas = [None] * len(names) if self.sx is None else ca.vertsplit(ca.densify(self.sx))
        columns = zip(names, self.values.T.tolist(), formulas, strict=True)
        return {name: _column(values, sx) for name, values, sx in columns}


def _column(values: list[float], sx: ca.SX | None) -> list[float]:
    return values if sx is None or sx.is_constant() else Column(values, sx)


def numbers(values: Iterable[float], sx: ca.SX) -> list[float]:
    """Components of a vector; those that depend on parameters carry their formula."""
    formulas = ca.vertsplit(ca.densify(sx))
    return [
        float(value) if formula.is_constant() else Number(value, formula)
        for value, formula in zip(values, formulas, strict=True)
    ]


@dataclass(frozen=True, eq=False)
class Sources:
    """Formulas of a payload.

    Attributes
    ----------
    numbers : places and formulas of parameters
    columns : places and formulas of time, coordinates, speeds, accelerations, multipliers and
        parameters, or rows with work since the start
    states : places and (n,) formulas of columns of states
    blocks : places and (m,) formulas of values one after the other
    initial : names of bodies and elements whose picture remains that of the initial parameters
    """

    numbers: list[tuple[Place, ca.SX]]
    columns: list[tuple[Place, Source]]
    states: list[tuple[Place, ca.SX]]
    blocks: list[tuple[Place, ca.SX]]
    initial: list[str]


def payload_sources(payload: dict[str, Any]) -> Sources:
    """Formulas of all numbers and columns of a payload that have one."""
    sources = Sources([], [], [], [], [])
    for place, value in _tagged(payload, ()):
        if isinstance(value, Number):
            sources.numbers.append((place, value.sx))
        elif isinstance(value, Column):
            sources.columns.append((place, value.sx))
        elif isinstance(value, States):
            sources.states.append((place, value.sx))
        elif isinstance(value, Blocks):
            sources.blocks.append((place, value.sx))
        elif isinstance(value, Series) and value.source is not None:
            sources.columns.append(((*place, "values"), value.source))
        elif isinstance(value, InitialPicture) and value.owner not in sources.initial:
            sources.initial.append(value.owner)
    return sources


def _tagged(value: Any, place: Place) -> Iterator[tuple[Place, Any]]:
    """Tagged values with their places, in the order of the payload."""
    if isinstance(value, Number | Column | States | Blocks | Series | InitialPicture):
        yield place, value
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _tagged(item, (*place, key))
    elif isinstance(value, list) and not isinstance(value, Column | States | Blocks):
        for index, item in enumerate(value):
            if isinstance(item, Number | dict | list):
                yield from _tagged(item, (*place, index))
