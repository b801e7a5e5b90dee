"""States of a structure by number: load cases, modes, instants; fields over them."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from dalembert.elements.fem.node import Node
from dalembert.errors import AnalysisError
from dalembert.results.result import Result
from dalembert.structures.measuring.measures import State
from dalembert.structures.meshes.mesh import Mesh
from dalembert.structures.model import StructuralModel
from dalembert.structures.sets import Nodes
from dalembert.symbolic.formulas.expression import Expression


class StructuralStates(Result):
    """States of a structure: under load cases, modes, instants.

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
    """What people call one of the states."""
    totals: ClassVar[tuple[str, ...]] = ("mass", "compliance", "strain_energy")
    """Measures of the whole that are told in summaries."""
    named: ClassVar[dict[str, Expression]] = {}
    """Measures that a state has as a whole, as a mode has a frequency."""
    in_sequence: ClassVar[bool] = False
    """Whether the states follow one another, as instants do."""
    of_any_size: ClassVar[bool] = False
    """Whether the displacements have no scale of their own, as those of modes."""

    @property
    def state_names(self) -> list[str]:
        """What the states are called in pictures and reports."""
        return [str(name) if name != "" else "load" for name in self.cases]

    @property
    def large(self) -> bool:
        """Whether rotations are those of large displacements."""
        return not (self.model.linear or self.of_any_size)

    def state(self, case: int) -> State:
        """Displacements and forces of one case."""
        raise NotImplementedError

    def case(self, name: str | int) -> int:
        """Number of a load case, given by its name or number.

        Raises
        ------
        AnalysisError
            There is none.
        """
        if isinstance(name, str) and name in self.cases:
            return self.cases.index(name)
        count = len(self.cases)
        if isinstance(name, str) or not -count <= name < count:
            known = ", ".join(repr(c) for c in self.cases)
            raise AnalysisError(f"no load case {name!r}; known: {known}")
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
            There is no such set or quantity, with the nearest ones; no such case.
        """
        from dalembert.results.structural.fields import set_field

        return set_field(self.model, self.state(self.case(case)), name)

    def displacement_of(self, nodes: Node | Nodes | Mesh, case: str | int = 0) -> np.ndarray:
        """Displacements of many nodes at once.

        Parameters
        ----------
        nodes : a node, a set or selection of nodes, or a mesh
        case : load case, by name or number

        Returns
        -------
        (nodes, d) [m]
        """
        chosen = nodes.nodes() if isinstance(nodes, Mesh) else nodes
        degrees = self.model.degrees
        if isinstance(chosen, Nodes):
            numbers = degrees.of_set(chosen)
        else:
            numbers = np.array([degrees.nodes.first(chosen.name)])
        table = degrees.table[numbers, : degrees.dimension]
        return self.displacements[table, self.case(case)]

    def applied(self, number: int) -> np.ndarray:
        """(n,) forces in a state without the reactions of supports."""
        found = self.forces[:, number].copy()
        found[self.model.assembly.prescribed] = 0.0
        return found
