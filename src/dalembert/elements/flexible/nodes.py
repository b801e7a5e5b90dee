"""Nodes of beams, and the cross-sections at them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property, partial
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.coordinates import Coordinates
from dalembert.elements.pair import initial_value
from dalembert.errors import ModelError


@dataclass(frozen=True, eq=False)
class CrossSection:
    """A cross-section: where it is and how it stands.

    Attributes
    ----------
    place : (d,) its centre
    turn : its angle in the plane, its Euler parameters in space
    spin : its angular velocity, in its own axes
    body : what carries it; None of sections that are only thought of
    """

    place: ca.SX
    turn: ca.SX
    spin: ca.SX
    body: Any = None


class OwnNode:
    """A node that an element brings along, ahead of the body that it is in the plane or in space.

    Attributes
    ----------
    estimate : its pose as far as guesses tell; None of a node whose own are all there is
    """

    node = True
    estimate: Callable[[], ca.SX] | None = None

    def check_name(self) -> None:
        """It is the element's name with its own, which nobody typed."""

    def guesses(self) -> tuple[list, list]:
        pose, twist = super().guesses()  # type: ignore[misc]
        return (pose if self.estimate is None else ca.vertsplit(self.estimate())), twist

    def guessed(self) -> list[bool]:
        me: Any = super()
        return me.guessed() if self.estimate is None else [False] * len(me.guessed())


class Noded:
    """An element through a row of nodes, the first and the last of which frames may carry."""

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
        """Number of nodes, those at the ends among them."""
        return self.elements * self.order + 1

    @cached_property
    def places(self) -> np.ndarray:
        """(count,) of the nodes, in shares of the length."""
        return np.linspace(0.0, 1.0, self.count)

    def _made_nodes(self) -> dict[int, Any]:
        """Own nodes by number."""
        last, found = self.count - 1, {}
        for k in range(self.count):
            if (self.frame_i if k == 0 else self.frame_j if k == last else None) is not None:
                continue
            own = {0: "start", last: "end"}.get(k, f"node{k}")
            name = f"{self.name}.{own}"
            if k == 0:
                found[k] = self.first_node(name)
                continue
            found[k] = self.node_kind(name)
            found[k].estimate = cache(partial(self._estimate, k))
        return found

    def first_node(self, name: str) -> Any:
        """A body without mass where the element was said to start."""
        raise NotImplementedError

    def carried(self, k: int) -> tuple[ca.SX, ca.SX]:
        """Place and turn of a node on the natural shape, which its start carries."""
        raise NotImplementedError

    def _estimate(self, k: int) -> ca.SX:
        """Pose of a node as far as guesses of its start tell."""
        return initial_value(ca.vertcat(*self.carried(k)), [self.start]).sx

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
        """Its bodies by their names within it."""
        own = {body.name.removeprefix(f"{self.name}."): body for body in self.nodes.values()}
        return {"start": self.start, "end": self.end} | own

    def node(self, k: int) -> Any:
        """The body of a node, counted from the start."""
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
