"""Linkages from kinematic chains: six-bars of Watt and Stephenson, geared five-bars, others.

A chain lists the joints of each link; an inversion defines the fixed link. A mechanism is described
by the positions of its joints in one configuration, so that all numbers can be assembled.
Source: R. S. Hartenberg, J. Denavit, *Kinematic Synthesis of Linkages* (1964), ch. 2; names of the
inversions as in A. G. Erdman, G. N. Sandor, *Mechanism Design* (1984).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from dalembert.elements import planar
from dalembert.elements.point import Point
from dalembert.errors import ModelError
from dalembert.model.system import System
from dalembert.symbolic.formulas.expression import t
from dalembert.symbolic.formulas.parameter import Parameter
from dalembert.text.wording import unknown

Places = Mapping[str, tuple[float, float]]
"""Joint, or point of a link, → its position in one configuration [m]."""

WATT = {
    "left": ("A", "B", "C"),
    "right": ("A", "D", "E"),
    "short": ("B", "F"),
    "long": ("F", "D"),
    "upper": ("C", "G"),
    "outer": ("G", "E"),
}
"""Watt's chain: two ternary links, joined to each other in A."""
STEPHENSON = {
    "left": ("A", "B", "C"),
    "right": ("D", "E", "F"),
    "first": ("A", "D"),
    "second": ("B", "E"),
    "upper": ("C", "G"),
    "outer": ("G", "F"),
}
"""Stephenson's chain: two ternary links that are not joined to each other."""


@dataclass(frozen=True)
class Inversion:
    """A chain with its fixed link and the link driven by the motor."""

    chain: Mapping[str, tuple[str, ...]]
    ground: str
    crank: str


INVERSIONS = {
    "watt I": Inversion(WATT, "short", "left"),
    "watt II": Inversion(WATT, "left", "short"),
    "stephenson I": Inversion(STEPHENSON, "first", "left"),
    "stephenson II": Inversion(STEPHENSON, "outer", "upper"),
    "stephenson III": Inversion(STEPHENSON, "left", "first"),
}
"""The distinct six-bars with revolute joints; other fixed links are equivalent to one of these."""


def six_bar(
    kind: str,
    joints: Places,
    points: Mapping[str, Places] | None = None,
    *,
    ground: str | None = None,
    crank: str | None = None,
    reach: float | None = None,
    speed: float = 1.0,
    name: str = "",
) -> System:
    """Six-bar linkage of Watt or Stephenson.

    Parameters
    ----------
    kind : ``"watt I"``, ``"watt II"``, ``"stephenson I"``, ``"stephenson II"``,
        ``"stephenson III"``; the joints of their links are ``da.INVERSIONS[kind].chain``
    joints : A … G, positions in one configuration [m]
    points : link → point → position in the same configuration
    ground, crank : other fixed and driven links of the same chain
    reach : bounds of the parameters, relative to their values [m]
    speed : of the motor [rad/s]

    Raises
    ------
    ModelError
        The kind is unknown, or joints are missing.

    Examples
    --------
    >>> import dalembert as da
    >>> sorted(da.INVERSIONS["watt II"].chain)  # its links
    ['left', 'long', 'outer', 'right', 'short', 'upper']
    >>> joints = {"A": (4, 0), "B": (0, 0), "C": (8, 0), "F": (1, 0.5)}
    >>> joints |= {"D": (4.5, 3), "E": (6.5, 2.2), "G": (9, 3)}
    >>> model = da.six_bar("watt II", joints).build()
    >>> len(model.bodies), model.diagnosis.degrees_of_freedom
    (5, 1)
    """
    if kind not in INVERSIONS:
        raise ModelError(unknown("six-bar", kind, INVERSIONS))
    inversion = INVERSIONS[kind]
    return linkage_from_chain(
        inversion.chain,
        joints,
        ground or inversion.ground,
        crank or inversion.crank,
        points,
        reach=reach,
        speed=speed,
        name=name or kind,
    )


def linkage_from_chain(
    chain: Mapping[str, Sequence[str]],
    joints: Places,
    ground: str,
    crank: str,
    points: Mapping[str, Places] | None = None,
    *,
    reach: float | None = None,
    speed: float = 1.0,
    name: str = "linkage",
) -> System:
    """Planar linkage with revolute joints from its chain.

    Its parameters are the positions of joints and points in the configuration, ``A_x``, ``A_y`` …;
    links are bodies with their names and a point for each joint.

    Parameters
    ----------
    chain : link → its joints; each joint connects two links
    joints : positions in one configuration [m]
    ground, crank : the fixed link, and the link driven by a motor
    points : link → point → position in the same configuration
    reach : bounds of the parameters, relative to their values [m]
    speed : of the motor [rad/s]

    Raises
    ------
    ModelError
        A joint has no position or does not connect two links, or a link is unknown.

    Examples
    --------
    >>> import dalembert as da
    >>> chain = {"frame": "AD", "crank": "AB", "coupler": "BC", "rocker": "CD"}
    >>> joints = {"A": (0, 0), "B": (0, 1), "C": (3, 2), "D": (3, 0)}
    >>> model = da.linkage_from_chain(chain, joints, ground="frame", crank="crank").build()
    >>> model.diagnosis.summary
    '1 degree of freedom, 1 driven, 0 free'
    """
    _check_chain(chain, joints, (ground, crank, *(points or {})))
    system = System(name)

    def add_position(label: str, xy: tuple[float, float]) -> tuple[Parameter, Parameter]:
        ends = [(v - reach, v + reach) if reach else None for v in xy]
        x, y = (system.parameter(f"{label}_{a}", xy[k], "m", ends[k]) for k, a in enumerate("xy"))
        return x, y

    positions = {joint: add_position(joint, joints[joint]) for joint in _joint_names(chain)}
    point_positions = {
        link: {p: add_position(p, xy) for p, xy in named.items()}
        for link, named in (points or {}).items()
    }
    bodies = {
        link: system.add(
            _link(link, {j: positions[j] for j in link_joints} | point_positions.get(link, {}))
        )
        for link, link_joints in chain.items()
        if link != ground
    }

    def point(link: str, joint: str) -> Point:
        return (
            system.ground.point(*positions[joint]) if link == ground else bodies[link].points[joint]
        )

    for joint in positions:
        first, second = (link for link, link_joints in chain.items() if joint in link_joints)
        system.add(planar.Revolute(f"joint_{joint}", point(first, joint), point(second, joint)))
    system.add(planar.RotationalDriver("motor", system.ground, bodies[crank], speed * t))
    return system


def _link(name: str, positions: Mapping[str, tuple[Any, Any]]) -> planar.Body:
    """A link at angle zero in the configuration, with its origin in its first joint."""
    x, y = next(iter(positions.values()))
    local = {joint: (px - x, py - y) for joint, (px, py) in positions.items()}
    return planar.Body(name, mass=1.0, inertia=1.0, position=(x, y), angle=0.0, points=local)


def _joint_names(chain: Mapping[str, Sequence[str]]) -> list[str]:
    return list(dict.fromkeys(joint for joints in chain.values() for joint in joints))


def _check_chain(chain: Mapping[str, Sequence[str]], joints: Places, links: Sequence[str]) -> None:
    for joint in _joint_names(chain):
        count = sum(joint in link_joints for link_joints in chain.values())
        if count != 2:
            raise ModelError(f"the joint {joint!r} is of {count} links; each joint connects two")
        if joint not in joints:
            raise ModelError(
                f"the joint {joint!r} has no position; give joints={{{joint!r}: (x, y), …}}"
            )
    for joint in joints:
        if joint not in _joint_names(chain):
            raise ModelError(unknown("joint", joint, _joint_names(chain)))
    for link in links:
        if link not in chain:
            raise ModelError(unknown("link", link, chain))


FIVE_BAR = {"crank": ("O1", "A"), "left": ("A", "C"), "right": ("C", "B"), "gear": ("B", "O2")}


def geared_five_bar(
    joints: Places,
    ratio: float,
    points: Mapping[str, Places] | None = None,
    *,
    reach: float | None = None,
    speed: float = 1.0,
    name: str = "geared five-bar",
) -> System:
    """Geared five-bar: the two links at the ground are connected by gears.

    The speed of ``gear`` is ``ratio`` times that of ``crank``.

    Parameters
    ----------
    joints : O1 and O2 on the ground, A between ``crank`` and ``left``, C between ``left`` and
        ``right``, B between ``right`` and ``gear`` [m]
    ratio : ratio of the speeds; negative for external gears, positive for a ring gear or an idler
    points, reach, speed : as in ``linkage_from_chain``

    Raises
    ------
    ModelError
        The ratio is zero, or joints are missing.

    Examples
    --------
    >>> import dalembert as da
    >>> joints = {"O1": (0, 0), "O2": (4, 0), "A": (1, 1), "C": (2, 4), "B": (4, 1)}
    >>> model = da.geared_five_bar(joints, ratio=-1.0).build()
    >>> model.diagnosis.summary
    '1 degree of freedom, 1 driven, 0 free'
    """
    if not ratio:
        raise ModelError("the ratio of the gears is zero; give the ratio of their speeds")
    chain = {**FIVE_BAR, "base": ("O1", "O2")}
    system = linkage_from_chain(
        chain, joints, "base", "crank", points, reach=reach, speed=speed, name=name
    )
    crank, gear = system.bodies[0], system.bodies[-1]
    system.add(planar.Coupling("gears", crank, gear, ratio=ratio))
    return system
