"""The frozen structure: numbered displacements, blocks of elements, loads and supports."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from time import perf_counter
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Look
from dalembert.elements.flexible.shapes import FloatingShapes
from dalembert.elements.look import Support
from dalembert.errors import ModelError
from dalembert.model.assembled.evaluation.assembly import Assembly
from dalembert.model.assembled.evaluation.block import ElementBlock
from dalembert.model.assembled.evaluation.blocks import BlockMaker
from dalembert.model.assembled.evaluation.numbering import Numbering
from dalembert.model.assembled.load_cases import InitialConditions, LoadCaseMaker
from dalembert.model.assembled.measures import Measure
from dalembert.model.assembled.named_measures import StructuralMeasures
from dalembert.model.assembled.reduction.basis import MEAN
from dalembert.model.assembled.reduction.craig_bampton import CraigBampton, craig_bampton
from dalembert.model.assembled.reduction.following import FollowingShapes
from dalembert.model.assembled.reduction.rigid import GivenInterfaces, interfaces_of, node_positions
from dalembert.model.supports_and_loads import SupportsAndLoads
from dalembert.model.value_limits import ValueLimit, check_number, valid_numbers
from dalembert.symbolic.formulas.declared import declared
from dalembert.symbolic.formulas.expression import Expression, free_symbols, stack, t
from dalembert.symbolic.parametric_array import ArrayEntries
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.wording import card, table


class StructuralModel(ParametricModel):
    """A structure, checked and frozen; returned by ``Structure.build``.

    Parameters
    ----------
    structure : SupportsAndLoads
    linear : for small displacements

    Attributes
    ----------
    linear : for small displacements
    parameters : name → Parameter
    nominal : (np,) their values
    degrees : (node, direction) → number of the displacement
    supports : (node, direction) → prescribed displacement
    assembly : sums over elements in free and prescribed displacements
    prescribed : ParametricArray of the prescribed displacements, in their order
    loads : case → LoadCase
    initial : initial conditions of motions
    build_time : time to build the model [s]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> structure = da.Structure("bar")
    >>> area = structure.parameter("area", 1e-4, "m^2")
    >>> a, b = structure.node("a", 0.0), structure.node("b", 1.0)
    >>> bar = structures.Truss("bar", a, b, area=area, modulus=2e11, density=7850)
    >>> added = structure.add(bar)
    >>> structure.support(a)
    >>> model = structure.build()
    >>> isinstance(model, da.StructuralModel), list(model.parameters), len(model.degrees)
    (True, ['area'], 2)
    """

    kind = "structure"

    def __init__(self, structure: SupportsAndLoads, linear: bool = False):
        begin = perf_counter()
        _refuse_motions(structure)
        self.structure, self.name, self.linear = structure, structure.name, linear
        self.parameters = dict(structure.parameters)
        self.derived_parameters = dict(structure.derived_parameters)
        self.tables, self.declared_outputs = dict(structure.tables), dict(structure.outputs)
        self.p = stack(q.sx for q in self.parameters.values())
        self.nominal = np.array([q.value for q in self.parameters.values()], dtype=float)
        maker = BlockMaker(structure, self.p, linear)
        self._refuse_loose_nodes(maker.tied)
        self.degrees = Numbering(structure.numbers, maker.turning, structure.dimension)
        self.supports = structure.prescribed(self.degrees.directions_of)
        self._check_formulas()
        self.blocks = maker.blocks(self.degrees)
        self.check_values(self.nominal)
        numbers = np.array([self.degrees[place] for place in self.supports], dtype=int)
        self.assembly = Assembly(self.blocks, len(self.degrees), numbers)
        entries = ArrayEntries(numbers.size)
        for k, value in enumerate(self.supports.values()):
            entries.add(k, value)
        self.prescribed = entries.array(self.p)
        self.loads = LoadCaseMaker(maker, self.degrees, self.assembly).cases()
        self.initial = InitialConditions(structure, numbers, self.degrees, self.p)
        self.measures = StructuralMeasures(self.degrees, self.blocks)
        self.build_time = perf_counter() - begin

    @cached_property
    def linearized(self) -> StructuralModel:
        """The structure for small displacements."""
        return self if self.linear else StructuralModel(self.structure, linear=True)

    # supports and loads -------------------------------------------------------------------
    def __repr__(self) -> str:
        kinds = ", ".join(f"{block.count} {block.kind.cls.__name__}" for block in self.blocks)
        counted = f"{len(self.degrees.nodes)} nodes, {kinds or 'no elements'}"
        return f"<StructuralModel {self.name!r}: {counted}, {len(self.degrees)} displacements>"

    def _repr_html_(self) -> str:
        rows = [(block.kind.cls.__name__, block.count) for block in self.blocks]
        rows += [("load cases", ", ".join(name or "unnamed" for name in self.loads) or "none")]
        counted = f"{len(self.degrees.nodes)} nodes, {len(self.degrees)} displacements"
        return card(f"Structure {self.name}", counted, table(rows))

    def _refuse_loose_nodes(self, tied: np.ndarray) -> None:
        if not tied.all():
            raise ModelError(
                "is not connected to any element; connect or remove it",
                self.structure.numbers.name(int(np.argmin(tied))),
            )

    def _check_formulas(self) -> None:
        """Formulas of supports and loads contain parameters and time only."""
        for (node, direction), value in self.supports.items():
            self._check_formula(value.sx, f"support {node}.{direction}")
        for loads in self.structure.loads.values():
            for load in loads:
                for value in load.value if isinstance(load.value, list) else [load.value]:
                    self._check_formula(value.sx, load.entity)
        for spread in self.structure.spread.values():
            for field in spread:
                for value in getattr(field, "acceleration", ()) or getattr(field, "force", ()):
                    self._check_formula(value.sx, type(field).__name__.lower())

    def _check_formula(self, formula: ca.SX, entity: str) -> None:
        foreign = free_symbols(formula) - set(self.parameters) - {"t"}
        if "t" in self.parameters and ca.depends_on(formula, t.sx):
            raise ModelError("depends on time, but 't' is a parameter here; rename it", entity)
        if foreign:
            raise ModelError(f"depends on {', '.join(sorted(foreign))}, no parameters here", entity)

    # parameters -----------------------------------------------------------------------------
    def check_values(self, p: np.ndarray) -> None:
        """Raise unless quantities of elements are finite and within limits, and shapes are valid.

        Raises
        ------
        ModelError
            Names the element and the quantity.
        """
        for block in self.blocks:
            _check_block(block, p)

    def value_limits(self) -> tuple[ca.SX, list[ValueLimit]]:
        return self.p, [limit for block in self.blocks for limit in block.value_limits()]

    # reduction ------------------------------------------------------------------------------
    def craig_bampton(
        self,
        interface: GivenInterfaces,
        modes: int = 6,
        *,
        up_to: float | None = None,
        parameters: Mapping[str, float] | None = None,
    ) -> CraigBampton:
        """Craig–Bampton reduction.

        Parameters
        ----------
        interface : name → nodes that move as one rigid section, or separate nodes
        modes : upper limit of the number of fixed-interface modes
        up_to : upper limit of their frequency [rad/s]
        parameters : new values of parameters, without rebuilding

        Raises
        ------
        ModelError, SingularityError
            Wrong interfaces, supports, or parts that move without strain.
        """
        p, linear = self.values(parameters), self.linearized
        positions = node_positions(self.blocks, self.degrees, p)
        interfaces = interfaces_of(interface, self.degrees, positions)
        return craig_bampton(linear.assembly, self.degrees, p, interfaces, modes, up_to)

    def floating(
        self, interface: GivenInterfaces, modes: int = 6, **options: Any
    ) -> FloatingShapes:
        """Shapes in a frame that floats with the structure, with the options of ``following``."""
        return self.following(interface, modes, **options).chosen

    def following(
        self,
        interface: GivenInterfaces,
        modes: int = 6,
        *,
        up_to: float | None = None,
        frame: str = MEAN,
        second_order: bool = False,
        parameters: Mapping[str, float] | None = None,
    ) -> FollowingShapes:
        """Shapes in a frame that floats with the structure, for a ``FlexibleBody``.

        They are chosen at some parameter values and follow the parameters smoothly.

        Parameters
        ----------
        frame : interface to which the frame is fixed, or ``"mean"`` axes
        second_order : whether second-order displacements are included
        """
        return FollowingShapes(self, interface, modes, up_to, frame, second_order, parameters)

    # access ---------------------------------------------------------------------------------
    def look(self) -> list[Look]:
        """Primitives of its elements, numbered block by block, and of its supports."""
        looks: list[Look] = []
        first = 0
        for block in self.blocks:
            elements = first + np.arange(block.count)
            looks += block.kind.cls.look_of(block.nodes.T, elements)
            first += block.count
        numbers = ((self.degrees.nodes.number(node), key) for node, key in self.supports)
        return looks + [Support(node, key) for node, key in numbers if node is not None]

    def _all_names(self) -> list[str]:
        return [*self.measures.names(), *self.parameters, *self.derived_parameters]

    def _measure(self, name: str) -> Expression | None:
        own = declared(self, name)
        return self.measures.find(name) if own is None else own

    def measure_symbols(self, sx: ca.SX) -> list[ca.SX]:
        """Symbols of measures in a formula; a parameter may have the name of a measure."""
        others = {symbol.element_hash() for symbol in (t.sx, *ca.vertsplit(self.p))}
        return [symbol for symbol in ca.symvar(sx) if symbol.element_hash() not in others]

    def measure(self, symbol: str) -> Measure:
        """The measure of a symbol in a formula."""
        return self.measures.of(symbol)


def _refuse_motions(structure: SupportsAndLoads) -> None:
    """Refuse initial conditions that belong to mechanisms."""
    if structure.initial_conditions:
        raise ModelError(
            "initial(measure, value) is for mechanisms; give initial(node, ux=…, vx=…)",
            structure.name,
        )
    for nodes in structure.nodes.values():
        if nodes.motion is not None:
            raise ModelError(
                "the initial velocity of a mesh is for mechanisms; give initial(nodes, vx=…)",
                nodes.name,
            )


def _check_block(block: ElementBlock, p: np.ndarray) -> None:
    kind, data = block.kind, block.data(p)
    row = kind.data_count - sum(f.metadata["size"] for f in kind.cls.quantity_fields())
    for field in kind.cls.quantity_fields():
        meta = field.metadata
        values = data[row : row + meta["size"]]
        row += meta["size"]
        limits = meta["minimum"], meta["above"]
        for k, e in np.argwhere(~valid_numbers(values, *limits)):
            entity = f"{block.names.name(int(e))}.{field.name}"
            check_number(float(values[k, e]), entity, meta["unit"], *limits)
    for e, wrong in kind.faults(data):
        raise ModelError(wrong, block.names.name(e))
