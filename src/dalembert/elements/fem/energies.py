"""Contract of a finite element: its energies and the measures of its displacements."""

from __future__ import annotations

from typing import ClassVar

import casadi as ca
import numpy as np

from dalembert.elements.base import Element
from dalembert.elements.look import Bars, Beams, Cells, Diagram, Dots, Faces, SolidFaces

Rows = tuple[tuple[float, ...], ...]
Named = dict[str, tuple[ca.SX, str]]
CHANGES = (
    "temperature",
    "temperature_gradient",
    "temperature_gradient_y",
    "temperature_gradient_z",
)
"""Element quantities that are temperature changes; forces are linear in them."""


class Energies(Element):
    """A kind of finite element: formulas of displacements ``u`` and positions ``x`` of its nodes.

    An element with numerical integration states ``samples``; its energy is then the sum of
    ``energy`` over the samples, which are passed in ``q["at"]``.
    """

    turns: ClassVar[bool] = False
    """Whether its nodes have rotations."""
    counts_turns: ClassVar[bool] = False
    """Whether full revolutions of a node change its energy."""
    floats: ClassVar[bool] = False
    """Whether it depends only on differences of displacements of its nodes."""
    node_count: ClassVar[int]
    """Number of nodes of one element."""
    dimensions: ClassVar[tuple[int, ...]] = (1, 2, 3)
    """Dimensions of the structures it exists in."""
    contractible: ClassVar[bool] = False
    """Whether the energy is a ``volume · energy_density`` of the displacement gradient."""
    samples: ClassVar[Rows] = ((),)
    """Values of ``q["at"]`` over which ``energy`` is summed."""
    kinetic_samples: ClassVar[Rows] = ((),)
    """Values of ``q["at"]`` over which ``kinetic`` is summed."""
    stations: ClassVar[dict[str, tuple[float, ...]]] = {"": ()}
    """Suffix of the names of measures → value of ``q["at"]`` at which they are evaluated."""

    diagrams: ClassVar[dict[str, Diagram]] = {}
    """Diagrams of section forces of a line."""

    @classmethod
    def look_of(cls, nodes: np.ndarray, elements: np.ndarray) -> list[Cells]:
        """Primitives of the elements of a structure.

        Parameters
        ----------
        nodes : (m, node_count) numbers of their nodes
        elements : (m,) their numbers
        """
        rings = cls.outlines()
        kinds: dict[int, type[Cells]] = {1: Dots, 2: Beams if cls.turns else Bars}
        kind = kinds.get(cls.node_count, Faces if len(rings) == 1 else SolidFaces)
        return [kind(nodes[:, list(ring)], elements) for ring in rings]

    @classmethod
    def energy(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """Strain energy ``W`` [J].

        Parameters
        ----------
        u : displacements of the nodes followed by rotations: an angle in the plane; in space the
            argument of ``rotations.turn_of`` and ``rotations.vector_of``
        x : positions of the nodes
        q : quantities of the element by field name, its options, and the sample ``at``
        """
        return cls.energy_of(cls.strains(u, x, q), x, q)

    @classmethod
    def strains(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """(n,) generalised strains, in which the energy is a quadratic form."""
        return ca.SX(0, 1)

    @classmethod
    def energy_of(cls, strains: ca.SX, x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """Strain energy ``W`` of generalised strains [J]; their stresses are ``∂W/∂ε``."""
        return ca.SX(0)

    @classmethod
    def virtual_work(
        cls, u: list[ca.SX], w: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]
    ) -> ca.SX:
        """Virtual work [J] of forces not included in ``energy`` on the displacements ``w``.

        It is that of internal forces, linear in ``w``; external forces are negative. Their
        stiffness need not be symmetric.
        """
        return ca.SX(0)

    @classmethod
    def kinetic(cls, v: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """Kinetic energy [J] of the element in its initial position.

        A quadratic form in the velocities ``v`` of the nodes; its matrix is the mass matrix.
        """
        return ca.SX(0)

    @classmethod
    def thermal(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """Strain energy [J] added by a change of temperature: the thermal stress on the strain.

        It is linear in the strains, so that a fraction of the change causes that fraction of the
        forces.
        """
        return ca.SX(0)

    @classmethod
    def own_axes(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX | None:
        """(d, d) axes of the displaced element with which its inertia rotates, as columns.

        None for isotropic inertia.
        """
        return None

    @classmethod
    def kinetic_in_axes(cls, v: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """Kinetic energy of velocities in ``own_axes``."""
        return cls.kinetic(v, x, q)

    @classmethod
    def mass_center(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX | None:
        """Mass centre of the displaced element; None if it is that of masses at the nodes.

        Its derivative in the initial position, times the mass, is the momentum of ``kinetic``.
        """
        return None

    @classmethod
    def recovered(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> Named:
        """Measures of the displaced element: name → (expression, unit).

        For small displacements they are linearised.
        """
        return {}

    @classmethod
    def derived(cls, measured: dict[str, ca.SX], q: dict[str, ca.SX]) -> Named:
        """Nonlinear measures computed from ``recovered``."""
        return {}

    @classmethod
    def checks(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> list[tuple[ca.SX, str]]:
        """(expression that must be positive at every sample, message if it is not)."""
        return []

    @classmethod
    def outlines(cls) -> tuple[tuple[int, ...], ...]:
        """Its faces as rings of nodes; a line is its own."""
        return (tuple(range(cls.node_count)),)
