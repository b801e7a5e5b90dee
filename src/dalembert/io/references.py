"""Names of bodies, points and joints in a file → the objects behind them."""

from __future__ import annotations

from typing import Any

from dalembert.elements.planar.body import Body, Point
from dalembert.errors import ModelError
from dalembert.io.formulas import Formulas
from dalembert.io.messages import nearest
from dalembert.io.schema import Document
from dalembert.io.tables import InlinePoint
from dalembert.model.system import System


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

    def body(self, name: str) -> Body:
        """The body, or the ground, of this name."""
        known = ["ground", *self.document.bodies]
        if name not in known:
            raise ModelError(
                f"unknown body {name!r}{nearest(name, known)}; known: {_listed(known)}"
            )
        return self.system.body(name)

    def joint(self, name: str) -> Any:
        """The joint of this name."""
        known = list(self.document.joints)
        if name not in known:
            raise ModelError(
                f"unknown joint {name!r}{nearest(name, known)}; known: {_listed(known)}"
            )
        return self.system.elements[name]

    def end(self, kind: str, given: str | InlinePoint) -> Body | Point:
        """The body or point behind ``"crank"``, ``"crank.end"`` or an inline point.

        Raises
        ------
        ModelError
            Unknown names, or a point where a body is needed.
        """
        if isinstance(given, InlinePoint):
            if kind == "body":
                raise ModelError(f"expected the name of a body, e.g. {given.body!r}; got a point")
            return Point(self.body(given.body), [self.formulas.read(x) for x in given.at])
        owner, _, point = given.partition(".")
        body = self.body(owner)
        if not point:
            return body
        if kind == "body":
            raise ModelError(f"expected a body, got the point {given!r}; write {owner!r}")
        if point not in body.points:
            known = [f"{owner}.{p}" for p in body.points]
            listed = _listed(known) or "none, name one in its points"
            raise ModelError(
                f"unknown point {given!r}{nearest(given, known)}; points of {owner}: {listed}"
            )
        return body.points[point]


def _listed(names: list[str]) -> str:
    return ", ".join(names[:12]) + (", …" if len(names) > 12 else "")
