"""Bodies that joints carry in the plane, ``y = g(q, z)`` (4.15), (7.7)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.coordinates import JointSpace
from dalembert.elements.planar.body import Body, Ground, rotation
from dalembert.elements.planar.joint import TreeJoint
from dalembert.model.tree.link import Link, Step
from dalembert.symbolic.formulas.expression import stack


@dataclass(frozen=True, eq=False)
class PlanarLink(Link):
    """A body and how its joint places it.

    Attributes
    ----------
    carrier, joint : at most one end of the joint is the ground
    z : SX symbols, open-constraint coordinates
    own, own_value : SX symbols ``q*``, and their value by the carrier's pose and q: the same with
        the body's own angle in the place of a relative one, which makes shorter recursions
    pose : SX of the carrier's pose, ``q*`` and z
    """

    carrier: Body
    joint: TreeJoint
    z: ca.SX
    own: ca.SX
    own_value: ca.SX
    pose: ca.SX

    def step(self, carrier: Step | None) -> Step:
        """The local motion by q and ``q̇`` alone, with what the carrier does."""
        parts, value = self._local(carrier is not None), self.own_value
        if carrier is not None:
            symbols = ca.vertcat(self.carrier.pose, self.carrier.twist)
            known = ca.vertcat(carrier.pose, carrier.twist)
            *parts, value = ca.substitute([*parts, value], [symbols], [known])
        found = ca.substitute(parts, [self.own], [value])
        pose, twist, drift, carried, moved, turned, forced = found
        seen = ca.SX.eye(self.group.twist.numel())
        return Step(pose, twist, drift, carried, moved, turned, forced, seen)

    def _local(self, carried_by_a_body: bool) -> list[ca.SX]:
        """Pose, twist, drift, ``X, S, N, E`` by the carrier's motion."""
        nothing, u = ca.SX(0, 1), self.space.twist
        base, speed = nothing, nothing
        if carried_by_a_body:
            base, speed = self.carrier.pose, self.carrier.twist
        closed = ca.SX.zeros(self.z.numel())
        opened = [self.pose, ca.jacobian(self.pose, self.z)]
        pose, forced = ca.substitute(opened, [self.z], [closed])
        sense, led = (ca.jacobian(self.own_value, x) for x in (self.space.pose, base))  # ±1; 0, 1
        carried, along = ca.jacobian(pose, base), ca.jacobian(pose, self.own)
        own_rate = ca.mtimes(sense, u) + ca.mtimes(led, speed)
        twist = ca.mtimes(carried, speed) + ca.mtimes(along, own_rate)
        place, rate = ca.vertcat(base, self.own), ca.vertcat(speed, own_rate)
        drift = ca.jtimes(twist, place, rate) if place.numel() else ca.SX.zeros(pose.numel())
        moved, turned = ca.mtimes(along, sense), ca.mtimes(sense.T, led)
        return [ca.densify(pose), ca.densify(twist), drift, carried, moved, turned, forced]


def planar_link(joint: TreeJoint, carrier: Body, child: Body, absolute_angles: bool) -> PlanarLink:
    """The child behind a joint, whichever end of the joint it is."""
    forward = joint.ends()[1] is child
    base = ca.SX.zeros(3) if isinstance(carrier, Ground) else carrier.pose
    base_angle = base[2] if carrier.rotates else ca.SX(0)
    z = stack(ca.SX.sym(f"{joint.name}.z{k}") for k in range(joint.equations.numel()))
    free = joint.joint_coordinates()
    names = [f"{joint.name}.{name}" for name in free]
    reading, units = [s for s, _ in free.values()], [unit for _, unit in free.values()]
    turn, absolute = joint.fixed_turn(z), absolute_angles or not carrier.rotates
    turns = turn is None and child.rotates
    if turns:
        names.append(f"{child.name}.angle" if absolute else f"{joint.name}.angle")
        reading.append(child.pose_angle if absolute else joint.turn)
        units.append("rad")
    space = JointSpace(names, units, stack(reading))
    slides = space.pose[: len(free)]
    own, own_value, angle = slides, slides, ca.SX(0)
    if turn is not None:
        angle = base_angle + turn if forward else base_angle - turn
    if turns:
        spin, angle = space.pose[-1], ca.SX.sym(f"{child.name}.angle")
        relative = base_angle + spin if forward else base_angle - spin
        own = ca.vertcat(slides, angle)
        own_value = ca.vertcat(slides, spin if absolute else relative)
    on_base, on_child = (joint.point_i, joint.point_j)[:: 1 if forward else -1]
    opening = joint.opening(slides, z, base_angle if forward else angle)
    place = base[:2] + ca.mtimes(rotation(base_angle), on_base.local.sx)
    place += opening if forward else -opening
    place -= ca.mtimes(rotation(angle), on_child.local.sx)
    pose = ca.vertcat(place, angle) if child.rotates else place
    return PlanarLink(child, space, carrier, joint, z, own, own_value, pose)
