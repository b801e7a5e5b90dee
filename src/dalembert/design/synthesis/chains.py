"""Mechanisms out of chains of links: six-bars of Watt and Stephenson, geared five-bars, your own.

A chain says which joints each link has; an inversion says which link stands still. A mechanism is
given by where its joints are in one position, so that every choice of numbers can be assembled.
Source: R. S. Hartenberg, J. Denavit, *Kinematic Synthesis of Linkages* (1964), ch. 2; names of the
inversions as in A. G. Erdman, G. N. Sandor, *Mechanism Design* (1984).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from dalembert.elements import planar
from dalembert.errors import ModelError
from dalembert.model.system import System
from dalembert.symbolic.formulas.expression import t
from dalembert.symbolic.formulas.parameter import Parameter
from dalembert.text.wording import unknown

Places = Mapping[str, tuple[float, float]]
"""Joint, or point of a link, → where it is in one position [m]."""

WATT = {
    "left": ("A", "B", "C"),
    "right": ("A", "D", "E"),
    "short": ("B", "F"),
    "long": ("F", "D"),
    "upper": ("C", "G"),
    "outer": ("G", "E"),
}
"""Watt's chain: two links of three joints, joined to each other in A."""
STEPHENSON = {
    "left": ("A", "B", "C"),
    "right": ("D", "E", "F"),
    "first": ("A", "D"),
    "second": ("B", "E"),
    "upper": ("C", "G"),
    "outer": ("G", "F"),
}
"""Stephenson's chain: two links of three joints that are not joined to each other."""


@dataclass(frozen=True)
class Inversion:
    """A chain with the link that stands still and the one that the motor turns against it."""

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
"""The distinct six-bars with turning joints; other links that stand still give one of these."""


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
    """A six-bar of Watt or Stephenson.

    Parameters
    ----------
    kind : ``"watt I"``, ``"watt II"``, ``"stephenson I"``, ``"stephenson II"``,
        ``"stephenson III"``; the joints of their links are ``da.INVERSIONS[kind].chain``
    joints : A … G, where they are in one position [m]
    points : link → point → where it is in the same position
    ground, crank : other links than usual, of the same chain
    reach : bounds of the parameters, so far to both sides of where they are [m]
    speed : of the motor [rad/s]

    Raises
    ------
    ModelError
        An unknown kind, or joints that are missing.

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
    usual = INVERSIONS[kind]
    return linkage_from_chain(
        usual.chain,
        joints,
        ground or usual.ground,
        crank or usual.crank,
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
    """A planar linkage with turning joints from its chain.

    Its parameters are the places of joints and points in the position that is given, ``A_x``,
    ``A_y`` …; links are bodies of their names, with a point for each joint.

    Parameters
    ----------
    chain : link → its joints; each joint is of two links
    joints : where they are in one position [m]
    ground, crank : the link that stands still, and the one that a motor turns
    points : link → point → where it is in the same position
    reach : bounds of the parameters, so far to both sides [m]
    speed : of the motor [rad/s]

    Raises
    ------
    ModelError
        A joint without place or not of two links, an unknown link.

    Examples
    --------
    >>> import dalembert as da
    >>> chain = {"frame": "AD", "crank": "AB", "coupler": "BC", "rocker": "CD"}
    >>> joints = {"A": (0, 0), "B": (0, 1), "C": (3, 2), "D": (3, 0)}
    >>> model = da.linkage_from_chain(chain, joints, ground="frame", crank="crank").build()
    >>> model.diagnosis.summary
    '1 degree of freedom, 1 driven, 0 free'
    """
    _refuse(chain, joints, (ground, crank, *(points or {})))
    made = System(name)

    def place(at: str, xy: tuple[float, float]) -> tuple[Parameter, Parameter]:
        ends = [(v - reach, v + reach) if reach else None for v in xy]
        x, y = (made.parameter(f"{at}_{a}", xy[k], "m", ends[k]) for k, a in enumerate("xy"))
        return x, y

    known = {joint: place(joint, joints[joint]) for joint in _all(chain)}
    others = {
        link: {p: place(p, xy) for p, xy in given.items()} for link, given in (points or {}).items()
    }
    bodies = {
        link: made.add(_link(link, {j: known[j] for j in own} | others.get(link, {})))
        for link, own in chain.items()
        if link != ground
    }

    def point(link: str, joint: str) -> Any:
        return made.ground.point(*known[joint]) if link == ground else bodies[link].points[joint]

    for joint in known:
        first, second = (link for link, own in chain.items() if joint in own)
        made.add(planar.Revolute(f"joint_{joint}", point(first, joint), point(second, joint)))
    made.add(planar.RotationalDriver("motor", made.ground, bodies[crank], speed * t))
    return made


def _link(name: str, places: Mapping[str, tuple[Any, Any]]) -> planar.Body:
    """A link at angle zero in the position given, its origin in its first joint."""
    x, y = next(iter(places.values()))
    local = {joint: (px - x, py - y) for joint, (px, py) in places.items()}
    return planar.Body(name, mass=1.0, inertia=1.0, position=(x, y), angle=0.0, points=local)


def _all(chain: Mapping[str, Sequence[str]]) -> list[str]:
    return list(dict.fromkeys(joint for own in chain.values() for joint in own))


def _refuse(chain: Mapping[str, Sequence[str]], joints: Places, links: Sequence[str]) -> None:
    for joint in _all(chain):
        count = sum(joint in own for own in chain.values())
        if count != 2:
            raise ModelError(f"the joint {joint!r} is of {count} links; each joins two")
        if joint not in joints:
            raise ModelError(f"where is the joint {joint!r}? give joints={{{joint!r}: (x, y), …}}")
    for joint in joints:
        if joint not in _all(chain):
            raise ModelError(unknown("joint", joint, _all(chain)))
    for link in links:
        if link not in chain:
            raise ModelError(unknown("link", link, chain))


FIVE = {"crank": ("O1", "A"), "left": ("A", "C"), "right": ("C", "B"), "gear": ("B", "O2")}


def geared_five_bar(
    joints: Places,
    ratio: float,
    points: Mapping[str, Places] | None = None,
    *,
    reach: float | None = None,
    speed: float = 1.0,
    name: str = "geared five-bar",
) -> System:
    """A five-bar whose two links on the ground are geared.

    ``gear`` turns ``ratio`` times as fast as ``crank``.

    Parameters
    ----------
    joints : O1 and O2 on the ground, A between ``crank`` and ``left``, C between ``left`` and
        ``right``, B between ``right`` and ``gear`` [m]
    ratio : of the speeds; negative for two gears in mesh, positive for a ring or an idler
    points, reach, speed : as of ``linkage_from_chain``

    Raises
    ------
    ModelError
        A ratio of zero, or joints that are missing.

    Examples
    --------
    >>> import dalembert as da
    >>> joints = {"O1": (0, 0), "O2": (4, 0), "A": (1, 1), "C": (2, 4), "B": (4, 1)}
    >>> model = da.geared_five_bar(joints, ratio=-1.0).build()
    >>> model.diagnosis.summary
    '1 degree of freedom, 1 driven, 0 free'
    """
    if not ratio:
        raise ModelError("the ratio of the gears is zero; give that of their speeds")
    chain = {**FIVE, "base": ("O1", "O2")}
    made = linkage_from_chain(
        chain, joints, "base", "crank", points, reach=reach, speed=speed, name=name
    )
    crank, gear = made.bodies[0], made.bodies[-1]
    made.add(planar.Coupling("gears", crank, gear, ratio=ratio))
    return made
