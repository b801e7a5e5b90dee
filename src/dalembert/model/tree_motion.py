"""Poses, speeds and accelerations of a tree of bodies: ``g(q)``, ``D q̇`` and ``γ`` (6.1), (6.17).

Each body adds its own joint to what its carrier does, so that everything grows with the number
of bodies and no more.
"""

from __future__ import annotations

import casadi as ca

from dalembert.elements.base import Coordinates
from dalembert.elements.planar.body import Ground
from dalembert.model.kinematic_tree import Link
from dalembert.model.tree_basis import Branch, TreeBasis
from dalembert.symbolic.expression import stack


class TreeMotion:
    """Motion of all groups of coordinates in joint coordinates.

    Parameters
    ----------
    links : carriers before what they carry
    groups : groups of coordinates in the order of y and v

    Attributes
    ----------
    q, u, a : SX symbols (k,): joint coordinates, ``q̇`` and ``q̈``
    pose : SX (n,), ``g(q)``
    basis : TreeBasis, ``D`` and ``E``
    speed, gamma, acceleration : SX (n,), ``D q̇``, ``γ`` and ``D q̈ + γ``
    """

    def __init__(self, links: list[Link], groups: list[Coordinates]):
        self.links = links
        names = [name for link in links for name in link.names]
        self.q = stack(link.q for link in links)
        self.u = stack(ca.SX.sym(f"d{name}") for name in names)
        self.a = stack(ca.SX.sym(f"dd{name}") for name in names)
        rows = _rows_of(groups)
        n = sum(group.pose.numel() for group in groups)
        self.pose = ca.SX.zeros(n)
        branches: list[Branch] = []
        drifts: list[ca.SX] = []
        poses: list[ca.SX] = []
        twists: list[ca.SX] = []
        index = {link.group.name: k for k, link in enumerate(links)}
        column = opened = 0
        for link in links:
            carrier = None if isinstance(link.carrier, Ground) else link.carrier
            columns = slice(column, column + link.q.numel())
            against = slice(opened, opened + link.z.numel())
            parent, known = None, ca.SX(0, 1)
            if carrier is not None:
                parent = index[carrier.name]
                known = ca.vertcat(poses[parent], twists[parent])
            local = _motion_of(link, carrier, self.u[columns, :], known)
            pose, carried, moved, turned, forced, twist, drift = local
            place = rows[link.group.name]
            branches.append(Branch(parent, place, columns, against, carried, moved, turned, forced))
            poses.append(pose)
            twists.append(twist)
            drifts.append(drift)
            self.pose[place] = pose
            column, opened = columns.stop, against.stop
        self.basis = TreeBasis(branches, n)
        self.speed = ca.densify(self.basis.times(self.u))
        self.gamma = ca.densify(self.basis.times(ca.SX.zeros(column), drifts))
        self.acceleration = ca.densify(self.basis.times(self.a, drifts))


def _rows_of(groups: list[Coordinates]) -> dict[str, slice]:
    begin, rows = 0, {}
    for group in groups:
        rows[group.name] = slice(begin, begin + group.pose.numel())
        begin = rows[group.name].stop
    return rows


def _motion_of(link: Link, carrier: Coordinates | None, u: ca.SX, known: ca.SX) -> list[ca.SX]:
    """The local motion by q and ``q̇`` alone, with pose and twist of the carrier ``known``."""
    local, value = _local_motion(link, carrier, u), link.own_value
    if carrier is not None:
        symbols = ca.vertcat(carrier.pose, carrier.twist)
        *local, value = ca.substitute([*local, value], [symbols], [known])
    return ca.substitute(local, [link.own], [value])


def _local_motion(link: Link, carrier: Coordinates | None, u: ca.SX) -> list[ca.SX]:
    """Pose, ``X, S, N, E``, twist and its rate at constant speeds, by the carrier's motion."""
    nothing = ca.SX(0, 1)
    base, speed = (nothing, nothing) if carrier is None else (carrier.pose, carrier.twist)
    closed = ca.SX.zeros(link.z.numel())
    pose, forced = ca.substitute([link.pose, ca.jacobian(link.pose, link.z)], [link.z], [closed])
    sense, led = (ca.jacobian(link.own_value, x) for x in (link.q, base))  # ±1; 0 or 1
    carried, along = ca.jacobian(pose, base), ca.jacobian(pose, link.own)
    own_rate = ca.mtimes(sense, u) + ca.mtimes(led, speed)
    twist = ca.mtimes(carried, speed) + ca.mtimes(along, own_rate)
    place, rate = ca.vertcat(base, link.own), ca.vertcat(speed, own_rate)
    drift = ca.jtimes(twist, place, rate) if place.numel() else ca.SX.zeros(pose.numel())
    moved, turned = ca.mtimes(along, sense), ca.mtimes(sense.T, led)
    return [ca.densify(pose), carried, moved, turned, forced, ca.densify(twist), drift]
