"""Solid continuum elements: tetrahedra and hexahedra."""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.elements.fem.continuum import Continuum


@dataclass(eq=False)
class Tetrahedron(Continuum, cell="tetra"):
    """Tetrahedron of 4 nodes with constant strain.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> tip = da.Structure("corner")
    >>> places = (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)
    >>> corners = [tip.node(f"n{k}", *place) for k, place in enumerate(places)]
    >>> steel = dict(modulus=2e11, poisson=0.0, density=7850.0)
    >>> part = tip.add(structures.Tetrahedron("part", corners, **steel))
    >>> for corner, pull in zip(corners, (0, 1e-4, 0, 0)):
    ...     tip.support(corner, ux=pull, uy=0, uz=0)
    >>> result = da.solve_statics(tip.build())
    >>> round(result["part.sxx"] / 1e6, 6), round(result["mass"] * 6, 6)  # E ε [MPa], ρ
    (20.0, 7850.0)
    """


@dataclass(eq=False)
class Tetrahedron10(Continuum, cell="tetra10"):
    """Tetrahedron of 10 nodes with linear strain; its edges may be curved.

    Examples
    --------
    >>> import numpy as np
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> part = da.Structure("part")
    >>> ends = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
    >>> edges = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    >>> places = [*ends, *((ends[i] + ends[j]) / 2 for i, j in edges)]
    >>> nodes = [part.node(f"n{k}", *map(float, place)) for k, place in enumerate(places)]
    >>> cell = structures.Tetrahedron10("cell", nodes, modulus=2e11, poisson=0.0)
    >>> element = part.add(cell)
    >>> for node, (x, _, _) in zip(nodes, places):
    ...     part.support(node, ux=1e-4 * x**2, uy=0, uz=0)
    >>> round(da.solve_statics(part.build())["cell.sxx_n1"] / 1e6, 6)  # E du/dx at x = 1
    40.0
    """


@dataclass(eq=False)
class Hexahedron(Continuum, cell="hexahedron"):
    """Trilinear hexahedron of 8 nodes, integrated at 2 × 2 × 2 points.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> bar = da.Structure("bar")
    >>> points, cells = structures.box_mesh((2, 1, 1), (2, 1, 1))
    >>> nodes = bar.add_nodes("n", points)
    >>> steel = dict(modulus=2e11, poisson=0.0)
    >>> cubes = bar.add_elements("cubes", structures.Hexahedron, nodes, cells, **steel)
    >>> bar.support(nodes.where(x=0))
    >>> bar.traction(cubes, nodes.where(x=2), tx=1e6)
    >>> result = da.solve_statics(bar.build())
    >>> round(result["cubes[1].sxx"], 3), round(result["n[2].ux"] * 1e6, 6)  # σ, σ L/E [µm]
    (1000000.0, 10.0)
    """


@dataclass(eq=False)
class Hexahedron20(Continuum, cell="hexahedron20"):
    """Quadratic hexahedron of 20 nodes, integrated at 3 × 3 × 3 points; its edges may be curved.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> arm = da.Structure("cantilever")
    >>> points, cells = structures.box_mesh((10, 1, 1), (5, 1, 1), "hexahedron20")
    >>> nodes, rubber = arm.add_nodes("n", points), dict(modulus=1e6, poisson=0.0)
    >>> bricks = arm.add_elements("b", structures.Hexahedron20, nodes, cells, **rubber)
    >>> arm.support(nodes.where(x=0))
    >>> arm.traction(bricks, nodes.where(x=10), ty=0.25)
    >>> result = da.solve_statics(arm.build())
    >>> round(result["n[5].uy"] * 3 * 1e6 / 12 / (0.25 * 10**3), 2)  # of F L³/(3 E I)
    1.0
    """
