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
from dalembert.structures.reduction.floating_weights import FloatingWeights
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
        self._kept: FloatingSlopes | None = None
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

    def push(self, parameters: Mapping[str, float], changes: Mapping[str, float]) -> FloatingShapes:
        """Changes of what they consist of with changes of some parameters."""
        direction = np.array([changes.get(name, 0.0) for name in self.model.parameters])
        return self._slopes(parameters).push(direction)

    def pull(
        self, parameters: Mapping[str, float], weights: FloatingShapes, names: Sequence[str]
    ) -> np.ndarray:
        """Weights of some parameters from weights of what they consist of."""
        found = FloatingWeights(self._slopes(parameters), weights).found()
        listed = list(self.model.parameters)
        return found[[listed.index(name) for name in names]]

    def _slopes(self, parameters: Mapping[str, float]) -> FloatingSlopes:
        """Of these values; the last ones are kept."""
        values = self.model.values(parameters)
        if self._kept is None or not np.array_equal(self._kept.reduced.p, values):
            reduced = self._reduced(parameters)
            self._kept = FloatingSlopes(reduced, self.model.degrees, self.basis, self.pairs)
        return self._kept

    def _reduced(self, parameters: Mapping[str, float]) -> CraigBampton:
        return self.model.craig_bampton(self.interface, self.modes, parameters=parameters)


def _diagonal(matrix: np.ndarray) -> np.ndarray:
    """Without the round-off beside the diagonal."""
    return np.diag(np.diag(matrix))
