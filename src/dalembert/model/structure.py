"""The mutable, validating builder of a structure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dalembert.model.assembled.model import StructuralModel
from dalembert.model.meshes.mesh import Classes, Mesh, add_mesh
from dalembert.model.supports_and_loads import StructureDescription
from dalembert.text.arguments import CheckedArguments


class Structure(CheckedArguments, StructureDescription):
    """A structure under construction: nodes, elements between them, supports and loads.

    Every number may be a formula of parameters.

    Parameters
    ----------
    name : str
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

    def __init__(self, name: str, description: str = ""):
        super().__init__(name, description)
        self.meshes: dict[str, Mesh] = {}

    if not TYPE_CHECKING:

        def __getattr__(self, name: str):
            raise AttributeError(
                f"{type(self).__name__} {vars(self).get('name', '')!r} has no {name!r}; analyses "
                "use the model returned by its build()"
            )

    def add_mesh(self, name: str, mesh: Any, element: Classes = None, **quantities: Any) -> Mesh:
        """Add the nodes and elements of a mesh.

        Nodes are called ``name_nodes[k]``, elements ``name[k]`` (``name_shape[k]`` where cells of
        several shapes become elements). Points in the plane ``z = 0`` get two coordinates; points
        without elements are omitted; cells of lower dimension, such as the edges of an area, only
        serve as groups of nodes.

        Parameters
        ----------
        name : of the mesh
        mesh : meshio.Mesh, path of a file that meshio reads, or ``(points, cells)`` with cells an
            array (cells, nodes) or a table of such arrays by shape
        element : class of the elements, or a table of classes by shape; by default chosen by shape
            and dimension, except for lines
        **quantities : of the elements: a number or formula for all, an array with one per element,
            or a table with one per group of elements; options

        Raises
        ------
        ModelError, FileError, UnsupportedError
            Not a mesh, an element that does not fit its cells, meshio missing.
        """
        self.meshes[name] = add_mesh(self, name, mesh, element, quantities)
        return self.meshes[name]

    def build(self) -> StructuralModel:
        """Check the structure and build the frozen model.

        Raises
        ------
        ModelError
            A wrong number, an unconnected node, a load on a support, …
        """
        return StructuralModel(self)
