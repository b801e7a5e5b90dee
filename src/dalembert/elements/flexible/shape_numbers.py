"""Shapes of a structure in the expression graph of a mechanism.

Their entries are constants, or symbols if the structure depends on parameters of the mechanism; a
run supplies the values of the symbols at its parameters.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from dalembert.elements.computed import ComputedNumbers
from dalembert.elements.flexible.shapes import FloatingShapes, FollowingStructure, SectionShapes
from dalembert.errors import AnalysisError, ModelError
from dalembert.symbolic.once import CacheOwner, once

SYMMETRIC = 4
"""Number of symmetric tables of shapes, which precede those of sections."""


@dataclass(frozen=True, eq=False)
class SectionSymbols:
    """``SectionShapes`` as expressions."""

    place: ca.SX
    shift: ca.SX
    turn: ca.SX


@dataclass(frozen=True, eq=False)
class ShapeSymbols:
    """``FloatingShapes`` as expressions."""

    inertia: ca.SX
    stiffness: ca.SX
    mass: ca.SX
    critical: ca.SX
    sections: Mapping[str, SectionSymbols]


def constant_shapes(shapes: FloatingShapes) -> ShapeSymbols:
    """Shapes as constants."""
    return _filled(shapes, [ca.sparsify(ca.SX(ca.DM(table))) for table in _tables(shapes)])


class ShapeNumbers(CacheOwner, ComputedNumbers):
    """Shapes as symbols, and their values at parameters.

    Parameters
    ----------
    name : name of the body
    following : shapes as functions of parameters of their structure
    values : parameter of the structure → number
    formulas : parameter of the structure → formula of parameters of the mechanism
    """

    def __init__(
        self,
        name: str,
        following: FollowingStructure,
        values: Mapping[str, float],
        formulas: Mapping[str, ca.SX],
    ):
        self.name, self.following, self.constants = name, following, dict(values)
        self.names = list(formulas)
        self.arguments = ca.vertcat(*formulas.values())
        self._indices = _indices(following.chosen)
        columns = [
            ca.SX.sym(f"{name}.shapes{k}", int(indices.max(initial=-1)) + 1)
            for k, indices in enumerate(self._indices)
        ]
        self.symbols = ca.vertcat(*columns)
        tables = [_table(column, i) for column, i in zip(columns, self._indices, strict=True)]
        self.graph = _filled(following.chosen, tables)

    def shapes(self, arguments: np.ndarray) -> FloatingShapes:
        """The shapes at values of the formulas."""
        return self._at(tuple(map(float, arguments)))

    def values(self, arguments: np.ndarray) -> np.ndarray:
        return self._packed(self.shapes(arguments))

    def push(self, arguments: np.ndarray, directions: np.ndarray) -> np.ndarray:
        values = tuple(map(float, arguments))
        columns = [self._pushed(values, tuple(map(float, d))) for d in directions.T]
        return np.array(columns).T.reshape(self.symbols.numel(), len(columns))

    def pull(self, arguments: np.ndarray, weights: np.ndarray) -> np.ndarray:
        values = self._parameters(tuple(map(float, arguments)))
        pulled = [self.following.pull(values, self._unpacked(w), self.names) for w in weights.T]
        return np.array(pulled).T.reshape(len(self.names), len(pulled))

    @once
    def _at(self, arguments: tuple[float, ...]) -> FloatingShapes:
        try:
            return self.following.at(self._parameters(arguments))
        except ModelError as error:
            raise ModelError(str(error), self.name) from None
        except AnalysisError as error:
            raise AnalysisError(f"{self.name}: {error}") from None

    @once
    def _pushed(self, arguments: tuple[float, ...], direction: tuple[float, ...]) -> np.ndarray:
        if not any(direction):
            return np.zeros(self.symbols.numel())
        changes = dict(zip(self.names, direction, strict=True))
        return self._packed(self.following.push(self._parameters(arguments), changes))

    def _parameters(self, arguments: tuple[float, ...]) -> dict[str, float]:
        return self.constants | dict(zip(self.names, arguments, strict=True))

    def _packed(self, shapes: FloatingShapes) -> np.ndarray:
        columns = []
        for table, indices in zip(_tables(shapes), self._indices, strict=True):
            column = np.zeros(int(indices.max(initial=-1)) + 1)
            column[indices[indices >= 0]] = table[indices >= 0]
            columns.append(column)
        return np.concatenate(columns)

    def _unpacked(self, weights: np.ndarray) -> FloatingShapes:
        """Weights as tables; equal entries of symmetric tables have one weight."""
        tables, begin = [], 0
        for k, indices in enumerate(self._indices):
            size = int(indices.max(initial=-1)) + 1
            filled = (np.tril(indices + 1) if k < SYMMETRIC else indices + 1) > 0
            table = np.zeros(indices.shape)
            table[filled] = weights[begin : begin + size][indices[filled]]
            tables.append(table)
            begin += size
        inertia, stiffness, mass, critical = tables[:SYMMETRIC]
        sections = {
            name: SectionShapes(place.ravel(), shift, turn)
            for name, place, shift, turn in zip(
                self.following.chosen.sections,
                *(tables[SYMMETRIC + k :: 3] for k in range(3)),
                strict=True,
            )
        }
        return replace(
            self.following.chosen,
            inertia=inertia,
            stiffness=stiffness,
            mass=mass,
            critical=critical,
            sections=sections,
        )


def _tables(shapes: FloatingShapes) -> list[np.ndarray]:
    tables = [shapes.inertia, shapes.stiffness, shapes.mass, shapes.critical]
    for section in shapes.sections.values():
        tables += [section.place[:, None], section.shift, section.turn]
    return tables


def _indices(shapes: FloatingShapes) -> list[np.ndarray]:
    """Index of each entry of each table in its column of symbols; −1 for structural zeros."""
    result = []
    for k, table in enumerate(_tables(shapes)):
        if k >= SYMMETRIC:
            result.append(np.arange(table.size).reshape(table.shape))
            continue
        i, j = np.indices(table.shape)
        nonzero = shapes.counted > 0 if k == 0 else np.ones_like(i, dtype=bool)
        indices = np.full(table.shape, -1)
        lower = nonzero & (i >= j)
        indices[lower] = np.arange(lower.sum())
        result.append(np.maximum(indices, indices.T))
    return result


def _table(column: ca.SX, indices: np.ndarray) -> ca.SX:
    """Table of the entries of a column at their indices."""
    if not indices.size:
        return ca.SX(*indices.shape)
    flat = ca.vertcat(column, 0)[np.where(indices < 0, column.numel(), indices).ravel("F").tolist()]
    return ca.sparsify(ca.reshape(flat, *indices.shape))


def _filled(shapes: FloatingShapes, tables: list[ca.SX]) -> ShapeSymbols:
    sections = {
        name: SectionSymbols(*tables[SYMMETRIC + 3 * k :][:3])
        for k, name in enumerate(shapes.sections)
    }
    inertia, stiffness, mass, critical = tables[:SYMMETRIC]
    return ShapeSymbols(inertia, stiffness, mass, critical, sections)
