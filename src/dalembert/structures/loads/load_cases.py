"""Load cases of a structure, built from its description."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.errors import ModelError
from dalembert.structures.evaluation.assembly import Assembly
from dalembert.structures.evaluation.blocks import BlockMaker, Part
from dalembert.structures.evaluation.elements import Elements
from dalembert.structures.evaluation.numbering import Numbering
from dalembert.structures.loads.configuration_load import ConfigurationLoad
from dalembert.structures.loads.fixed_moments import FixedMoment
from dalembert.structures.loads.load_case import LoadCase, MassForce
from dalembert.structures.loads.nodal_load import Load
from dalembert.structures.loads.spread_loads import LineLoad, Spread, Weight
from dalembert.structures.loads.temperatures import Temperatures
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.parametric_array import ArrayEntries
from dalembert.text.wording import plain_text


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
        wrong = np.flatnonzero((places < 0) | (self.held[places] & ~load.nothing))
        if not wrong.size:
            return places
        node = self.structure.numbers.name(int(load.nodes[wrong[0]]))
        if places[wrong[0]] < 0:
            raise ModelError(f"{load.direction}: no element turns this node", f"load {node}")
        raise ModelError(
            f"{load.direction} is prescribed, so the force there is a reaction and cannot be "
            "given; remove the load or the support",
            f"load {node}",
        )

    def _mass_force(self, load: Weight | LineLoad) -> MassForce:
        if isinstance(load, Weight):
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
