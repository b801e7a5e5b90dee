"""Shapes of a floating structure as functions of its parameters, with tangent and adjoint."""

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
    """Shapes chosen at some parameter values, continued smoothly to others.

    Parameters
    ----------
    model : StructuralModel
    interface, modes, up_to, frame, second_order : see ``StructuralModel.floating``
    parameters : values at which they are chosen

    Attributes
    ----------
    chosen : FloatingShapes at these values
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
        self._cache: FloatingSlopes | None = None
        reduced = model.craig_bampton(interface, modes, up_to=up_to, parameters=parameters)
        self.modes = reduced.frequencies.size
        places = node_places(model.blocks, model.degrees, reduced.p)
        self.basis = modal_basis(reduced, model.degrees, places, frame)
        arguments = model.degrees, places, self.basis, None if second_order else NO_PAIRS, model
        shapes = floating_shapes(reduced, *arguments)
        self.pairs = shapes.pairs
        self.chosen: FloatingShapes = replace(
            shapes,
            stiffness=_diagonal(shapes.stiffness),
            mass=_diagonal(shapes.mass),
            critical=_diagonal(shapes.critical),
        )

    def at(self, parameters: Mapping[str, float]) -> FloatingShapes:
        """The shapes at other parameter values of the structure.

        Raises
        ------
        ModelError, AnalysisError
            Invalid values, or values too far for the shapes to follow.
        """
        reduced = self._reduced(parameters)
        places = node_places(self.model.blocks, self.model.degrees, reduced.p)
        arguments = self.model.degrees, places, self.basis, self.pairs, self.model
        return floating_shapes(reduced, *arguments)

    def push(self, parameters: Mapping[str, float], changes: Mapping[str, float]) -> FloatingShapes:
        """Changes of the shapes and their integrals with changes of some parameters."""
        direction = np.array([changes.get(name, 0.0) for name in self.model.parameters])
        return self._slopes(parameters).push(direction)

    def pull(
        self, parameters: Mapping[str, float], weights: FloatingShapes, names: Sequence[str]
    ) -> np.ndarray:
        """Weights of some parameters from weights of the shapes and their integrals."""
        p_bar = FloatingWeights(self._slopes(parameters), weights).parameters()
        all_names = list(self.model.parameters)
        return p_bar[[all_names.index(name) for name in names]]

    def _slopes(self, parameters: Mapping[str, float]) -> FloatingSlopes:
        """Derivatives at parameter values; the last ones are cached."""
        values = self.model.values(parameters)
        if self._cache is None or not np.array_equal(self._cache.reduced.p, values):
            reduced = self._reduced(parameters)
            self._cache = FloatingSlopes(reduced, self.model.degrees, self.basis, self.pairs)
        return self._cache

    def _reduced(self, parameters: Mapping[str, float]) -> CraigBampton:
        return self.model.craig_bampton(self.interface, self.modes, parameters=parameters)


def _diagonal(matrix: np.ndarray) -> np.ndarray:
    """The diagonal part; the rest is round-off."""
    return np.diag(np.diag(matrix))
