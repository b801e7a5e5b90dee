"""Shapes of a floating structure that follow its parameters, with their derivatives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from dalembert.elements.flexible.shapes import FloatingShapes
from dalembert.structures.reduction.basis import modal_basis
from dalembert.structures.reduction.craig_bampton import CraigBampton
from dalembert.structures.reduction.floating import NO_PAIRS, floating_shapes
from dalembert.structures.reduction.floating_slopes import FloatingSlopes
from dalembert.structures.reduction.rigid import node_places


class FollowingShapes:
    """Shapes chosen once, at some parameter values, and what becomes of them at others.

    Parameters
    ----------
    model : StructuralModel
    interface, modes, up_to, frame, second_order : see ``StructuralModel.floating``
    parameters : values where they are chosen

    Attributes
    ----------
    chosen : FloatingShapes, where they are chosen
    """

    def __init__(
        self,
        model,
        interface,
        modes: int,
        up_to: float | None,
        frame: str,
        second_order: bool,
        parameters: Mapping[str, float] | None,
    ):
        self.model, self.interface = model, interface
        reduced = model.craig_bampton(interface, modes, up_to=up_to, parameters=parameters)
        self.modes = reduced.frequencies.size
        places = node_places(model.blocks, model.degrees, reduced.p)
        self.basis = modal_basis(reduced, model.degrees, places, frame)
        given = model.degrees, places, self.basis, None if second_order else NO_PAIRS, model
        found = floating_shapes(reduced, *given)
        self.pairs = found.pairs
        self.chosen: FloatingShapes = replace(
            found,
            stiffness=_diagonal(found.stiffness),
            mass=_diagonal(found.mass),
            critical=_diagonal(found.critical),
        )

    def at(self, parameters: Mapping[str, float]) -> FloatingShapes:
        """The shapes at other parameter values of the structure.

        Raises
        ------
        ModelError, AnalysisError
            The structure cannot be there; the shapes cannot follow so far.
        """
        reduced = self._reduced(parameters)
        places = node_places(self.model.blocks, self.model.degrees, reduced.p)
        given = self.model.degrees, places, self.basis, self.pairs, self.model
        return floating_shapes(reduced, *given)

    def slopes(self, parameters: Mapping[str, float], names: Sequence[str]) -> list[FloatingShapes]:
        """Derivatives of what the shapes consist of with respect to parameters of these names."""
        slopes = FloatingSlopes(
            self._reduced(parameters), self.model.degrees, self.basis, self.pairs
        )
        listed = list(self.model.parameters)
        units = np.eye(len(listed))
        return [slopes.push(units[listed.index(name)]) for name in names]

    def _reduced(self, parameters: Mapping[str, float]) -> CraigBampton:
        return self.model.craig_bampton(self.interface, self.modes, parameters=parameters)


def _diagonal(matrix: np.ndarray) -> np.ndarray:
    """Without the round-off beside the diagonal."""
    return np.diag(np.diag(matrix))
