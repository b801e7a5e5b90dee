"""Names of bodies, points and joints in a file → the objects behind them."""

from __future__ import annotations

from typing import Any

from dalembert.elements.body import BodyElement
from dalembert.elements.frame import Frame
from dalembert.errors import ModelError
from dalembert.io.formulas import Formulas
from dalembert.io.orientations import FrameTable, read_frame
from dalembert.io.schema import Document
from dalembert.model.system import System
from dalembert.text.wording import listed, nearest, unknown


class References:
    """Looks names up, and tells the nearest ones where there is none.

    Parameters
    ----------
    document : Document, for the names that could be meant
    system : System that has the bodies already
    formulas : reads the coordinates of inline points
    """

    def __init__(self, document: Document, system: System, formulas: Formulas):
        self.document, self.system, self.formulas = document, system, formulas

    def body(self, name: str) -> Any:
        """The body, or the ground, of this name."""
        known = ["ground", *self.document.bodies]
        if name not in known:
            raise ModelError(unknown("body", name, known))
        return self.system.body(name)

    def node(self, owner: str, name: str) -> Any:
        """The body at a node of a beam or a mesh."""
        if owner not in self.system.elements:
            raise ModelError(
                f"{owner} is not made yet; a beam begins and ends at bodies, or at beams before it"
            )
        found: Any = self.system.elements[owner]
        nodes = found.named_nodes
        if name not in nodes:
            known = [f"{owner}.{node}" for node in nodes]
            given = f"{owner}.{name}" if name else owner
            raise ModelError(
                f"unknown node {given!r}{nearest(given, known)}; nodes of {owner}: {listed(known)}"
            )
        return nodes[name]

    def joint(self, name: str) -> Any:
        """The joint of this name."""
        known = list(self.document.joints)
        if name not in known:
            raise ModelError(unknown("joint", name, known))
        return self.system.elements[name]

    def end(self, kind: type, given: Any) -> Any:
        """The body, point or frame behind ``"crank"``, ``"crank.end"`` or an inline place.

        Raises
        ------
        ModelError
            Unknown names, or a point where a body is needed.
        """
        if not isinstance(given, str):
            return self._placed(kind, given)
        owner, _, name = given.partition(".")
        if owner in self.document.beams or owner in self.document.meshes:
            return self.node(owner, name)
        body = self.body(owner)
        if not name:
            return body
        if kind is BodyElement:
            raise ModelError(f"expected a body, got the point {given!r}; write {owner!r}")
        frame = kind is Frame
        places, what = (body.frames, "frame") if frame else (body.places, "point")
        if name == "center" and name not in places and not frame:
            return body
        if name not in places:
            known = [f"{owner}.{p}" for p in (*(() if frame else ("center",)), *places)]
            told = f"{listed(known)}{'' if places else f'; name others in its {what}s'}"
            raise ModelError(
                f"unknown {what} {given!r}{nearest(given, known)}; {what}s of {owner}: {told}"
            )
        return places[name]

    def _placed(self, kind: type, given: Any) -> Any:
        """The point, or the frame, that a table describes."""
        if kind is BodyElement:
            raise ModelError(f"expected the name of a body, e.g. {given.body!r}; got a point")
        body = self.body(given.body)
        if kind is Frame and isinstance(given, FrameTable):
            return body.frame(**read_frame(given, self.formulas))
        if len(given.at) < body.dimension:
            raise ModelError(
                f"{given.body} is a body in space, and elements of the plane tie bodies of the "
                f"plane; take one of space, got a point of {len(given.at)} coordinates"
            )
        return body.point(*(self.formulas.read(x) for x in given.at))
