"""Links, joints and loops of a robot, as all formats describe them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dalembert.io.imports.robots.inertia import Inertia
from dalembert.io.imports.robots.pose import Pose
from dalembert.io.imports.xml.element import XmlElement

TURNING, SLIDING, BALL, PLANAR, FREE = "turning", "sliding", "ball", "planar", "free"
"""Kinds of joints: revolute, prismatic, spherical, planar, and six free motions."""


@dataclass(eq=False)
class Joint:
    """A joint that carries a link; a link may have several in a row.

    Attributes
    ----------
    name : in the file
    kind : such as ``"turning"``
    element : its element, for messages
    axis : (3,) in the link's frame [-]
    anchor : (3,) a point of the axis in the link's frame [m]
    start : coordinate at the start [rad] or [m]; 0 in the position of the file
    range : lower and upper limit of the coordinate, or None
    damping : [N m s/rad] or [N s/m]
    friction : [N m] or [N]
    stiffness : [N m/rad] or [N/m]
    rest : coordinate at which the spring has no moment
    inertia : of a rotor that turns with the joint [kg m²] or [kg]
    effort_range : limits of the sum of its actuators [N m] or [N], or None
    comment : for the model file
    """

    name: str
    kind: str
    element: XmlElement
    axis: np.ndarray = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    anchor: np.ndarray = field(default_factory=lambda: np.zeros(3))
    start: float = 0.0
    range: tuple[float, float] | None = None
    damping: float = 0.0
    friction: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    inertia: float = 0.0
    effort_range: tuple[float, float] | None = None
    comment: str = ""

    @property
    def has_angle(self) -> bool:
        """Whether its coordinate is one angle or displacement."""
        return self.kind in (TURNING, SLIDING)


@dataclass(eq=False)
class Shape:
    """Geometry of a link, for pictures.

    Attributes
    ----------
    kind : ``"Box"``, ``"Sphere"``, ``"Cylinder"``, ``"Capsule"``, ``"Ellipsoid"`` or ``"Mesh"``
    pose : in the link's frame
    sizes : keys of the shape in a model file
    """

    kind: str
    pose: Pose
    sizes: dict[str, Any]


@dataclass(eq=False)
class Link:
    """A rigid body of the file.

    Attributes
    ----------
    name : in the file
    element : its element, for messages
    inertia : in its frame
    parent : the link that carries it; None on the ground
    pose : in the frame of the parent, in the position of the file
    joints : between the parent and the link, from the parent outwards; none if it is fixed
    orientation : pose of a link with a ball joint or without any, at the start
    shapes : geometry
    frames : name → further frames of the link
    lift : force at the mass centre against gravity, relative to the weight [-]
    """

    name: str
    element: XmlElement
    inertia: Inertia = field(default_factory=Inertia)
    parent: Link | None = None
    pose: Pose = field(default_factory=Pose)
    joints: list[Joint] = field(default_factory=list)
    start: Pose | None = None
    shapes: list[Shape] = field(default_factory=list)
    frames: dict[str, Pose] = field(default_factory=dict)
    lift: float = 0.0

    def __repr__(self) -> str:
        return self.name


@dataclass(eq=False)
class Closure:
    """A joint that closes a loop, between frames of two links.

    Attributes
    ----------
    type : class of the joint in a model file
    links : None for the ground
    poses : of the frames in their links
    keys : further keys of the joint in a model file
    motion : its limits, spring and friction, or None
    """

    name: str
    type: str
    element: XmlElement
    links: tuple[Link | None, Link | None]
    poses: tuple[Pose, Pose]
    keys: dict[str, Any] = field(default_factory=dict)
    motion: Joint | None = None


@dataclass(eq=False)
class Dependence:
    """A joint whose coordinate is a polynomial of another one's.

    ``second = Σ coefficients[k] firstᵏ``; a constant without a first joint.
    """

    name: str
    element: XmlElement
    first: Joint | None
    second: Joint
    coefficients: list[float]


@dataclass(eq=False)
class Actuator:
    """A force along joints, or at a site, with a control ``u`` from outside.

    With the length ``L = offset + Σ coefficient s`` of its joints the force along L is
    ``(g₀ + g₁ L + g₂ L̇) u + b₀ + b₁ L + b₂ L̇``.

    Attributes
    ----------
    name : in the file
    joints : with their coefficients
    offset : L at zero coordinates
    gain, bias : (3,) ``g`` and ``b``
    bounds : of the control, or None
    force_range : limits of the force along L, or None
    activation : ``"integrator"`` of the control or ``"filter"`` in place of it; empty for none
    time_constant : of the filter [s]
    site : link and pose of a site on which the force acts instead, L = 0; or None
    wrench : (6,) force and moment at the site, in its axes, per force
    """

    name: str
    joints: list[tuple[Joint, float]]
    offset: float
    gain: list[float]
    bias: list[float]
    bounds: tuple[float, float] | None
    force_range: tuple[float, float] | None = None
    activation: str = ""
    time_constant: float = 0.0
    site: tuple[Link, Pose] | None = None
    wrench: np.ndarray = field(default_factory=lambda: np.zeros(6))


@dataclass(eq=False)
class Robot:
    """All parts of a file.

    Attributes
    ----------
    name : of the model
    gravity : (3,) [m/s²], or None if the file has none
    links : parents before the links that they carry
    """

    name: str
    gravity: np.ndarray | None
    links: list[Link] = field(default_factory=list)
    closures: list[Closure] = field(default_factory=list)
    dependences: list[Dependence] = field(default_factory=list)
    actuators: list[Actuator] = field(default_factory=list)
    ground_shapes: list[Shape] = field(default_factory=list)
    ground_frames: dict[str, Pose] = field(default_factory=dict)
