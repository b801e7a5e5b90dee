"""Kinematic tree of bodies and joints from the ground outwards, ``y = g(q)`` (4.15)."""

from __future__ import annotations

from typing import Any

import casadi as ca

from dalembert.elements.base import Constraint
from dalembert.elements.body import BodyElement
from dalembert.elements.joint_forces import AlongJoint
from dalembert.elements.planar.joint import TreeJoint as PlanarJoint
from dalembert.elements.spatial.joint import TreeJoint as SpatialJoint
from dalembert.errors import ModelError, UnsupportedError
from dalembert.model.graph.description import Description
from dalembert.model.graph.tree.link import Link, free_link, planar_link
from dalembert.model.graph.tree.spanning_tree import Edge, SpanningTree, spanning_tree
from dalembert.model.graph.tree.spatial_link import spatial_link

RIGID = 6
"""Number of equations of a weld, the maximum of all joints."""


def carrying_joints(d: Description) -> dict[str, Any]:
    """Joints by name that can carry a body at either end."""
    joints = [c for c in d.constraints if isinstance(c, (PlanarJoint, SpatialJoint))]
    return {j.name: j for j in joints if all(j.carries(b) for b in j.ends() if b is not d.ground)}


def with_rotors(d: Description) -> list[AlongJoint]:
    """Elements with an inertia along the free motion of a joint."""
    elements = [e for e in d.elements.values() if isinstance(e, AlongJoint)]
    return [element for element in elements if element.own_mass]


def rotors_of(d: Description, links: list[Link]) -> list[ca.SX]:
    """Inertia of the rotors along the speeds of each link.

    Raises
    ------
    UnsupportedError
        The speed of a rotor is not that of a coordinate.
    """
    inertias = [ca.SX(*2 * (link.space.twist.numel(),)) for link in links]
    carried = {link.joint.name: k for k, link in enumerate(links) if link.joint is not None}
    for element in with_rotors(d):
        joint, motion = element.joint.name, f"{element.joint.name}.{element.motion}"
        k = carried.get(joint)
        if k is None:
            raise UnsupportedError(
                f"{element.name}: the joint of its rotor, {joint}, closes a loop, and has no "
                f"coordinate; cut another joint, JointCoordinates(cut=…), or use "
                "coordinates=AbsoluteCoordinates()"
            )
        names = links[k].space.speed_names
        if motion not in names:
            raise UnsupportedError(
                f"{element.name}: the speed of its rotor, {motion}, is not among the coordinates; "
                'use JointCoordinates(angles="relative")'
            )
        index = names.index(motion)
        inertias[k][index, index] += element.rotor
    return inertias


def tree_of_joints(d: Description, cut: tuple[str, ...]) -> SpanningTree:
    """Spanning tree from the ground of the joints that can carry a body and are not cut.

    Joints with rotors are preferred, whose speeds must be those of coordinates, then joints with
    many equations, so that few equations remain for the loops.

    Raises
    ------
    ModelError
        A name that is not a joint, or a joint that is not part of a loop.
    """
    joints = carrying_joints(d)
    for name in cut:
        if name not in joints:
            never_carrying = {c.name for c in d.constraints} - set(joints)
            loop_only = name in never_carrying
            reason = "is always a loop equation" if loop_only else "is not a joint"
            available = ", ".join(joints) or "none"
            raise ModelError(f"cut {name!r} {reason}; joints that can be cut: {available}", d.name)
    names = ["ground", *(body.name for body in d.bodies)]
    driven = {element.joint.name for element in with_rotors(d)}

    def weight(joint: Any) -> int:
        return -joint.equations.numel() - (RIGID if joint.name in driven else 0)

    def tree(left_out: tuple[str, ...]) -> SpanningTree:
        edges = [
            Edge(c.name, c.ends()[0].name, c.ends()[1].name, weight(c))
            for c in joints.values()
            if c.name not in left_out
        ]
        return spanning_tree(names, edges)

    cut_tree, free_roots = tree(cut), set(tree(()).roots)
    for body in cut_tree.roots:
        if body not in free_roots:
            touching = [n for n in cut if body in {e.name for e in joints[n].ends()}]
            raise ModelError(
                f"cut {', '.join(map(repr, touching or cut))}: nothing would carry {body} any "
                "more; only joints in a closed loop can be cut",
                d.name,
            )
    return cut_tree


def links_of(d: Description, cut: tuple[str, ...], absolute_angles: bool) -> list[Link]:
    """Links of all groups of coordinates, carriers before the bodies they carry."""
    joints = carrying_joints(d)
    links: list[Link] = []
    for visit in tree_of_joints(d, cut).visits:
        if visit.node == "ground":
            continue
        if visit.edge is None or visit.parent is None:
            links.append(free_link(d.body(visit.node)))
        else:
            ends = d.body(visit.parent), d.body(visit.node)
            joint = joints[visit.edge]
            if isinstance(joint, PlanarJoint):
                links.append(planar_link(joint, *ends, absolute_angles))
            else:
                links.append(spatial_link(joint, *ends))
    return links + [
        free_link(group) for group in d.coordinates if not isinstance(group, BodyElement)
    ]


def between_neighbours(constraint: Constraint, links: list[Link]) -> ca.SX | None:
    """Equations between a body and its carrier in coordinates of their joint.

    None if its expressions involve other bodies.
    """
    for link in links if constraint.relative else ():
        if link.carrier is not None and {link.carrier, link.group} == set(constraint.parts()):
            at_rest = ca.SX(list(link.carrier.rest))
            (pose,) = ca.substitute([link.step(None).pose], [link.carrier.pose], [at_rest])
            symbols = ca.vertcat(link.carrier.pose, link.group.pose)
            return ca.substitute(constraint.equations, symbols, ca.vertcat(at_rest, pose))
    return None
