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
        self, structure: StructureDescription, prescribed: np.ndarray, degrees: Numbering, p: ca.SX
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
            raise ModelError(f"{condition.direction}: no element turns this node", condition.entity)
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
