"""Solid continuum: tetrahedra and hexahedra."""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.elements.fem.continuum import Continuum


@dataclass(eq=False)
class Tetrahedron(Continuum, cell="tetra"):
    """Tetrahedron of 4 nodes with constant strain."""


@dataclass(eq=False)
class Tetrahedron10(Continuum, cell="tetra10"):
    """Tetrahedron of 10 nodes with linear strain; its edges may be curved."""


@dataclass(eq=False)
class Hexahedron(Continuum, cell="hexahedron"):
    """Trilinear hexahedron of 8 nodes, integrated at 2 × 2 × 2 points."""


@dataclass(eq=False)
class Hexahedron20(Continuum, cell="hexahedron20"):
    """Quadratic hexahedron of 20 nodes, integrated at 3 × 3 × 3 points; its edges may be curved."""
