"""Lookup of the bodies, points, nodes, beams and joints that a file names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from dalembert.elements.base import Element
from dalembert.elements.body import BodyElement
from dalembert.elements.fem.node_set import Nodes
from dalembert.elements.frame import Frame
from dalembert.errors import ModelError
from dalembert.io.documents import Document
from dalembert.io.formulas import Formulas
from dalembert.io.orientations import FrameTable, read_frame
from dalembert.model.system import System
from dalembert.text.wording import listed, misspelt, unknown

N = TypeVar("N")


class References:
    """Lookup of named objects; errors suggest the nearest names.

    Parameters
    ----------
    document : Document, which lists the valid names
    system : System that contains the bodies
    formulas : reads the coordinates of inline points
    """

    def __init__(self, document: Document, system: System, formulas: Formulas):
        self.document, self.system, self.formulas = document, system, formulas

    def body(self, name: str) -> BodyElement:
        """The body of this name, or the ground."""
        if name != "ground" and name not in self.document.bodies:
            raise ModelError(unknown("body", name, ["ground", *self.document.bodies]))
        return self.system.body(name)

    def node(self, owner: str, name: str) -> Any:
        """The body at a node of a beam."""
        if owner not in self.system.elements:
            raise ModelError(
                f"{owner} is not defined yet; a beam begins and ends at bodies, or at "
                "beams before it"
            )
        element: Any = self.system.elements[owner]
        return self._among(element.named_nodes, owner, name, f"{owner}.")

    def node_of_mesh(self, owner: str, reference: str) -> Nodes:
        """A node of a mesh, ``mesh_nodes[3]``."""
        nodes = self.system.meshes[owner].nodes()
        named = {name: nodes[k] for k, name in enumerate(nodes.names)}
        return self._among(named, owner, reference, "")

    @staticmethod
    def _among(nodes: Mapping[str, N], owner: str, name: str, prefix: str) -> N:
        """The node of this name."""
        if name not in nodes:
            reference, names = f"{prefix}{name}" if name else owner, [prefix + n for n in nodes]
            nodes_of = f"; nodes of {owner}: {listed(names)}"
            raise ModelError(misspelt(f"unknown node {reference!r}", reference, names, nodes_of))
        return nodes[name]

    def joint(self, name: str) -> Element:
        """The joint of this name."""
        if name not in self.document.joints:
            raise ModelError(unknown("joint", name, list(self.document.joints)))
        return self.system.elements[name]

    def beam(self, name: str) -> Element:
        """The beam of this name."""
        names = list(self.document.beams)
        if name not in names:
            raise ModelError(unknown("beam", name, names))
        return self.system.elements[name]

    def end(self, kind: type, reference: Any) -> Any:
        """The body, point or frame given by ``"crank"``, ``"crank.end"`` or an inline table.

        Raises
        ------
        ModelError
            Unknown names, or a point where a body is needed.
        """
        if not isinstance(reference, str):
            return self._from_table(kind, reference)
        owner, _, name = reference.partition(".")
        mesh = owner.partition("[")[0].removesuffix("_nodes")
        if owner in self.document.beams:
            return self.node(owner, name)
        if owner in self.document.nodes:
            return self.system.nodes[owner]
        if mesh in self.document.meshes:
            return self.node_of_mesh(mesh, reference)
        body = self.body(owner)
        if not name:
            return body
        if kind is BodyElement:
            raise ModelError(f"expected a body, got the point {reference!r}; write {owner!r}")
        frame = kind is Frame
        targets, noun = (body.frames, "frame") if frame else (body.places, "point")
        if name == "center" and name not in targets and not frame:
            return body
        if name not in targets:
            candidates = [f"{owner}.{p}" for p in (*(() if frame else ("center",)), *targets)]
            listing = f"{listed(candidates)}{'' if targets else f'; name others in its {noun}s'}"
            known = f"; {noun}s of {owner}: {listing}"
            raise ModelError(
                misspelt(f"unknown {noun} {reference!r}", reference, candidates, known)
            )
        return targets[name]

    def _from_table(self, kind: type, table: Any) -> Any:
        """The point or frame that a table describes."""
        if kind is BodyElement:
            raise ModelError(f"expected the name of a body, e.g. {table.body!r}; got a point")
        body = self.body(table.body)
        if kind is Frame and isinstance(table, FrameTable):
            return body.frame(**read_frame(table, self.formulas))
        if len(table.at) < body.dimension:
            raise ModelError(
                f"{table.body} is a body in space, and elements of the plane tie bodies of the "
                f"plane; take one of space, got a point of {len(table.at)} coordinates"
            )
        return body.point(*(self.formulas.read(x) for x in table.at))
