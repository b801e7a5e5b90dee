"""Load cases and initial conditions of a structure, built from its description."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import casadi as ca
import numpy as np

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.fem.attached import AXES, Attached
from dalembert.elements.fem.element_set import Elements
from dalembert.elements.fem.nodal import effort, missing_rotation, spin_map
from dalembert.errors import ModelError
from dalembert.model.assembled.evaluation.assembly import Assembly
from dalembert.model.assembled.evaluation.blocks import BlockMaker, Part
from dalembert.model.assembled.evaluation.numbering import Numbering
from dalembert.model.assembled.load_case import (
    ConfigurationLoad,
    LoadCase,
    MassForce,
    Temperatures,
)
from dalembert.model.load_records import LineLoad, Load, Spread, Weight
from dalembert.model.supports_and_loads import SupportsAndLoads
from dalembert.symbolic.formulas.expression import Expression, free_symbols
from dalembert.symbolic.parametric_array import ArrayEntries, ParametricArray
from dalembert.text.wording import plain_text


@dataclass(eq=False)
class FixedMoment(Attached):
    """A moment that does the virtual work ``Mᵀ δθ`` with the spin ``δθ = 𝗧(r) δr`` of its node.

    The generalized force on the rotation vector is ``𝗧(r)ᵀ M``; it has no potential.

    Parameters
    ----------
    moment_x, moment_y, moment_z : about fixed axes [N m]
    """

    moment_x: Scalar = quantity("N m", "about x", default=0.0, keyword=True)
    moment_y: Scalar = quantity("N m", "about y", default=0.0, keyword=True)
    moment_z: Scalar = quantity("N m", "about z", default=0.0, keyword=True)
    turns: ClassVar[bool] = True
    dimensions: ClassVar[tuple[int, ...]] = (3,)

    @classmethod
    def virtual_work(
        cls, u: list[ca.SX], w: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]
    ) -> ca.SX:
        moment = ca.vertcat(*(q[f"moment_{axis}"] for axis in AXES))
        return -ca.dot(moment, ca.mtimes(spin_map(u[0][3:]), w[0][3:]))

    @classmethod
    def part(cls, load: Load) -> Part:
        """The moments of one load, as elements."""
        quantities = {field.name: Expression(0.0) for field in cls.quantity_fields()}
        quantities[f"moment_{load.direction[-1]}"] = load.each
        nodes = load.nodes[:, None]
        return Part(load.entity, cls, {}, nodes, load.nodes.size, quantities, timed=True)


class LoadCaseMaker:
    """Load cases of a structure.

    Parameters
    ----------
    maker : BlockMaker of the structure
    degrees : numbers of the displacements
    assembly : of all elements
    """

    def __init__(self, maker: BlockMaker, degrees: Numbering, assembly: Assembly):
        self.maker, self.degrees, self.assembly = maker, degrees, assembly
        self.structure = maker.structure
        self.held = np.zeros(len(degrees), dtype=bool)
        self.held[assembly.prescribed] = True

    def cases(self) -> dict[str, LoadCase]:
        """Load cases by name; an empty one if none is declared.

        Raises
        ------
        ModelError
            A force on a prescribed or a missing displacement.
        """
        s = self.structure
        declared = (*s.loads, *s.spread, *s.temperatures)
        names = dict.fromkeys(plain_text(n, "load case") for n in declared) or [""]
        return {n: self._case(s.loads.get(n, []), s.spread.get(n, []), n) for n in names}

    def _case(self, loads: list[Load], spread: list[Spread], name: str) -> LoadCase:
        entries = ArrayEntries(len(self.degrees))
        fixed_moments = []
        for load in loads:
            places = self._places(load)
            if load.fixed_axes and not self.maker.linear:
                fixed_moments.append(load)
            else:
                entries.add(places, load.value)
        parts = [Part.of(s, self.structure.numbers) for s in spread if isinstance(s, Elements)]
        blocks = [self.maker.block([part], self.degrees) for part in parts]
        forces = [self._mass_force(s) for s in spread if isinstance(s, (Weight, LineLoad))]
        temperatures, fixed = self._temperatures(name), any(load.fixed_axes for load in loads)
        moments = [FixedMoment.part(load) for load in fixed_moments]
        configuration = ConfigurationLoad(
            list(temperatures.heated.values()),
            [self.maker.block(moments, self.degrees)] if moments else [],
            len(self.degrees),
            self.assembly.prescribed,
            self.maker.linear,
        )
        nodal = entries.array(self.maker.p)
        return LoadCase(nodal, blocks, forces, temperatures, configuration, fixed)

    def _temperatures(self, case: str) -> Temperatures:
        changes = self.structure.temperatures.get(case, {})
        numbered = enumerate(self.assembly.blocks)
        heated = {block: self.maker.heated(k, self.degrees, changes) for k, block in numbered}
        return Temperatures({block: hot for block, hot in heated.items() if hot is not None})

    def _places(self, load: Load) -> np.ndarray:
        places = self.degrees.of_nodes(load.nodes, load.direction)
        wrong = np.flatnonzero((places < 0) | (self.held[places] & ~load.is_zero))
        if not wrong.size:
            return places
        node = self.structure.numbers.name(int(load.nodes[wrong[0]]))
        if places[wrong[0]] < 0:
            raise missing_rotation(effort(load.direction), f"load {node}")
        raise ModelError(
            f"{effort(load.direction)}: {load.direction} is prescribed, so the force there is a "
            "reaction and cannot be given; remove the load or the support",
            f"load {node}",
        )

    def _mass_force(self, load: Weight | LineLoad) -> MassForce:
        if isinstance(load, Weight):
            given, d = len(load.acceleration), self.structure.dimension
            if given != d:
                raise ModelError(f"needs {d} numbers, got {given}", "gravity")
            return MassForce(self.assembly, self._field(load.acceleration))
        unit = Expression(1.0)  # area and density, so that the mass per length is one
        blocks = []
        for part in load.parts:
            line = Part.of(part, self.structure.numbers)
            quantities = line.quantities | {"area": unit, "density": unit}
            blocks.append(self.maker.block([replace(line, quantities=quantities)], self.degrees))
        assembly = Assembly(blocks, len(self.degrees), self.assembly.prescribed)
        return MassForce(assembly, self._field(load.force))

    def _field(self, vector: tuple[Expression, ...]):
        """A field with the same vector at all nodes."""
        entries = ArrayEntries(len(self.degrees))
        for k, value in enumerate(vector):
            entries.add(self.degrees.table[:, k], value)
        return entries.array(self.maker.p)


class InitialConditions:
    """``u(0)`` and ``u̇(0)`` of the free displacements, zero by default.

    Parameters
    ----------
    structure : description with the initial conditions
    prescribed : numbers of the prescribed displacements
    degrees : numbers of all displacements
    p : parameters

    Attributes
    ----------
    displacements, velocities : ParametricArray of all n displacements
    displaced : whether any initial displacement is given

    Raises
    ------
    ModelError
        A prescribed displacement, a repeated condition, or a formula of unknown names.
    """

    def __init__(
        self, structure: SupportsAndLoads, prescribed: np.ndarray, degrees: Numbering, p: ca.SX
    ):
        initials = structure.initials
        self._held = {int(k) for k in prescribed}
        self._names = set(structure.parameters)
        self.displaced = bool(initials["displacement"])
        self.displacements = self._array(initials["displacement"], degrees, p)
        self.velocities = self._array(initials["velocity"], degrees, p)

    def _array(self, conditions: Sequence[Load], degrees: Numbering, p: ca.SX) -> ParametricArray:
        entries, assigned = ArrayEntries(len(degrees)), np.zeros(len(degrees), dtype=bool)
        for condition in conditions:
            places = degrees.of_nodes(condition.nodes, condition.direction)
            self._check(condition, places, assigned)
            assigned[places] = True
            entries.add(places, condition.value)
        return entries.array(p)

    def _check(self, condition: Load, places: np.ndarray, assigned: np.ndarray) -> None:
        if (places < 0).any():
            raise missing_rotation(condition.direction, condition.entity)
        if any(int(k) in self._held for k in places):
            raise ModelError(
                f"{condition.direction} is prescribed, so its motion is known; remove one of them",
                condition.entity,
            )
        if assigned[places].any():
            raise ModelError("is given twice; give it once", condition.entity)
        for value in condition.value:
            foreign = free_symbols(value.sx) - self._names
            if foreign:
                names = ", ".join(sorted(foreign))
                raise ModelError(f"depends on {names}, no parameters here", condition.entity)
