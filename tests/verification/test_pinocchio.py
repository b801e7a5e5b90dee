"""Forward dynamics of random trees against Pinocchio's articulated-body algorithm."""

from __future__ import annotations

import numpy as np
import pytest
from joint_views import accelerations
from scipy.spatial.transform import Rotation
from spatial_trees import SpatialTree

import dalembert as da
from dalembert import spatial
from dalembert.model.graph.tree.kinematic_tree import links_of

pin = pytest.importorskip("pinocchio", exc_type=ImportError)


PEERS = {
    spatial.Revolute: pin.JointModelRZ,
    spatial.Spherical: pin.JointModelSpherical,
    spatial.Prismatic: pin.JointModelPZ,
}


class Twin:
    """The same tree in Pinocchio; every body has its joint's frame for its own."""

    def __init__(self, model: da.Model):
        self.model = model
        start = model.start
        self.state = {}
        y, v = iter(start.y), iter(start.v)
        for body in model.bodies:
            pose = np.array([next(y) for _ in range(7)])
            twist = np.array([next(v) for _ in range(6)])
            axes = Rotation.from_quat(np.roll(pose[3:], -1)).as_matrix()
            self.state[body.name] = pose[:3], axes, twist[:3], twist[3:]
        self.state["ground"] = np.zeros(3), np.eye(3), np.zeros(3), np.zeros(3)
        self.tree, self.q, self.v = pin.Model(), [], []
        self.tree.gravity.linear = value(model.parts.gravity.sx)
        self.joints = {"ground": (0, np.eye(3), np.zeros(3))}
        for link in links_of(model.parts, (), False):
            self.add(link)

    def add(self, link) -> None:
        """One body, by the place of its joint in the carrier and in itself."""
        body, at_rest = link.group, (np.eye(3), np.zeros(3))
        carrier, near, far, kind = "ground", at_rest, at_rest, pin.JointModelFreeFlyer()
        if link.joint is not None:
            carrier = link.carrier.name
            sides = link.joint.end_frames()
            sides = sides if link.joint.ends()[1] is body else sides[::-1]
            near, far = (in_body(point) for point in sides)
            kind = PEERS[type(link.joint)]()
            stands = self.state[carrier][1].T @ self.state[body.name][1] @ far[0]
            if isinstance(link.joint, spatial.Prismatic):  # its frames are parallel there
                near = stands, near[1]
            elif near[0][:, 2] @ stands[:, 2] < 0 and isinstance(link.joint, spatial.Revolute):
                near = near[0] @ np.diag([1, -1, -1]), near[1]
        parent, axes, origin = self.joints[carrier]
        place = pin.SE3(axes.T @ near[0], axes.T @ (near[1] - origin))
        index = self.tree.addJoint(parent, kind, place, body.name)
        moments = value(body.inertia.sx)
        (xx, yy, zz, xy, yz, xz), axes = moments, far[0]
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        centre = axes.T @ (value(body.center_of_mass.sx) - far[1])
        mass = float(value(body.mass.sx)[0])
        self.tree.appendBodyToJoint(
            index, pin.Inertia(mass, centre, axes.T @ inertia @ axes), pin.SE3.Identity()
        )
        self.joints[body.name] = index, *far
        self.read(kind, link.carrier or self.model.ground, body, near, far)

    def at(self, body, local: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Place and velocity of a point of a body."""
        place, axes, velocity, spin = self.state[body.name]
        arm = local - (value(body.center_of_mass.sx) if body.name != "ground" else 0)
        return place + axes @ arm, velocity + axes @ np.cross(spin, arm)

    def read(self, kind, carrier, body, near, far) -> None:
        """Position and speeds in the joint, from those of the bodies."""
        _, axes, _, spin = self.state[carrier.name]
        _, own, _, turning = self.state[body.name]
        relative = (axes @ near[0]).T @ own @ far[0]
        rate = far[0].T @ (turning - own.T @ axes @ spin)
        quaternion = Rotation.from_matrix(relative).as_quat()
        if isinstance(kind, pin.JointModelRZ):
            self.q.append(np.arctan2(relative[1, 0], relative[0, 0]))
            self.v.append(rate[2])
        elif isinstance(kind, pin.JointModelPZ):
            (here, leaving), (there, arriving) = self.at(carrier, near[1]), self.at(body, far[1])
            axis = (axes @ near[0])[:, 2]
            self.q.append(axis @ (there - here))
            self.v.append(
                axis @ (arriving - leaving) + np.cross(axes @ spin, axis) @ (there - here)
            )
        elif isinstance(kind, pin.JointModelSpherical):
            self.q += list(quaternion)
            self.v += list(rate)
        else:
            origin, moving = self.at(body, np.zeros(3))
            self.q += [*origin, *quaternion]
            self.v += [*(own.T @ moving), *turning]

    def accelerations(self) -> np.ndarray:
        """``(r̈_C, ω̇')`` of every body, one after the other."""
        q, v, data = np.array(self.q), np.array(self.v), self.tree.createData()
        a = pin.aba(self.tree, data, q, v, np.zeros(v.size))
        pin.forwardKinematics(self.tree, data, q, v, a)
        computed = []
        for body in self.model.bodies:
            index, _, origin = self.joints[body.name]
            _, axes, _, spin = self.state[body.name]
            moved = pin.getClassicalAcceleration(
                self.tree, data, index, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
            )
            arm, w = axes @ (value(body.center_of_mass.sx) - origin), axes @ spin
            centre = moved.linear + np.cross(moved.angular, arm) + np.cross(w, np.cross(w, arm))
            computed += [*centre, *(axes.T @ moved.angular)]
        return np.array(computed)


def value(sx) -> np.ndarray:
    return np.array([float(x) for x in np.ravel(sx.elements() if hasattr(sx, "elements") else sx)])


def in_body(point) -> tuple[np.ndarray, np.ndarray]:
    axes = np.eye(3)
    if isinstance(point, spatial.Frame):
        axes = value(point.local_axes).reshape(3, 3, order="F")
    return axes, value(point.local.sx)


@pytest.mark.few(2)
@pytest.mark.parametrize("floating", [False, True])
@pytest.mark.parametrize("seed", range(5))
def test_random_trees(seed, floating):
    model = SpatialTree(seed).grow(7, [kind.__name__ for kind in PEERS], floating).system.build()
    _, _, computed, _ = accelerations(da.JointCoordinates().view(model), da.RangeSpace())
    expected = Twin(model).accelerations()
    np.testing.assert_allclose(computed, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
