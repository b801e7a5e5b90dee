"""What one finite element states: its energies, and what is recovered from its displacements."""

from __future__ import annotations

from typing import ClassVar

import casadi as ca

from dalembert.elements.base import Element

Rows = tuple[tuple[float, ...], ...]
Named = dict[str, tuple[ca.SX, str]]


class Energies(Element):
    """A kind of finite element, as formulas of displacements ``u`` and places ``x`` of its nodes.

    An element that is integrated numerically gives ``samples``; its energy is then the sum over
    them of ``energy``, which finds the sample in ``q["at"]``.
    """

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

    @classmethod
    def energy(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """Strain energy ``W`` [J].

        Parameters
        ----------
        u : displacements of the nodes, behind them rotations: an angle in the plane; in space what
            ``rotations.turn_of`` and ``rotations.vector_of`` read
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
    def own_axes(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX | None:
        """(d, d) by columns, axes of the displaced element that its inertia turns with.

        None where inertia is the same in all directions.
        """
        return None

    @classmethod
    def kinetic_seen(cls, v: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """Kinetic energy of velocities that are given in ``own_axes``."""
        return cls.kinetic(v, x, q)

    @classmethod
    def recovered(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> Named:
        """Named quantities of the displaced element: name → (expression, unit).

        For small displacements they are taken to the first order.
        """
        return {}

    @classmethod
    def derived(cls, measured: dict[str, ca.SX], q: dict[str, ca.SX]) -> Named:
        """Quantities that follow from ``recovered`` by formulas of any kind."""
        return {}

    @classmethod
    def checks(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> list[tuple[ca.SX, str]]:
        """(expression that must be positive at every sample, what is wrong if it is not)."""
        return []

    @classmethod
    def outlines(cls) -> tuple[tuple[int, ...], ...]:
        """Its faces, node by node around each; of a line itself."""
        return (tuple(range(cls.node_count)),)
