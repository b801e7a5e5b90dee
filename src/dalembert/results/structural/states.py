"""States of a structure (load cases, modes, instants) and their fields."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from dalembert.elements.fem.node import Node
from dalembert.elements.fem.node_set import Nodes
from dalembert.errors import AnalysisError
from dalembert.model.assembled.measuring.measures import State
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.meshes.mesh import Mesh
from dalembert.results.result import Result


class StructuralStates(Result):
    """States of a structure: load cases, modes or instants.

    Attributes
    ----------
    cases : names of the states
    displacements, forces : (n, states)
    """

    model: StructuralModel
    cases: list[str]
    displacements: np.ndarray
    forces: np.ndarray

    kind_of_state: ClassVar[str] = "load case"
    """Name of a state in texts."""
    totals: ClassVar[tuple[str, ...]] = ("mass", "compliance", "strain_energy")
    """Measures of the whole structure in summaries."""
    in_sequence: ClassVar[bool] = False
    """Whether the states are consecutive, such as instants."""
    of_any_size: ClassVar[bool] = False
    """Whether the displacements have no absolute scale, such as those of modes."""

    @property
    def state_names(self) -> list[str]:
        """Names of the states in pictures and reports."""
        return [str(name) if name != "" else "load" for name in self.cases]

    @property
    def large(self) -> bool:
        """Whether displacements and rotations are finite."""
        return not (self.model.linear or self.of_any_size)

    def state(self, case: int) -> State:
        """Displacements and forces of one case."""
        raise NotImplementedError

    def case(self, name: str | int) -> int:
        """Index of a load case from its name or number.

        Raises
        ------
        AnalysisError
            Unknown load case.
        """
        if isinstance(name, str) and name in self.cases:
            return self.cases.index(name)
        count = len(self.cases)
        if isinstance(name, str) or not -count <= name < count:
            names = ", ".join(repr(c) for c in self.cases)
            raise AnalysisError(f"no load case {name!r}; known: {names}")
        return range(count)[name]

    def field(self, name: str, case: str | int = 0) -> np.ndarray:
        """A quantity of every element of a set, e.g. ``"plate.von_mises"``.

        Parameters
        ----------
        name : set of elements (or one element) and quantity
        case : load case, by name or number

        Returns
        -------
        (elements,)

        Raises
        ------
        AnalysisError
            Unknown set or quantity (suggests the nearest ones), or unknown case.
        """
        from dalembert.results.structural.fields import set_field

        return set_field(self.model, self.state(self.case(case)), name)

    def displacement_of(self, nodes: Node | Nodes | Mesh, case: str | int = 0) -> np.ndarray:
        """Displacements of several nodes.

        Parameters
        ----------
        nodes : a node, a set or selection of nodes, or a mesh
        case : load case, by name or number

        Returns
        -------
        (nodes, d) [m]
        """
        selected = nodes.nodes() if isinstance(nodes, Mesh) else nodes
        degrees = self.model.degrees
        if isinstance(selected, Nodes):
            numbers = degrees.of_set(selected)
        else:
            numbers = np.array([degrees.nodes.first(selected.name)])
        table = degrees.table[numbers, : degrees.dimension]
        return self.displacements[table, self.case(case)]

    def applied(self, number: int) -> np.ndarray:
        """(n,) applied forces of a state, without reactions of supports."""
        forces = self.forces[:, number].copy()
        forces[self.model.assembly.prescribed] = 0.0
        return forces
