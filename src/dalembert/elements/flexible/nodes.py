"""Nodes of beams, their cross-sections, and the interpolation between them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property, partial
from typing import Any

import casadi as ca
import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import leggauss

from dalembert.elements.coordinates import Coordinates
from dalembert.elements.pair import initial_value
from dalembert.errors import ModelError


@dataclass(frozen=True)
class Lagrange:
    """Polynomials ``N_k`` through equally spaced nodes ``ξ_k = k/p`` of an element of order p."""

    order: int

    @cached_property
    def nodes(self) -> np.ndarray:
        """(p + 1,) coordinates of the nodes."""
        return np.linspace(0.0, 1.0, self.order + 1)

    @cached_property
    def shapes(self) -> list[Polynomial]:
        """``N_k``, one at its node and zero at the others."""
        return _through(self.nodes)

    def values(self, at: np.ndarray) -> np.ndarray:
        """(m, p + 1) ``N_k(ξ)``."""
        return np.stack([shape(at) for shape in self.shapes], axis=1)

    def slopes(self, at: np.ndarray) -> np.ndarray:
        """(m, p + 1) ``dN_k/dξ``."""
        return np.stack([shape.deriv()(at) for shape in self.shapes], axis=1)

    @cached_property
    def products(self) -> np.ndarray:
        """(p + 1, p + 1) ``∫ N_k N_l dξ``."""
        at, weights = gauss(self.order + 1)
        values = self.values(at)
        return values.T @ (weights[:, None] * values)

    @cached_property
    def shares(self) -> np.ndarray:
        """(p + 1,) ``∫ N_k dξ``."""
        return self.products.sum(axis=1)


def gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """(m,) Gauss–Legendre points on the unit interval, and their weights."""
    at, weights = leggauss(count)
    return (at + 1) / 2, weights / 2


def through(points: np.ndarray, at: float) -> np.ndarray:
    """(m,) weights of the values at ``points`` in their interpolating polynomial at ``at``."""
    return np.array([shape(at) for shape in _through(points)])


def _through(points: np.ndarray) -> list[Polynomial]:
    polynomials = []
    for k, node in enumerate(points):
        others = np.delete(points, k)
        shape = Polynomial.fromroots(others) if others.size else Polynomial([1.0])
        polynomials.append(shape / shape(node))
    return polynomials


@dataclass(frozen=True, eq=False)
class CrossSection:
    """Position and orientation of a cross-section.

    Attributes
    ----------
    place : (d,) its centre
    turn : its angle in the plane, its Euler parameters in space
    spin : its angular velocity in section axes
    body : the body that carries it; None for sections of the natural shape
    """

    place: ca.SX
    turn: ca.SX
    spin: ca.SX
    body: Any = None


class OwnNode:
    """Mixin of bodies that are nodes of an element, placed before the body class.

    Attributes
    ----------
    estimate : returns its pose from the guesses of the start; None if it has guesses of its own
    """

    node = True
    estimate: Callable[[], ca.SX] | None = None

    def check_name(self) -> None:
        """Skip the check: the name combines those of the element and the node."""

    def guesses(self) -> tuple[list, list]:
        pose, twist = super().guesses()  # type: ignore[misc]
        return (pose if self.estimate is None else ca.vertsplit(self.estimate())), twist

    def specified(self) -> list[bool]:
        body: Any = super()
        return body.specified() if self.estimate is None else [False] * len(body.specified())


class Noded:
    """An element along a row of nodes, whose first and last may be frames of bodies."""

    name: str
    frame_i: Any
    frame_j: Any
    elements: int
    order: int
    node_kind: type
    nodes: dict[int, Any]
    sections: list[CrossSection]

    @property
    def count(self) -> int:
        """Number of nodes including the ends."""
        return self.elements * self.order + 1

    @cached_property
    def places(self) -> np.ndarray:
        """(count,) positions of the nodes as fractions of the length."""
        return np.linspace(0.0, 1.0, self.count)

    def _create_nodes(self) -> dict[int, Any]:
        """The nodes that belong to the element, by number."""
        last, nodes = self.count - 1, {}
        for k in range(self.count):
            if (self.frame_i if k == 0 else self.frame_j if k == last else None) is not None:
                continue
            label = {0: "start", last: "end"}.get(k, f"node{k}")
            name = f"{self.name}.{label}"
            if k == 0:
                nodes[k] = self.first_node(name)
                continue
            nodes[k] = self.node_kind(name)
            nodes[k].estimate = cache(partial(self._estimate, k))
        return nodes

    def first_node(self, name: str) -> Any:
        """A massless body at the specified start of the element."""
        raise NotImplementedError

    def natural_pose(self, k: int) -> tuple[ca.SX, ca.SX]:
        """Position and rotation of a node on the natural shape attached to the start."""
        raise NotImplementedError

    def _estimate(self, k: int) -> ca.SX:
        """Pose of a node from the guesses of the start."""
        return initial_value(ca.vertcat(*self.natural_pose(k)), [self.start]).sx

    def _section(self, k: int) -> CrossSection:
        if k in self.nodes:
            return self.node_section(self.nodes[k])
        return self.frame_section(self.frame_i if k == 0 else self.frame_j, k > 0)

    def node_section(self, node: Any) -> CrossSection:
        raise NotImplementedError

    def frame_section(self, frame: Any, last: bool) -> CrossSection:
        raise NotImplementedError

    @property
    def start(self) -> Any:
        """The body at its first end."""
        return self.sections[0].body

    @property
    def end(self) -> Any:
        """The body at its second end."""
        return self.sections[-1].body

    @property
    def named_nodes(self) -> dict[str, Any]:
        """Its bodies by their names within the element."""
        nodes = {body.name.removeprefix(f"{self.name}."): body for body in self.nodes.values()}
        return {"start": self.start, "end": self.end} | nodes

    def node(self, k: int) -> Any:
        """The body of a node, by its number from the start."""
        if not -self.count <= k < self.count:
            raise ModelError(f"has nodes 0 to {self.count - 1}, not {k}", self.name)
        return self.sections[k].body

    def own_coordinates(self) -> list[Coordinates]:
        return list(self.nodes.values())

    def parts(self) -> list[Coordinates]:
        return list(dict.fromkeys(section.body for section in self.sections))

    def spot(self, k: int) -> Any:
        """The point at a node."""
        if k in self.nodes:
            return self.nodes[k].center
        return self.frame_i if k == 0 else self.frame_j
