"""Builder of models, with validation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.between_bodies import NodeBody
from dalembert.elements.fem.element_set import Elements
from dalembert.errors import ModelError
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.copies import Copied, include
from dalembert.model.graph.checks import check_membership, check_symbols, value_checks
from dalembert.model.graph.description import Description, gravity_field
from dalembert.model.graph.model import Model
from dalembert.model.graph.parts import MechanismParts
from dalembert.model.load_records import Weight
from dalembert.model.supports_and_loads import SupportsAndLoads
from dalembert.symbolic.formulas.declared import VARIABLES
from dalembert.text.arguments import CheckedArguments, check_arguments


class System(CheckedArguments, SupportsAndLoads, MechanismParts):
    """A mechanism or structure under construction.

    Bodies, joints, drivers and forces, nodes and finite elements, supports and loads; every number
    may be a formula of parameters.

    Parameters
    ----------
    name : str
    gravity : (2,) or, in space, (3,) acceleration of gravity [m/s²]; none by default
    description : str

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar, structures
    >>> system = da.System("pendulum", gravity=(0, -9.81))
    >>> bob = system.add(planar.Bar("bob", length="800 mm", mass=2.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, bob.start))
    >>> system.build().diagnosis.degrees_of_freedom
    1

    A rope between the bar and a fixed node:

    >>> low, hook = system.node("low", 0.8, 0), system.node("hook", 0.8, 1)
    >>> rope = system.add(structures.Truss("rope", low, hook, area=1e-6, modulus=1e9))
    >>> joint = system.add(planar.Revolute("A", bob.end, low))
    >>> system.support(hook)
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["rope.force"].item(), 1)  # half of the weight
    9.8
    """

    meanings = VARIABLES

    def __init__(self, name: str, gravity: Any = None, description: str = ""):
        super().__init__(name, description)
        if gravity is not None:
            self.spread[""] = [Weight(gravity_field(gravity))]

    if not TYPE_CHECKING:

        def __getattr__(self, name: str):
            raise AttributeError(
                f"{type(self).__name__} {vars(self).get('name', '')!r} has no {name!r}; analyses "
                "take the model returned by its build()"
            )

    def __setattr__(self, name: str, value: Any) -> None:
        """Set an attribute; methods such as ``gravity`` are called, not set.

        Raises
        ------
        ModelError
            The name is that of a method.
        """
        if callable(getattr(type(self), name, None)):
            raise ModelError(f"{name} is a method: call {name}(…) instead of setting it", "system")
        super().__setattr__(name, value)

    def include(
        self, name: str, source: System, *, velocity: Any = None, angular_velocity: Any = None
    ) -> Copied:
        """Add copies of the nodes and finite elements of another system.

        Their names are ``name_original``.

        Parameters
        ----------
        name : of the copy
        source : without supports, loads and parameters; formulas use parameters of this system
        velocity, angular_velocity : of the copy at the start of a mechanism's motion, the latter
            about the origin [m/s], [rad/s]

        Raises
        ------
        ModelError
            The source has other parts.

        Examples
        --------
        >>> import dalembert as da
        >>> from dalembert import planar, structures
        >>> rod = da.Structure("rod")
        >>> a, b = rod.node("a", 0, 0), rod.node("b", 1, 0)
        >>> steel = dict(area=1e-4, modulus=2e11, density=7850.0)
        >>> element = rod.add(structures.Truss("bar", a, b, **steel))
        >>> system = da.System("thrown rod and stone", gravity=(0, -9.81))
        >>> thrown = system.include("rod", rod, velocity=(2.0, 0.0))
        >>> stone = system.add(planar.Particle("stone", mass=1.0))
        >>> motion = da.solve_dynamics(system.build(), 1e-4, step=1e-5)
        >>> round(motion["kinetic_energy"][0].item(), 6)  # m v²/2
        1.57
        """
        return include(self, name, source, velocity, angular_velocity)

    @property
    def is_mechanism(self) -> bool:
        """Whether it has bodies, joints or other forces, or nodes that move at the start."""
        moving = any(map(_moves, self.elements.values()))
        moving |= any(nodes.motion is not None for nodes in self.nodes.values())
        return moving or bool(self.initial_conditions) or not self.nodes

    @check_arguments
    def build(self, strict: bool = False) -> Model:
        """Check and freeze.

        Nodes, finite elements, supports and loads alone become a ``StructuralModel``, which sums
        over many alike elements. With bodies, joints or other forces the system becomes a
        ``Model``, the equations of a mechanism, in which nodes are bodies.

        Parameters
        ----------
        strict : refuse inconsistent initial speeds of a mechanism instead of projecting them

        Raises
        ------
        ModelError
            An invalid number, a joint of a missing body, an over-driven mechanism, an unconnected
            node, a load case of a mechanism, …
        AssemblyError
            The joints cannot be closed; names the worst one and its residual.
        """
        if not self.is_mechanism:
            return StructuralModel(self)  # type: ignore[return-value]  # Model is the usual type
        parts = Description(self)
        check_membership(parts)
        check_symbols(parts)
        value_checks(parts)([p.value for p in self.parameters.values()])
        model = Model.assembled(parts, strict)
        model.outputs  # noqa: B018  refuses unknown names
        return model


def _moves(element: Any) -> bool:
    """Whether an element is no finite element between nodes."""
    if isinstance(element, StructuralElement):
        return any(isinstance(node, NodeBody) for node in element.nodes())
    return not isinstance(element, Elements)
