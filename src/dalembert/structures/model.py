"""The frozen structure: numbered displacements, blocks of elements, loads and supports."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.errors import ModelError
from dalembert.structures.assembly import Assembly
from dalembert.structures.base import StructuralElement
from dalembert.structures.block import ElementBlock
from dalembert.structures.description import StructureDescription
from dalembert.structures.kind import ElementKind
from dalembert.structures.measures import Measure, StructuralMeasures
from dalembert.structures.node import ROTATIONS, TRANSLATIONS
from dalembert.symbolic.expression import Expression, free_symbols, stack
from dalembert.symbolic.parameter import parameter_vector
from dalembert.symbolic.parametric_array import ParametricArray


class StructuralModel:
    """A structure, checked and frozen; made by ``Structure.build``.

    Attributes
    ----------
    linear : for small displacements
    parameters : name → Parameter
    nominal : (np,) their values
    degrees : (node, direction) → number of the displacement
    supports : (node, direction) → prescribed displacement
    assembly : sums over elements in free and prescribed displacements
    prescribed : ParametricArray of the prescribed displacements, in their order
    loads : case → ParametricArray of the forces on all displacements
    """

    def __init__(self, structure: StructureDescription, linear: bool = False):
        self.structure, self.name, self.linear = structure, structure.name, linear
        self.parameters = dict(structure.parameters)
        self.p = stack(q.sx for q in self.parameters.values())
        self.nominal = np.array([q.value for q in self.parameters.values()], dtype=float)
        self.degrees = self._number()
        self.supports = dict(structure.supports)
        for place in self.degrees:
            if place[0] in structure.fixed:
                self.supports.setdefault(place, Expression(0.0))
        self._refuse_loose_ends()
        self.blocks = self._blocks()
        numbers = [self.degrees[place] for place in self.supports]
        self.assembly = Assembly(self.blocks, len(self.degrees), np.array(numbers, dtype=int))
        self.prescribed = self._array(list(self.supports.values()), len(numbers))
        self.loads = {case: self._load(entries) for case, entries in structure.loads.items()}
        if not self.loads:
            self.loads[""] = self._load([])
        self.measures = StructuralMeasures(self.degrees, self.blocks)

    @cached_property
    def linearized(self) -> StructuralModel:
        """The structure for small displacements."""
        return self if self.linear else StructuralModel(self.structure, linear=True)

    # numbering --------------------------------------------------------------------------
    def _number(self) -> dict[tuple[str, str], int]:
        structure = self.structure
        turning = {n.name for e in structure.elements.values() if e.turns for n in e.nodes()}
        found: dict[tuple[str, str], int] = {}
        for name, node in structure.nodes.items():
            directions = TRANSLATIONS[: node.dimension]
            if name in turning:
                directions += ROTATIONS[node.dimension]
            for direction in directions:
                found[name, direction] = len(found)
        return found

    def _refuse_loose_ends(self) -> None:
        structure = self.structure
        tied = {n.name for e in structure.elements.values() for n in e.nodes()}
        for name in structure.nodes:
            if name not in tied:
                raise ModelError("is not connected to any element; connect or remove it", name)
        for (node, direction), value in self.supports.items():
            if (node, direction) not in self.degrees:
                raise ModelError(f"{direction}: no element turns this node", f"support {node}")
            self._check_formula(value.sx, f"support {node}.{direction}")
        for entries in structure.loads.values():
            for node, direction, value in entries:
                if (node, direction) in self.supports:
                    raise ModelError(
                        f"{direction} is prescribed, so the force there is a reaction and cannot "
                        "be given; remove the load or the support",
                        f"load {node}",
                    )
                self._check_formula(value.sx, f"load {node}")

    def _check_formula(self, formula: ca.SX, entity: str) -> None:
        foreign = free_symbols(formula) - set(self.parameters)
        if foreign:
            raise ModelError(f"depends on {', '.join(sorted(foreign))}, no parameters here", entity)

    # elements -----------------------------------------------------------------------------
    def _blocks(self) -> list[ElementBlock]:
        kinds: dict[tuple, list[StructuralElement]] = {}
        for element in self.structure.elements.values():
            key = (type(element), len(element.nodes()), *element.options().items())
            kinds.setdefault(key, []).append(element)
        return [self._block(found) for found in kinds.values()]

    def _block(self, elements: list[StructuralElement]) -> ElementBlock:
        cls, like = type(elements[0]), elements[0]
        kind = ElementKind(
            cls, self.structure.dimension, len(like.nodes()), like.options(), self.linear
        )
        directions = TRANSLATIONS[: self.structure.dimension]
        directions += ROTATIONS[self.structure.dimension] if cls.turns else ()
        degrees = np.array(
            [
                [self.degrees[node.name, d] for node in element.nodes() for d in directions]
                for element in elements
            ]
        ).T
        entries: list[ca.SX] = []
        for element in elements:
            entries += [e for node in element.nodes() for e in ca.vertsplit(node.position.sx)]
            entries += [getattr(element, q).sx for q in kind.quantities]
        data = self._array([Expression(e) for e in entries], len(entries))
        block = ElementBlock(kind, [e.name for e in elements], degrees, data)
        for element in elements:
            for entity, formula, _ in element.checked_quantities():
                if not formula.sx.is_constant():
                    self._check_formula(formula.sx, entity)
        self._check_values(block, self.nominal)
        return block

    @staticmethod
    def _check_values(block: ElementBlock, p: np.ndarray) -> None:
        """Quantities must be finite and within their limits."""
        first = block.kind.data_count - len(block.kind.quantities)
        for row, field in zip(block.data(p)[first:], block.kind.cls.quantity_fields(), strict=True):
            meta = field.metadata
            for bound, wrong, least in (
                (meta["above"], ~(row > meta["above"]), "above"),
                (meta["minimum"], ~(row >= meta["minimum"]), "at least"),
            ):
                if wrong.any():
                    k = int(np.argmax(wrong))
                    raise ModelError(
                        f"is {row[k]:g} {meta['unit']}; it must be {least} {bound:g}",
                        f"{block.names[k]}.{field.name}",
                    )

    def _array(self, entries: list[Expression], size: int) -> ParametricArray:
        constants, formulas = np.zeros(size), {}
        for k, entry in enumerate(entries):
            if entry.sx.is_constant():
                constants[k] = float(entry.sx)
            else:
                formulas[k] = entry.sx
        return ParametricArray(constants, formulas, self.p)

    def _load(self, entries: list[tuple[str, str, Expression]]) -> ParametricArray:
        sums: dict[int, ca.SX] = {}
        for node, direction, value in entries:
            if (node, direction) not in self.degrees:
                raise ModelError(f"{direction}: no element turns this node", f"load {node}")
            k = self.degrees[node, direction]
            sums[k] = sums.get(k, ca.SX(0)) + value.sx
        columns = [Expression(sums.get(k, ca.SX(0))) for k in range(len(self.degrees))]
        return self._array(columns, len(columns))

    # access ---------------------------------------------------------------------------------
    def values(self, parameters: Mapping[str, float] | None = None) -> np.ndarray:
        """Parameter vector with some values replaced.

        Raises
        ------
        ModelError
            Unknown parameter, or a value that makes a quantity leave its limits.
        """
        p = parameter_vector(self.parameters, parameters, self.name)
        if parameters:
            for block in self.blocks:
                self._check_values(block, p)
        return p

    def __getitem__(self, name: str) -> Expression:
        """A measure or parameter by name, e.g. ``model["n2.uy"]``, ``model["bar.stress"]``.

        Raises
        ------
        KeyError
            Unknown name, with the nearest known ones.
        """
        if name in self.parameters:
            return self.parameters[name]
        found = self.measures.find(name)
        if found is None:
            close = difflib.get_close_matches(name, self.measures.names(), 3, 0.4)
            raise KeyError(f"no measure {name!r}; nearest: {', '.join(close) or 'none'}")
        return found

    def measure(self, symbol: str) -> Measure:
        """What a symbol in a formula of measures stands for."""
        return self.measures.of(symbol)
