"""The mutable, validating builder of a structure."""

from __future__ import annotations

from dalembert.structures.description import StructureDescription
from dalembert.structures.model import StructuralModel


class Structure(StructureDescription):
    """A structure under construction: nodes, elements between them, supports and loads.

    Every number may be a formula of parameters.

    Parameters
    ----------
    name : str
    description : str
    """

    def build(self) -> StructuralModel:
        """Check and freeze.

        Raises
        ------
        ModelError
            A wrong number, an unconnected node, a load on a support, …
        """
        return StructuralModel(self)
