"""Displacements and velocities at the beginning of a motion."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from dalembert.errors import ModelError
from dalembert.structures.description import StructureDescription
from dalembert.structures.evaluation.numbering import Numbering
from dalembert.structures.loads.nodal_load import Load
from dalembert.symbolic.formulas.expression import free_symbols
from dalembert.symbolic.parametric_array import ArrayEntries, ParametricArray


class InitialConditions:
    """``u(0)`` and ``u̇(0)`` of the free displacements, zero where nothing is given.

    Parameters
    ----------
    structure : description that gives them
    prescribed : numbers of the displacements that supports hold
    degrees : numbers of all displacements
    p : parameters

    Attributes
    ----------
    displacements, velocities : ParametricArray of all n displacements
    given : whether any displacement is given

    Raises
    ------
    ModelError
        A prescribed displacement, one given twice, or a formula of anything but parameters.
    """

    def __init__(
        self, structure: StructureDescription, prescribed: np.ndarray, degrees: Numbering, p: ca.SX
    ):
        found = structure.initials
        self._held = {int(k) for k in prescribed}
        self._known = set(structure.parameters)
        self.given = bool(found["displacement"])
        self.displacements = self._array(found["displacement"], degrees, p)
        self.velocities = self._array(found["velocity"], degrees, p)

    def _array(self, given: Sequence[Load], degrees: Numbering, p: ca.SX) -> ParametricArray:
        entries, taken = ArrayEntries(len(degrees)), np.zeros(len(degrees), dtype=bool)
        for one in given:
            places = degrees.of_nodes(one.nodes, one.direction)
            self._check(one, places, taken)
            taken[places] = True
            entries.add(places, one.value)
        return entries.array(p)

    def _check(self, one: Load, places: np.ndarray, taken: np.ndarray) -> None:
        if (places < 0).any():
            raise ModelError(f"{one.direction}: no element turns this node", one.entity)
        if any(int(k) in self._held for k in places):
            raise ModelError(
                f"{one.direction} is prescribed, so its motion is known; remove one of them",
                one.entity,
            )
        if taken[places].any():
            raise ModelError("is given twice; give it once", one.entity)
        for value in one.value:
            foreign = free_symbols(value.sx) - self._known
            if foreign:
                names = ", ".join(sorted(foreign))
                raise ModelError(f"depends on {names}, no parameters here", one.entity)
