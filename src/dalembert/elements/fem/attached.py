"""Elements at one node: springs to the ground, masses and inertias."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.energies import Named
from dalembert.elements.fem.nodal import Nodal, turn_of, vector_of
from dalembert.errors import ModelError

AXES = ("x", "y", "z")


@dataclass(eq=False)
class Attached(StructuralElement):
    """An element at one node.

    Parameters
    ----------
    node : the node
    """

    node: Nodal
    node_count: ClassVar[int] = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.node, Nodal) or self.node.dimension not in self.dimensions:
            dimensions = " or ".join(map(str, self.dimensions))
            raise ModelError(
                f"needs a node with {dimensions} coordinates; got {self.node!r}", self.name
            )

    def nodes(self) -> tuple[Nodal, ...]:
        return (self.node,)

    @classmethod
    def directions(cls, x: list[ca.SX]) -> list[tuple[str, int]]:
        """Axis and row of its motions: translations of the node, or its rotations."""
        d = x[0].numel()
        if not cls.turns:
            return [(AXES[k], k) for k in range(d)]
        return [(axis, d + k) for k, axis in enumerate(AXES[2:] if d == 2 else AXES)]


@dataclass(eq=False)
class GroundSpring(Attached):
    """Springs between a node and its initial position, ``W = Σ k u²/2``.

    Parameters
    ----------
    stiffness_x, stiffness_y, stiffness_z : along the axes [N/m]; ignored for axes that the node
        does not have

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> raft = da.Structure("raft")
    >>> a, b = raft.node("a", 0, 0), raft.node("b", 4, 0)
    >>> beam = raft.add(structures.Frame("beam", a, b, area=1e-2, second_moment=1e-5, modulus=2e11))
    >>> for name, node in (("left", a), ("right", b)):
    ...     spring = raft.add(structures.GroundSpring(name, node, stiffness_x=1e6, stiffness_y=1e6))
    >>> raft.load(a, fy=-4e3)
    >>> round(da.solve_statics(raft.build())["a.uy"], 9)  # -F/k
    -0.004
    """

    stiffness_x: Scalar = quantity("N/m", "along x", default=0.0, minimum=0.0, keyword=True)
    stiffness_y: Scalar = quantity("N/m", "along y", default=0.0, minimum=0.0, keyword=True)
    stiffness_z: Scalar = quantity("N/m", "along z", default=0.0, minimum=0.0, keyword=True)
    effort: ClassVar[tuple[str, str]] = ("force", "N")

    @classmethod
    def strains(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        return cls.moved(u)

    @classmethod
    def energy_of(cls, strains: ca.SX, x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        energies = (q[f"stiffness_{a}"] * strains[k] ** 2 / 2 for a, k in cls.directions(x))
        return sum(energies, ca.SX(0))

    @classmethod
    def moved(cls, u: list[ca.SX]) -> ca.SX:
        """Displacement of the node followed by its rotation, a rotation vector in space."""
        if cls.turns and u[0].numel() > 3:
            return ca.vertcat(u[0][:3], vector_of(u[0]))
        return u[0]

    @classmethod
    def recovered(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> Named:
        name, unit = cls.effort
        displacement = cls.moved(u)
        return {
            f"{name}_{a}": (q[f"stiffness_{a}"] * displacement[k], unit)
            for a, k in cls.directions(x)
        }


@dataclass(eq=False)
class GroundRotationSpring(GroundSpring):
    """Rotational springs between a node and the ground, ``W = Σ k r²/2``.

    Planar nodes use ``stiffness_z`` only. In space ``r`` are the components of the rotation vector,
    whose range is half a turn in a mechanism and a full one in a structure.

    Parameters
    ----------
    stiffness_x, stiffness_y, stiffness_z : about the axes [N m/rad]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> post = da.Structure("post on a footing")
    >>> foot, top = post.node("foot", 0, 0), post.node("top", 0, 3)
    >>> beam = structures.Frame("post", foot, top, area=1e-3, second_moment=1e-6, modulus=2e11)
    >>> footing = structures.GroundRotationSpring("footing", foot, stiffness_z=1e6)
    >>> parts = post.add(beam), post.add(footing)
    >>> post.support(foot, ux=0, uy=0)
    >>> post.load(top, fx=100.0)
    >>> round(da.solve_statics(post.build())["foot.rz"], 9)  # -F L/k
    -0.0003
    """

    stiffness_x: Scalar = quantity("N m/rad", "about x", default=0.0, minimum=0.0, keyword=True)
    stiffness_y: Scalar = quantity("N m/rad", "about y", default=0.0, minimum=0.0, keyword=True)
    stiffness_z: Scalar = quantity("N m/rad", "about z", default=0.0, minimum=0.0, keyword=True)
    effort: ClassVar[tuple[str, str]] = ("moment", "N m")
    turns: ClassVar[bool] = True
    counts_turns: ClassVar[bool] = True
    dimensions: ClassVar[tuple[int, ...]] = (2, 3)


@dataclass(eq=False)
class PointMass(Attached):
    """A mass at a node, ``T = m v²/2``.

    Parameters
    ----------
    mass : [kg]

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> mast = da.Structure("mast")
    >>> foot, top = mast.node("foot", 0, 0), mast.node("top", 0, 3)
    >>> numbers = dict(area=1e-3, second_moment=1e-7, modulus=2e11)
    >>> beam = mast.add(structures.Frame("mast", foot, top, **numbers))
    >>> tank = mast.add(structures.PointMass("tank", top, mass=50.0))
    >>> mast.support(foot)
    >>> modes = da.solve_modes(mast.build(), 1)
    >>> stiffness = 3 * 2e11 * 1e-7 / 3**3
    >>> round(float(modes.frequencies[0]) * 2 * math.pi / math.sqrt(stiffness / 50), 6)  # by √(k/m)
    1.0
    """

    mass: Scalar = quantity("kg", "mass", minimum=0.0, keyword=True)

    @classmethod
    def kinetic(cls, v: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        return q["mass"] * ca.sumsqr(v[0]) / 2


@dataclass(eq=False)
class PointInertia(Attached):
    """Moments of inertia at a node with rotation, ``T = Σ J ω²/2`` in axes fixed in the node.

    Parameters
    ----------
    inertia_x, inertia_y, inertia_z : about the principal axes [kg m²]; planar nodes use
        ``inertia_z`` only

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> system = da.Structure("torsion pendulum")
    >>> hub = system.node("hub", 0, 0)
    >>> wire = system.add(structures.GroundRotationSpring("wire", hub, stiffness_z=4.0))
    >>> disc = system.add(structures.PointInertia("disc", hub, inertia_z=0.25))
    >>> system.support(hub, ux=0, uy=0)
    >>> modes = da.solve_modes(system.build(), 1)
    >>> round(float(modes.frequencies[0]) * 2 * math.pi, 6)  # √(k/J)
    4.0
    """

    inertia_x: Scalar = quantity("kg m^2", "about x", default=0.0, minimum=0.0, keyword=True)
    inertia_y: Scalar = quantity("kg m^2", "about y", default=0.0, minimum=0.0, keyword=True)
    inertia_z: Scalar = quantity("kg m^2", "about z", minimum=0.0, keyword=True)
    turns: ClassVar[bool] = True
    dimensions: ClassVar[tuple[int, ...]] = (2, 3)

    @classmethod
    def kinetic(cls, v: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        return sum((q[f"inertia_{a}"] * v[0][k] ** 2 / 2 for a, k in cls.directions(x)), ca.SX(0))

    @classmethod
    def own_axes(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX | None:
        return turn_of(u[0]) if x[0].numel() == 3 else None
