"""Loads on elements of a model under construction: gravity, line loads, tractions, temperatures."""

from __future__ import annotations

from typing import Any

from dalembert.elements.fem.element_set import Elements
from dalembert.elements.fem.node_set import Nodes
from dalembert.errors import ModelError
from dalembert.model.load_records import (
    LineLoad,
    Spread,
    Weight,
    check_expansion,
    elements_of,
    heating,
    lines,
    tractions,
)
from dalembert.model.meshes.mesh import Mesh
from dalembert.model.nodal_conditions import NodalConditions
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression


class SupportsAndLoads(NodalConditions):
    """Parts with conditions of nodes and loads on elements.

    Parameters
    ----------
    name : str
    description : str

    Attributes
    ----------
    spread : load case → distributed loads
    temperatures : load case → element → quantity → change
    """

    def __init__(self, name: str, description: str = ""):
        super().__init__(name, description)
        self.spread: dict[str, list[Spread]] = {}
        self.temperatures: dict[str, dict[str, dict[str, Any]]] = {}

    def gravity(self, *acceleration, case: str = "") -> None:
        """Load the masses of all elements by gravity, e.g. ``gravity(0, -9.81)`` [m/s²].

        Raises
        ------
        ModelError
            Not one number per dimension.
        """
        counts = (self.dimension,) if self.nodes else (1, 2, 3)
        if len(acceleration) not in counts:
            raise ModelError(
                f"needs {' or '.join(map(str, counts))} numbers, got {len(acceleration)}", "gravity"
            )
        field = tuple(as_expression(a, "gravity", "m/s^2") for a in acceleration)
        self.spread.setdefault(case, []).append(Weight(field))

    def line_load(self, parts, case: str = "", qx=0.0, qy=0.0, qz=0.0) -> None:
        """Load bars and beams by forces per length [N/m], in global directions.

        Parameters
        ----------
        parts : an element, a set of elements, a mesh, or several of them
        """
        d, components = self.dimension, (qx, qy, qz)
        for axis, value in zip("xyz"[d:], components[d:], strict=True):
            if isinstance(value, Expression) or value != 0.0:
                raise ModelError(f"there is no direction {axis} in {d} dimension(s)", "line_load")
        force = tuple(as_expression(q, "line_load", "N/m") for q in components[:d])
        self.spread.setdefault(case, []).append(LineLoad(lines(_without_meshes(parts)), force))

    def heat(self, parts, case: str = "", **changes) -> None:
        """Change the temperature of elements in a load case, in addition to their own change.

        Parameters
        ----------
        parts : an element, a set of elements, a mesh, or several of them
        **changes : ``temperature`` [K]; for frames ``temperature_gradient`` [K/m], in space
            ``temperature_gradient_y`` and ``_z``; for all elements, or an array with one value each

        Raises
        ------
        ModelError
            Elements without this quantity, or a change given twice.
        """
        changes_of_case = self.temperatures.setdefault(case, {})
        heated = elements_of(_without_meshes(parts), "heat")
        for part in heated:
            if self.elements.get(part.name) is not part:
                raise ModelError("is no element of this model", part.name)
            for name, value in heating(part, changes).items():
                if name in changes_of_case.setdefault(part.name, {}):
                    raise ModelError(f"is given twice in load case {case!r}", f"{part.name}.{name}")
                changes_of_case[part.name][name] = value
        check_expansion(heated)

    def traction(self, elements: Elements | Mesh, nodes: Nodes, case: str = "", **values) -> None:
        """Load edges or faces of cells by a traction ``tx, ty, tz`` or a ``pressure`` [Pa].

        A dead load: it keeps its direction as the structure moves. Pressure pushes against the
        material.

        Parameters
        ----------
        elements : set of continuum elements, or a mesh with one
        nodes : facets with all their nodes in this set are loaded

        Raises
        ------
        ModelError
            No facet has all its nodes there, or the elements have no facets.
        """
        self._check_nodes(nodes)
        name = f"traction{sum(len(s) for s in self.spread.values()) + 1}"
        if isinstance(elements, Mesh):
            if len(elements.elements) != 1:
                names = ", ".join(elements.elements)
                raise ModelError(
                    f"has several sets; take one of its elements: {names}", elements.name
                )
            elements = next(iter(elements.elements.values()))
        load = tractions(name, elements, nodes, values)
        self.spread.setdefault(case, []).append(load)


def _without_meshes(parts: Any) -> Any:
    """The sets of elements of a mesh in place of the mesh."""
    if isinstance(parts, Mesh):
        return list(parts.elements.values())
    if isinstance(parts, (list, tuple)) and any(isinstance(part, Mesh) for part in parts):
        return [e for p in parts for e in (p.elements.values() if isinstance(p, Mesh) else (p,))]
    return parts
