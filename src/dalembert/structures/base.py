"""What a structural element is.

To write a new one: a dataclass with ``name`` first, then its nodes, then its numbers as
``quantity``; and one class method ``energy``, the strain energy of the displaced element, with
``kinetic`` beside it if it has mass. Internal forces ``∂W/∂u``, tangent stiffness ``∂²W/∂u²``, mass
matrix and all design derivatives follow by differentiation, once per kind of element, and are
evaluated for all elements of the kind at once. Where the inertia turns with the element,
``carried`` says how: inertia forces ``d/dt ∂T/∂v − ∂T/∂u`` follow from the same kinetic energy.

An element that is integrated numerically gives ``samples``; its energy is then the sum over them of
``energy``, which finds the sample in ``q["at"]``.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, ClassVar

import casadi as ca

from dalembert.elements.base import Element
from dalembert.errors import ModelError
from dalembert.structures.node import Node
from dalembert.symbolic.expression import as_expression

Rows = tuple[tuple[float, ...], ...]
Named = dict[str, tuple[ca.SX, str]]


@dataclass(eq=False)
class StructuralElement(Element):
    """An element between nodes."""

    turns: ClassVar[bool] = False
    """Whether its nodes have rotations too."""
    counts_turns: ClassVar[bool] = False
    """Whether it tells a node that turned once round from one that did not."""
    floats: ClassVar[bool] = False
    """Whether displacements count only as differences between its nodes."""
    node_count: ClassVar[int]
    """Nodes of one element."""
    dimensions: ClassVar[tuple[int, ...]] = (1, 2, 3)
    """Spaces it exists in."""
    contractible: ClassVar[bool] = False
    """Whether the energy is a ``volume · energy_density`` of the displacement gradient."""
    samples: ClassVar[Rows] = ((),)
    """Values of ``q["at"]`` over which ``energy`` is summed."""
    kinetic_samples: ClassVar[Rows] = ((),)
    """The same for ``kinetic``."""
    stations: ClassVar[dict[str, tuple[float, ...]]] = {"": ()}
    """Values of ``q["at"]`` where measures are taken, by what is added to their names."""

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, meta in self.quantities():
            as_expression(getattr(self, name), f"{self.name}.{name}", meta["unit"], meta["size"])
        check_options(self.name, self.options())

    def options(self) -> dict[str, bool]:
        """Switches, which make elements of one class different kinds."""
        fields = (f for f in dataclasses.fields(self) if f.metadata.get("kind") == "option")
        return {f.name: getattr(self, f.name) for f in fields}

    @classmethod
    def default_options(cls) -> dict[str, Any]:
        """The switches and where they stand."""
        fields = (f for f in dataclasses.fields(cls) if f.metadata.get("kind") == "option")
        return {f.name: f.default for f in fields}

    def nodes(self) -> tuple[Node, ...]:
        """The nodes it ties together."""
        raise NotImplementedError

    @classmethod
    def energy(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """Strain energy ``W`` [J].

        Parameters
        ----------
        u : displacements (and rotations) of the nodes
        x : positions of the nodes
        q : quantities of the element by field name, its options, and the sample ``at``
        """
        raise NotImplementedError

    @classmethod
    def virtual_work(
        cls, u: list[ca.SX], w: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]
    ) -> ca.SX:
        """Virtual work [J] on the displacements ``w`` that ``energy`` does not tell.

        That of internal forces, linear in ``w``; what acts from outside counts negative. Their
        stiffness need not be symmetric.
        """
        return ca.SX(0)

    @classmethod
    def kinetic(cls, v: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """Kinetic energy [J] of the element in its initial place.

        A quadratic form in the velocities ``v`` of the nodes; its matrix is the mass matrix.
        """
        return ca.SX(0)

    @classmethod
    def thermal(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """What a change of temperature adds to the strain energy [J]: its stress on the strain.

        Linear in the displacements' strains, so that a part of the change has that part of the
        forces.
        """
        return ca.SX(0)

    @classmethod
    def carried(
        cls, u: list[ca.SX], v: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]
    ) -> list[ca.SX]:
        """Velocities of the nodes as seen from the displaced element, in its initial axes.

        ``kinetic`` of them is the kinetic energy of the displaced element; of elements whose
        inertia is the same in all directions they are the velocities ``v`` themselves.
        """
        return v

    @classmethod
    def measures(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> Named:
        """Named quantities of the displaced element: name → (expression, unit).

        For small displacements they are taken to the first order.
        """
        return {}

    @classmethod
    def derived(cls, measured: dict[str, ca.SX], q: dict[str, ca.SX]) -> Named:
        """Quantities that follow from ``measures`` by formulas of any kind."""
        return {}

    @classmethod
    def checks(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> list[tuple[ca.SX, str]]:
        """(expression that must be positive at every sample, what is wrong if it is not)."""
        return []


def check_options(entity: str, options: dict[str, Any]) -> None:
    """Switches must be true or false.

    Raises
    ------
    ModelError
        One is something else.
    """
    for name, value in options.items():
        if not isinstance(value, bool):
            raise ModelError(f"must be True or False; got {value!r}", f"{entity}.{name}")
