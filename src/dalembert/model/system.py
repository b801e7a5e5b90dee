"""Builder of mechanism models, with validation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeVar

from dalembert.elements.base import Constraint, Element, ForceElement
from dalembert.errors import ModelError
from dalembert.model.checks import ValueChecks, check_membership, check_symbols
from dalembert.model.description import Description
from dalembert.model.elastic_structure import ElasticStructure
from dalembert.model.meshes.mesh import Classes
from dalembert.model.model import Model
from dalembert.model.nodal_conditions import Nodes, loads, supports
from dalembert.model.structure import Structure
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.declared import VARIABLES, Declared, check_free
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.parameter import coherent
from dalembert.text.arguments import CheckedArguments, check_arguments

E = TypeVar("E", bound=Element)

ELEMENT_MEANINGS = {"ground": "the body at rest"}
"""Reserved names of elements, with their meaning."""


class System(CheckedArguments, Declared, Description):
    """A mechanism under construction.

    Parameters
    ----------
    name : str
    gravity : (2,) or, in space, (3,) acceleration of gravity [m/s²]; none by default
    description : str

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -9.81))
    >>> bob = system.add(planar.Bar("bob", length="800 mm", mass=2.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, bob.start))
    >>> system.build().diagnosis.degrees_of_freedom
    1
    """

    meanings = VARIABLES

    if not TYPE_CHECKING:

        def __getattr__(self, name: str):
            raise AttributeError(
                f"{type(self).__name__} {vars(self).get('name', '')!r} has no {name!r}; analyses "
                "take the model returned by its build()"
            )

    # building ----------------------------------------------------------------
    @check_arguments
    def derived(self, name: str, formula, unit: str = "", description: str = "") -> Expression:
        """Name a formula of parameters; it is listed with the parameters.

        Without a ``unit`` it has the unit of the formula, if that is known.
        """
        self._declare(name)
        expression = as_expression(formula, name, coherent(unit, name) if unit else None)
        if not unit:
            expression.unit = getattr(formula, "unit", "")
        expression.name = name
        self.derived_parameters[name] = expression
        return expression

    def add(self, element: E) -> E:
        """Add a body, joint, driver or force; returns it."""
        if not isinstance(element, Element):
            raise ModelError(f"add() takes an element, got {element!r}", self.name)
        if element.name in self.elements:
            raise ModelError(
                "the name is already used by another element; choose a different one", element.name
            )
        self._claim(element.name)
        self.elements[element.name] = element
        return element

    def add_mesh(
        self,
        name: str,
        mesh: Any,
        element: Classes = None,
        *,
        velocity: Any = None,
        angular_velocity: Any = None,
        **quantities: Any,
    ) -> ElasticStructure:
        """Add a mesh of finite elements, every node of which is a body.

        For few elements, as all of them are part of the equations; use a ``FlexibleBody`` for a
        fine mesh.

        Parameters
        ----------
        mesh, element, **quantities : as in ``Structure.add_mesh``
        velocity, angular_velocity : of the whole mesh at the start [m/s], [rad/s]

        Raises
        ------
        ModelError, FileError, UnsupportedError
            No mesh, an element that does not fit its cells, meshio missing.
        """
        structure = Structure(name)
        structure.add_mesh("mesh", mesh, element, **quantities)
        elastic = ElasticStructure(
            name, structure=structure, velocity=velocity, angular_velocity=angular_velocity
        )
        return self.add(elastic)

    def support(self, nodes: Nodes, **displacements: Any) -> list[Constraint]:
        """Prescribe displacements of nodes, e.g. ``ux=0, uy=0.01`` [m], ``rz=0`` [rad].

        By default all are zero. A value, which may be a formula of parameters and time, holds for
        each of the nodes. Zero displacements are a pin or a clamp, others drivers.

        Raises
        ------
        ModelError
            No node, or an unknown direction.
        """
        return [self.add(constraint) for constraint in supports(self.ground, nodes, displacements)]

    def load(self, nodes: Nodes, **forces: Any) -> list[ForceElement]:
        """Apply forces to each of the nodes, e.g. ``fx=10, fy=-3`` [N], ``mz=2`` [N m].

        Raises
        ------
        ModelError
            No node, no load, or an unknown direction.
        """
        return [self.add(force) for force in loads(nodes, forces, len(self.elements))]

    @check_arguments
    def initial(self, measure: Expression, value) -> None:
        """Prescribe a position-level measure, or a speed, at the start, exactly.

        Unlike the initial poses of bodies, assembly never changes it.
        """
        self.initial_conditions.append(
            (
                as_expression(measure, "initial condition", getattr(measure, "unit", "")),
                as_expression(value, "initial value"),
            )
        )

    def _claim(self, name: str) -> None:
        check_free(name, ELEMENT_MEANINGS, self.name, "mechanisms")
        super()._claim(name)

    @property
    def _values(self) -> tuple[Mapping[str, Any], ...]:
        return self.parameters, self.derived_parameters, self.tables

    @property
    def _parts(self) -> tuple[Mapping[str, Any], ...]:
        return (self.elements,)

    # freezing ------------------------------------------------------------------
    @check_arguments
    def build(self, strict: bool = False) -> Model:
        """Check, assemble and freeze.

        Parameters
        ----------
        strict : refuse inconsistent initial speeds instead of projecting them

        Raises
        ------
        ModelError
            An invalid number, a joint of a missing body, an over-driven mechanism, …
        AssemblyError
            The joints cannot be closed; names the worst one and its residual.
        """
        check_membership(self)
        check_symbols(self)
        ValueChecks(self)([p.value for p in self.parameters.values()])
        return Model.assembled(self.copy(), strict)
