"""URDF files: Pinocchio loads them, and its equations of motion of trees are ours."""

from __future__ import annotations

from xml.etree import ElementTree as xml

import numpy as np
import pytest
from registry import CASES, model_of
from robot_states import OurEquations
from test_export_mjcf import BUILT

import dalembert as da
from dalembert import spatial
from dalembert.elements.joint_forces import JointFriction
from dalembert.io.exports.registry import FORMATS
from dalembert.io.exports.rigid.start import Start

pin = pytest.importorskip("pinocchio")
EXACT = 1e-9
FORCELESS = ("programs that read URDF", "three joints about")
"""Omissions that do not change the tree."""


def written(model: da.Model):
    """Model of Pinocchio, and the omissions."""
    files = FORMATS["urdf"].create(model, "m", {})
    text = files.files["m.urdf"].decode()
    return pin.buildModelFromXML(text), files.omissions


class Twin:
    """Pinocchio's model in states of ours."""

    def __init__(self, model: da.Model):
        self.model = model
        self.m, self.omissions = written(model)
        self.d = self.m.createData()
        self.frames = {b.name: self.m.getFrameId(b.name, pin.FrameType.BODY) for b in model.bodies}
        self.centers = centers(model)

    def rows(self, q: np.ndarray, v: np.ndarray, rate: bool = False) -> np.ndarray:
        """Jacobian of our speeds, or its product with the speeds in its rate."""
        rows = []
        if rate:
            pin.forwardKinematics(self.m, self.d, q, v, 0 * v)
        else:
            pin.computeJointJacobians(self.m, self.d, q)
        pin.updateFramePlacements(self.m, self.d)
        for body in self.model.bodies:
            frame = self.frames[body.name]
            place = self.d.oMf[frame]
            arm = place.rotation @ self.centers[body.name]
            if rate:
                a = pin.getFrameClassicalAcceleration(
                    self.m, self.d, frame, pin.LOCAL_WORLD_ALIGNED
                )
                w = pin.getFrameVelocity(self.m, self.d, frame, pin.LOCAL_WORLD_ALIGNED).angular
                linear = a.linear + np.cross(a.angular, arm) + np.cross(w, np.cross(w, arm))
                angular = a.angular
            else:
                j = pin.getFrameJacobian(self.m, self.d, frame, pin.LOCAL_WORLD_ALIGNED)
                j = j.reshape(6, -1)
                linear, angular = j[:3] + np.cross(j[3:].T, arm).T, j[3:]
            angular = place.rotation.T @ angular
            if body.dimension == 2:
                part = np.concatenate([linear[:2], angular[2:]]) if body.rotates else linear[:2]
            else:
                part = np.concatenate([linear, angular]) if body.rotates else linear
            rows.append(part)
        return np.concatenate(rows)

    def coordinates(self, q: np.ndarray) -> np.ndarray:
        """Our coordinates at a position of Pinocchio; planar angles up to full turns."""
        pin.framesForwardKinematics(self.m, self.d, q)
        parts = []
        for body in self.model.bodies:
            frame = self.d.oMf[self.frames[body.name]]
            place = frame.translation + frame.rotation @ self.centers[body.name]
            if body.dimension == 2:
                angle = np.arctan2(frame.rotation[1, 0], frame.rotation[0, 0])
                parts.append([*place[:2], angle] if body.rotates else place[:2])
            else:
                e = pin.Quaternion(frame.rotation).coeffs()
                parts.append([*place, e[3], *e[:3]] if body.rotates else place)
        return np.concatenate(parts)


def centers(model: da.Model) -> dict[str, np.ndarray]:
    """Mass centre of each link in its frame, as the file states them."""
    root = xml.fromstring(FORMATS["urdf"].create(model, "m", {}).files["m.urdf"])
    return {
        link.get("name"): np.array(
            [float(x) for x in link.find("inertial/origin").get("xyz").split()]
        )
        for link in root.findall("link")
        if link.find("inertial") is not None
    }


def check_tree(model: da.Model) -> None:
    twin, ours, rng = Twin(model), OurEquations(model), np.random.default_rng(5)
    gravity = model.parts.gravity
    vector = np.zeros(3)
    if gravity is not None:
        (values,) = Start(model).values(gravity.sx)
        vector[: values.size] = values
    twin.m.gravity = pin.Motion(vector, np.zeros(3))
    assert twin.m.nv == model.diagnosis.degrees_of_freedom
    for _ in range(20):
        q = pin.integrate(twin.m, pin.neutral(twin.m), rng.normal(size=twin.m.nv))
        v = rng.normal(size=twin.m.nv)
        y = twin.coordinates(q)
        d = twin.rows(q, v)
        drift = twin.rows(q, v, rate=True)
        terms = ours.terms(0.0, y, d @ v, ours.p)
        mass, force = terms[0].full(), terms[1].full().ravel()
        expected = d.T @ mass @ d
        upper = np.triu(pin.crba(twin.m, twin.d, q))
        actual = upper + np.triu(upper, 1).T
        assert np.abs(actual - expected).max(initial=0.0) <= EXACT * np.abs(actual).max(initial=1.0)
        bias = pin.rnea(twin.m, twin.d, q, v, 0 * v)
        balance = d.T @ (mass @ drift - force)
        scale = np.abs(bias).max(initial=1.0)
        assert np.abs(balance - bias).max(initial=0.0) <= EXACT * scale


@pytest.mark.few(15)
@pytest.mark.parametrize("name", CASES)
def test_every_case_is_loaded_and_trees_have_our_equations(name):
    model = model_of(name)
    m, omissions = written(model)
    exact = all(any(text in o.reason for text in FORCELESS) for o in omissions)
    exact = exact and not any(isinstance(f, JointFriction) for f in model.forces)
    exact = exact and m.nv == model.diagnosis.degrees_of_freedom
    assert m.nv >= 0 and all(o.place and o.reason for o in omissions)
    if exact:
        check_tree(model)


def tree_in_space() -> da.System:
    system = da.System("tree", gravity=(0.3, -1.0, -9.0))
    a = spatial.Box("a", size=(0.2, 0.1, 0.3), mass=2.0, position=(0.1, 0, 0))
    skew = da.rotation.axis_angle((1, 2, 3), 0.7)
    b = spatial.Body(
        "b",
        mass=1.0,
        inertia=(0.1, 0.2, 0.15, 0.01, -0.02, 0.01),
        rotation=skew,
        center_of_mass=(0.1, 0.2, -0.1),
        position=(0.1, 0, 0.5),
    )
    system.add(a)
    system.add(b)
    frames = a.frame((0, 0, 0.25), axis=(1, 0, 1)), b.frame((0, 0.1, -0.25), axis=(0, 1, 1))
    system.add(spatial.Universal("U", *frames))
    ends = system.ground.frame((0, 0.2, 0), axis=(0, 1, 0)), a.frame((-0.1, 0, 0), axis=(0, 1, 0))
    system.add(spatial.Cylindrical("H", *ends))
    return system


def test_a_tree_in_space_has_our_equations():
    check_tree(tree_in_space().build())


def test_loops_are_constraints_and_ratios_are_mimics(tmp_path):
    written_file = da.export(BUILT["four hinges spherical"]().build(), tmp_path / "loop.urdf")
    text = written_file.files[0].read_text()
    assert '<constraint name="last" type="spherical">' in text
    assert "not exported: last: Spherical in a loop" in text
    assert {path.suffix for path in written_file.files[1:]} == {".stl"}
    model = model_of("spatial coupling")
    root = xml.fromstring(FORMATS["urdf"].create(model, "m", {}).files["m.urdf"])
    (mimic,) = root.iter("mimic")
    joint = next(j for j in root.iter("joint") if j.find("mimic") is not None)
    assert {joint.get("name"), mimic.get("joint")} <= {j.get("name") for j in root.iter("joint")}
