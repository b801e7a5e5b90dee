"""Builder of structures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from dalembert.elements.fem.base import StructuralElement
from dalembert.errors import ModelError
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.parts import E
from dalembert.model.system import System
from dalembert.symbolic.formulas.declared import CONSTANTS, declared


class Structure(System):
    """A system of nodes and finite elements between them, with supports and loads.

    Parameters
    ----------
    name : str
    gravity : (2,) or, in space, (3,) acceleration of gravity [m/s²], a load of the unnamed load
        case; other cases and one coordinate by the method ``gravity``
    description : str

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> rope = da.Structure("rope")
    >>> length = rope.parameter("length", 2.0, unit="m")
    >>> top, end = rope.node("top", 0, 0), rope.node("end", 0, -length)
    >>> line = rope.add(structures.Truss("line", top, end, area=1e-4, modulus=1e9))
    >>> rope.support(top)
    >>> rope.support(end, ux=0)
    >>> rope.load(end, fy=-500.0)
    >>> result = da.solve_statics(rope.build(), parameters={"length": 3.0})
    >>> round(result["end.uy"], 9)  # -F L/(E A)
    -0.015
    """

    meanings = CONSTANTS
    reserved: ClassVar[Mapping[str, str]] = {}

    def add(self, element: E) -> E:
        """Add a finite element; returns it."""
        if not isinstance(element, StructuralElement):
            raise ModelError(
                f"add() takes a structural element, got {element!r}; a System takes others, too",
                self.name,
            )
        return super().add(element)

    def lookup(self, name: str) -> Any:
        """The parameter, table or time of a name in a formula; None if unknown."""
        return declared(self, name)

    def measure_names(self) -> list[str]:
        """Empty: measures exist in the built model."""
        return []

    def build(self) -> StructuralModel:  # type: ignore[override]
        """Check the structure and build the frozen model.

        Raises
        ------
        ModelError
            A wrong number, an unconnected node, a load on a support, …
        """
        return StructuralModel(self)
