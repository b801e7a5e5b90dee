"""Parts of beams that do not touch each other or the bodies they are clamped to."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.contact.beam_parts import BeamPart
from dalembert.elements.contact.hull import Hull
from dalembert.model.graph.model import Model

BEND = np.pi
"""Length of a beam between parts that may touch each other, by its radius: half a circle."""


class Strands:
    """Parts of beams among the shapes of one element.

    Parameters
    ----------
    model : Model
    carriers : of all shapes
    hulls : forms of the first ones
    """

    def __init__(self, model: Model, carriers: list[Any], hulls: list[Hull]):
        count = len(carriers)
        owners: dict[int, int] = {}
        self._owner = np.array([owners.setdefault(id(c.owner), len(owners)) for c in carriers])
        self._nodes, self._clamps = np.zeros((count, 2)), np.full((count, 2), -1)
        self._beside = np.full(count, np.inf)
        for k, carrier in enumerate(carriers):
            if not isinstance(carrier, BeamPart):
                continue
            beam, self._nodes[k] = carrier.beam, (carrier.first, carrier.last)
            chord = beam.length.sx / (beam.count - 1)
            bend = ca.Function("n", [model.all_equations.p], [BEND * hulls[k].radius / chord])
            self._beside[k] = max(float(bend(model.nominal)), 0.5)
            for end, (node, owner) in enumerate(carrier.clamps.items()):
                if max(carrier.first - node, node - carrier.last) <= self._beside[k]:
                    self._clamps[k, end] = owners.setdefault(id(owner), len(owners))

    def apart(self, first: np.ndarray, second: np.ndarray, different: np.ndarray) -> np.ndarray:
        """Mask of pairs of shapes of ``different`` bodies, or distant parts of one beam, except
        parts at a clamp with the shapes of its body."""
        nodes, clamps, owner = self._nodes, self._clamps, self._owner
        between = np.maximum(nodes[second, 0] - nodes[first, 1], nodes[first, 0] - nodes[second, 1])
        own = ~different & (between > self._beside[first])
        clamped = (clamps[first] == owner[second][:, None]).any(axis=1)
        clamped |= (clamps[second] == owner[first][:, None]).any(axis=1)
        mask: np.ndarray = (different | own) & ~clamped
        return mask
