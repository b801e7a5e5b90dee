"""The numbers that shapes of a structure put into the graph of a mechanism.

They are constants; where the structure follows parameters of the mechanism they are symbols, which
a run fills with the numbers that belong to its parameter values.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from dalembert.elements.computed import ComputedNumbers
from dalembert.elements.flexible.shapes import FloatingShapes, FollowingStructure, SectionShapes
from dalembert.errors import AnalysisError, ModelError
from dalembert.symbolic.once import once

SYMMETRIC = 4
"""Tables of shapes that are symmetric; those of sections stand behind them."""


@dataclass(frozen=True, eq=False)
class SectionSymbols:
    """How an interface moves, see ``SectionShapes``."""

    place: ca.SX
    shift: ca.SX
    turn: ca.SX


@dataclass(frozen=True, eq=False)
class ShapeSymbols:
    """What the graph holds of ``FloatingShapes``."""

    inertia: ca.SX
    stiffness: ca.SX
    mass: ca.SX
    critical: ca.SX
    sections: Mapping[str, SectionSymbols]


def constant_shapes(shapes: FloatingShapes) -> ShapeSymbols:
    """Shapes as numbers."""
    return _filled(shapes, [ca.sparsify(ca.SX(ca.DM(table))) for table in _tables(shapes)])


class ShapeNumbers(ComputedNumbers):
    """Shapes as symbols, and what they are at parameter values.

    Parameters
    ----------
    name : of the body
    following : shapes that follow parameters of their structure
    given : parameter of the structure → number
    followed : parameter of the structure → formula of parameters of the mechanism
    """

    def __init__(
        self,
        name: str,
        following: FollowingStructure,
        given: Mapping[str, float],
        followed: Mapping[str, ca.SX],
    ):
        self.name, self.following, self.given = name, following, dict(given)
        self.followed = list(followed)
        self.arguments = ca.vertcat(*followed.values())
        self._places = _places(following.chosen)
        made = [
            ca.SX.sym(f"{name}.shapes{k}", int(places.max(initial=-1)) + 1)
            for k, places in enumerate(self._places)
        ]
        self.symbols = ca.vertcat(*made)
        tables = [_table(column, p) for column, p in zip(made, self._places, strict=True)]
        self.graph = _filled(following.chosen, tables)

    def shapes(self, arguments: np.ndarray) -> FloatingShapes:
        """The shapes themselves."""
        return self._at(tuple(map(float, arguments)))

    def values(self, arguments: np.ndarray) -> np.ndarray:
        return self._packed(self.shapes(arguments))

    def push(self, arguments: np.ndarray, directions: np.ndarray) -> np.ndarray:
        at = tuple(map(float, arguments))
        columns = [self._pushed(at, tuple(map(float, d))) for d in directions.T]
        return np.array(columns).T.reshape(self.symbols.numel(), len(columns))

    def pull(self, arguments: np.ndarray, weights: np.ndarray) -> np.ndarray:
        values = self._parameters(tuple(map(float, arguments)))
        found = [self.following.pull(values, self._unpacked(w), self.followed) for w in weights.T]
        return np.array(found).T.reshape(len(self.followed), len(found))

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
        changes = dict(zip(self.followed, direction, strict=True))
        return self._packed(self.following.push(self._parameters(arguments), changes))

    def _parameters(self, arguments: tuple[float, ...]) -> dict[str, float]:
        return self.given | dict(zip(self.followed, arguments, strict=True))

    def _packed(self, shapes: FloatingShapes) -> np.ndarray:
        columns = []
        for table, places in zip(_tables(shapes), self._places, strict=True):
            column = np.zeros(int(places.max(initial=-1)) + 1)
            column[places[places >= 0]] = table[places >= 0]
            columns.append(column)
        return np.concatenate(columns)

    def _unpacked(self, weights: np.ndarray) -> FloatingShapes:
        """Weights at the entries that stand for the numbers, one where two are equal."""
        tables, begin = [], 0
        for k, places in enumerate(self._places):
            size = int(places.max(initial=-1)) + 1
            own = (np.tril(places + 1) if k < SYMMETRIC else places + 1) > 0
            table = np.zeros(places.shape)
            table[own] = weights[begin : begin + size][places[own]]
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
    found = [shapes.inertia, shapes.stiffness, shapes.mass, shapes.critical]
    for section in shapes.sections.values():
        found += [section.place[:, None], section.shift, section.turn]
    return found


def _places(shapes: FloatingShapes) -> list[np.ndarray]:
    """Number of each entry of each table in its column; −1 where it is always zero."""
    found = []
    for k, table in enumerate(_tables(shapes)):
        if k >= SYMMETRIC:
            found.append(np.arange(table.size).reshape(table.shape))
            continue
        i, j = np.indices(table.shape)
        kept = shapes.counted > 0 if k == 0 else np.ones_like(i, dtype=bool)
        places = np.full(table.shape, -1)
        lower = kept & (i >= j)
        places[lower] = np.arange(lower.sum())
        found.append(np.maximum(places, places.T))
    return found


def _table(column: ca.SX, places: np.ndarray) -> ca.SX:
    """The column's entries at their places."""
    if not places.size:
        return ca.SX(*places.shape)
    flat = ca.vertcat(column, 0)[np.where(places < 0, column.numel(), places).ravel("F").tolist()]
    return ca.sparsify(ca.reshape(flat, *places.shape))


def _filled(shapes: FloatingShapes, tables: list[ca.SX]) -> ShapeSymbols:
    sections = {
        name: SectionSymbols(*tables[SYMMETRIC + 3 * k :][:3])
        for k, name in enumerate(shapes.sections)
    }
    inertia, stiffness, mass, critical = tables[:SYMMETRIC]
    return ShapeSymbols(inertia, stiffness, mass, critical, sections)
