"""Parts of beams that do not touch each other or the bodies they are clamped to.

The distance of two parts is that along their beams, which may be joined at bodies.
"""

from __future__ import annotations

from itertools import combinations
from typing import Any

import casadi as ca
import numpy as np
import scipy

from dalembert.elements.contact.beam_parts import BeamPart
from dalembert.elements.contact.hull import Hull
from dalembert.model.graph.model import Model

BEND = np.pi
"""Length of a beam between parts that may touch each other, by its radius: half a circle."""
ROUNDING = 1e-9
"""Relative difference of lengths that count as equal [-]."""


class Strands:
    """Parts of beams among the shapes of one element.

    Shapes on nodes of a beam are at these places of it.

    Parameters
    ----------
    model : Model
    carriers : of all shapes
    hulls : forms of the first ones
    """

    def __init__(self, model: Model, carriers: list[Any], hulls: list[Hull]):
        self._beams = list(dict.fromkeys(c.beam for c in carriers if isinstance(c, BeamPart)))
        ends = [beam.spot(k) for beam in self._beams for k in (0, beam.count - 1)]
        places = [ca.vertcat(end.local.sx, 0)[:3] for end in ends]
        radii, lengths = [hull.radius for hull in hulls], [b.length.sx for b in self._beams]
        formulas = [ca.vertcat(*lengths), ca.vertcat(*radii), ca.horzcat(*places)]
        densified = [ca.densify(formula) for formula in formulas]
        values = ca.Function("numbers", [model.all_equations.p], densified)(model.nominal)
        self._lengths, radius, places = (value.full().T for value in values)
        self._lengths, radius = self._lengths.ravel(), radius.ravel()
        self._locate(carriers, radius)
        self._between = self._distances(ends, places)

    def _locate(self, carriers: list[Any], radius: np.ndarray) -> None:
        """Beam, or body, of each shape, and the part of the beam's length that it covers."""
        number = {beam: k for k, beam in enumerate(self._beams)}
        nodes = {node: (beam, k) for beam in self._beams for k, node in beam.nodes.items()}
        count, self._bodies = len(carriers), dict[int, int]()
        self._beam, self._vertex = np.full(count, -1), np.zeros(count, dtype=int)
        self._span, self._beside = np.zeros((count, 2)), np.zeros(count)
        self._radius = np.zeros(len(self._beams))
        for k, carrier in enumerate(carriers):
            if isinstance(carrier, BeamPart):
                beam, span = carrier.beam, (carrier.first, carrier.last)
            elif carrier.owner in nodes:
                beam, node = nodes[carrier.owner]
                span = node, node
            else:
                body = self._bodies.setdefault(id(carrier.owner), len(self._bodies))
                self._vertex[k] = 2 * len(self._beams) + body
                continue
            own = self._beam[k] = number[beam]
            chord = self._lengths[own] / (beam.count - 1)
            self._vertex[k], self._span[k] = 2 * own, chord * np.array(span)
            if isinstance(carrier, BeamPart):
                self._beside[k] = max(BEND * radius[k], chord / 2) * (1 + ROUNDING)
                self._radius[own] = max(self._radius[own], radius[k])

    def _distances(self, ends: list[Any], places: np.ndarray) -> np.ndarray:
        """(e, e) shortest ways between both ends of all beams, and to bodies with shapes [m].

        Ends are joined where they overlap at places of one body.
        """
        edges = {(2 * k, 2 * k + 1): float(length) for k, length in enumerate(self._lengths)}
        at_body: dict[int, list[int]] = {}
        for k, end in enumerate(ends):
            at_body.setdefault(id(end.body), []).append(k)
        for joined in at_body.values():
            for pair in combinations(joined, 2):
                way = float(np.linalg.norm(places[pair[0]] - places[pair[1]]))
                if way < self._radius[pair[0] // 2] + self._radius[pair[1] // 2]:
                    edges[pair] = min(way, edges.get(pair, np.inf))
        edges |= {(second, first): way for (first, second), way in edges.items()}
        for k, end in enumerate(ends):  # no way leads through a body
            if id(end.body.owner) in self._bodies:
                edges[k, len(ends) + self._bodies[id(end.body.owner)]] = 0.0
        rows, columns = np.array(list(edges)).T
        weights = np.maximum(list(edges.values()), np.finfo(float).tiny)  # zeros are no edges
        size = len(ends) + len(self._bodies)
        graph = scipy.sparse.csr_array((weights, (rows, columns)), shape=(size, size))
        limit = float(self._beside.max(initial=0.0))
        ways = scipy.sparse.csgraph.dijkstra(graph, limit=limit)
        return np.asarray(np.minimum(ways, ways.T))

    def apart(self, first: np.ndarray, second: np.ndarray, different: np.ndarray) -> np.ndarray:
        """Mask of pairs of shapes of ``different`` bodies, or distant parts of one beam, except
        parts near each other along joined beams, and parts at a clamp with the shapes of its
        body."""
        own = (self._beam[first] == self._beam[second]) & (self._beam[first] >= 0)
        one, other = self._span[first], self._span[second]
        between = np.maximum(other[:, 0] - one[:, 1], one[:, 0] - other[:, 1])
        along = np.where(own, np.maximum(between, 0.0), np.inf)
        for end, way in self._to_ends(first):
            for opposite, back in self._to_ends(second):
                along = np.minimum(along, way + self._between[end, opposite] + back)
        beside = np.maximum(self._beside[first], self._beside[second])
        mask: np.ndarray = (different | own) & (along > beside)
        return mask

    def _to_ends(self, shapes: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Both ends of the beams of shapes, and the ways to them; the bodies of other shapes."""
        beam, vertex, span = self._beam[shapes], self._vertex[shapes], self._span[shapes]
        rest = np.where(beam >= 0, self._lengths[beam] - span[:, 1], 0.0)
        return [(vertex, span[:, 0]), (np.where(beam >= 0, vertex + 1, vertex), rest)]
