"""The tree of bodies that joints carry from the ground outwards, ``y = g(q, z)`` (4.15), (7.7)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Coordinates
from dalembert.elements.planar.body import Body, Ground, rotation
from dalembert.elements.planar.joint import TreeJoint
from dalembert.errors import ModelError
from dalembert.model.description import Description
from dalembert.model.spanning_tree import Edge, SpanningTree, spanning_tree
from dalembert.symbolic.expression import stack


@dataclass(frozen=True, eq=False)
class Link:
    """A group of body coordinates and how its joint places it.

    Attributes
    ----------
    group, carrier, joint : no joint where the group has its own coordinates
    names : names of the joint coordinates
    q, z : SX symbols: joint coordinates, open-constraint coordinates
    own, own_value : SX symbols ``q*``, and their value by the carrier's pose and q: the same with
        the body's own angle in the place of a relative one, which makes shorter recursions
    pose : SX of the carrier's pose, ``q*`` and z
    reading : SX of the poses, the value of q
    """

    group: Coordinates
    carrier: Body | None
    joint: TreeJoint | None
    names: list[str]
    q: ca.SX
    z: ca.SX
    own: ca.SX
    own_value: ca.SX
    pose: ca.SX
    reading: ca.SX


def tree_of_joints(d: Description, cut: tuple[str, ...]) -> SpanningTree:
    """Spanning tree from the ground by the joints that can carry a body and are not cut.

    Joints with many equations are taken first, so that few are left for the loops.

    Raises
    ------
    ModelError
        A name that is no joint, or a joint that closes no loop.
    """
    carrying = {c.name: c for c in d.constraints if isinstance(c, TreeJoint)}
    for name in cut:
        if name not in carrying:
            others = {c.name for c in d.constraints} - set(carrying)
            why = "is always a loop equation" if name in others else "is not a joint"
            known = ", ".join(carrying) or "none"
            raise ModelError(f"cut {name!r} {why}; joints that can be cut: {known}", d.name)
    names = ["ground", *(body.name for body in d.bodies)]

    def tree(left_out: tuple[str, ...]) -> SpanningTree:
        edges = [
            Edge(c.name, c.ends()[0].name, c.ends()[1].name, -c.equations.numel())
            for c in carrying.values()
            if c.name not in left_out
        ]
        return spanning_tree(names, edges)

    made, loose = tree(cut), set(tree(()).roots)
    for body in made.roots:
        if body not in loose:
            touching = [n for n in cut if body in {e.name for e in carrying[n].ends()}]
            raise ModelError(
                f"cut {', '.join(map(repr, touching or cut))}: nothing would carry {body} any "
                "more; only joints in a closed loop can be cut",
                d.name,
            )
    return made


def links_of(d: Description, cut: tuple[str, ...], absolute_angles: bool) -> list[Link]:
    """All groups of coordinates, carriers before what they carry."""
    joints = {c.name: c for c in d.constraints if isinstance(c, TreeJoint)}
    links = []
    for visit in tree_of_joints(d, cut).visits:
        if visit.node == "ground":
            continue
        if visit.edge is None or visit.parent is None:
            links.append(free_link(d.body(visit.node)))
        else:
            ends = d.body(visit.parent), d.body(visit.node)
            links.append(carried_link(joints[visit.edge], *ends, absolute_angles))
    return links + [free_link(group) for group in d.coordinates if not isinstance(group, Body)]


def free_link(group: Coordinates) -> Link:
    names = [f"{group.name}.{n}" for n in group.coordinate_names]
    q = stack(ca.SX.sym(name) for name in names)
    return Link(group, None, None, names, q, ca.SX(0, 1), q, q, q, group.pose)


def carried_link(joint: TreeJoint, carrier: Body, child: Body, absolute_angles: bool) -> Link:
    """The child behind a joint, whichever end of the joint it is."""
    forward = joint.ends()[1] is child
    base = ca.SX.zeros(3) if isinstance(carrier, Ground) else carrier.pose
    base_angle = base[2] if carrier.rotates else ca.SX(0)
    z = stack(ca.SX.sym(f"{joint.name}.z{k}") for k in range(joint.equations.numel()))
    free = joint.joint_coordinates()
    names = [f"{joint.name}.{name}" for name in free]
    reading = [expression for expression, _ in free.values()]
    slides = stack(ca.SX.sym(name) for name in names)
    turn = joint.fixed_turn(z)
    q, own, own_value = slides, slides, slides
    if turn is not None:
        angle = base_angle + turn if forward else base_angle - turn
    elif child.rotates:
        absolute = absolute_angles or not carrier.rotates
        names.append(f"{child.name}.angle" if absolute else f"{joint.name}.angle")
        reading.append(child.pose_angle if absolute else joint.turn)
        spin, angle = ca.SX.sym(names[-1]), ca.SX.sym(f"{child.name}.angle")
        relative = base_angle + spin if forward else base_angle - spin
        q, own = ca.vertcat(slides, spin), ca.vertcat(slides, angle)
        own_value = ca.vertcat(slides, spin if absolute else relative)
    else:
        angle = ca.SX(0)
    on_base, on_child = (joint.point_i, joint.point_j)[:: 1 if forward else -1]
    opening = joint.opening(slides, z, base_angle if forward else angle)
    place = base[:2] + ca.mtimes(rotation(base_angle), on_base.local.sx)
    place += opening if forward else -opening
    place -= ca.mtimes(rotation(angle), on_child.local.sx)
    pose = ca.vertcat(place, angle) if child.rotates else place
    return Link(child, carrier, joint, names, q, z, own, own_value, pose, stack(reading))
