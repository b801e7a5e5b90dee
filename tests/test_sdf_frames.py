"""Poses of SDF: the same tree, written in several ways, is the model of the URDF file."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from robots import imported
from scipy.spatial.transform import Rotation

import dalembert as da

STYLES = ("relative", "absolute", "frames", "nested", "axes of the model", "quaternions")
CHAIN = (
    ("revolute", (0.3, -1.0, 0.5), (0.2, 0.1, 0.4), (0.3, -0.7, 1.1), (0.1, 0.05, -0.2), 0),
    ("prismatic", (1.0, 0.2, 0.0), (-0.3, 0.2, 0.1), (1.2, 0.4, -0.5), (0.0, 0.1, 0.3), 1),
    ("revolute", (0.0, 0.4, 1.0), (0.5, 0.0, -0.2), (-0.6, 0.9, 0.2), (0.2, 0.0, 0.1), 2),
    ("revolute", (1.0, 1.0, 1.0), (0.1, -0.4, 0.3), (2.0, 0.3, -0.9), (-0.1, 0.2, 0.0), 1),
)
"""Joints with axis, position, roll-pitch-yaw, mass centre and number of the carrying link."""
MOMENTS = (0.2, 0.3, 0.4)


def numbers(values) -> str:
    return " ".join(f"{value:.17g}" for value in values)


def urdf() -> str:
    text = '<robot name="m"><link name="l0"/>'
    for k, (kind, axis, xyz, rpy, center, parent) in enumerate(CHAIN, 1):
        text += (
            f'<link name="l{k}"><inertial><origin xyz="{numbers(center)}"/><mass value="{k}"/>'
            '<inertia ixx="0.2" iyy="0.3" izz="0.4"/></inertial></link>'
            f'<joint name="j{k}" type="{kind}"><parent link="l{parent}"/><child link="l{k}"/>'
            f'<origin xyz="{numbers(xyz)}" rpy="{numbers(rpy)}"/><axis xyz="{numbers(axis)}"/>'
            "</joint>"
        )
    return text + "</robot>"


def pose(place, turn: Rotation, attributes: str = "", style: str = "") -> str:
    if style == "quaternions":
        attributes += ' rotation_format="quat_xyzw"'
        return f"<pose{attributes}>{numbers([*place, *turn.as_quat()])}</pose>"
    return f"<pose{attributes}>{numbers([*place, *turn.as_euler('xyz')])}</pose>"


def sdf(style: str) -> str:
    """The tree, whose root is fixed to the world."""
    places, turns = [np.zeros(3)], [Rotation.identity()]
    links, joints, frames, inner = ['<link name="l0"/>'], [], [], []
    for k, (kind, axis, xyz, rpy, center, parent) in enumerate(CHAIN, 1):
        own = Rotation.from_euler("xyz", rpy)
        place, turn = places[parent] + turns[parent].apply(xyz), turns[parent] * own
        places.append(place)
        turns.append(turn)
        moments = "".join(f"<i{a}{a}>{m}</i{a}{a}>" for a, m in zip("xyz", MOMENTS, strict=True))
        inertial = (
            f"<inertial>{pose(center, Rotation.identity())}<mass>{k}</mass>"
            f"<inertia>{moments}</inertia></inertial>"
        )
        ends = f"<parent>l{parent}</parent><child>l{k}</child>"
        joint_pose, direction = "", f"<xyz>{numbers(axis)}</xyz>"
        if style == "relative":
            joint_pose = pose(xyz, own, f' relative_to="l{parent}"')
            link_pose = f'<pose relative_to="j{k}"/>'
        elif style == "frames":
            frames.append(
                f'<frame name="f{k}" attached_to="l{parent}">{pose(xyz, own)}</frame>'
                f'<frame name="g{k}" attached_to="f{k}"/><frame name="e{k}" attached_to="l{k}"/>'
            )
            link_pose = f'<pose relative_to="g{k}"/>'
            ends = f"<parent>g{k}</parent><child>e{k}</child>"
        else:
            link_pose = pose(place, turn, style=style)
        if style == "axes of the model":
            direction = f'<xyz expressed_in="__model__">{numbers(turn.apply(axis))}</xyz>'
        link = f'<link name="l{k}">{link_pose}{inertial}</link>'
        if style == "nested" and k == len(CHAIN):
            base = Rotation.from_euler("xyz", (0.4, 0.5, 0.6))
            at = np.array([0.3, 0.2, 0.1])
            local = pose(base.inv().apply(place - at), base.inv() * turn)
            inner.append(
                f'<model name="inner">{pose(at, base)}<link name="l{k}">{local}{inertial}</link>'
                "</model>"
            )
            link, ends = "", f"<parent>l{parent}</parent><child>inner::l{k}</child>"
        links.append(link)
        joints.append(
            f'<joint name="j{k}" type="{kind}">{joint_pose}{ends}<axis>{direction}</axis></joint>'
        )
    fixed = '<joint name="mount" type="fixed"><parent>world</parent><child>l0</child></joint>'
    body = "".join([*joints, *frames, *links, *inner, fixed])
    gravity = "<gravity>0 0 -9.81</gravity>"
    return (
        f'<sdf version="1.9"><world name="w">{gravity}<model name="m">{body}</model></world></sdf>'
    )


def terms(model, seed: int) -> list[np.ndarray]:
    """Mass matrix and forces in joint coordinates at a random state."""
    view = da.JointCoordinates().view(model, every_equation=True)
    e, rng = view.equations, np.random.default_rng(seed)
    function = ca.Function("f", [e.t, e.y, e.v, e.p], [e.inertia.matrix, e.bias - e.force])
    order = np.argsort([name.partition(".")[0] for name in view.names])
    y, v = np.zeros(len(order)), np.zeros(len(order))
    y[order], v[order] = rng.normal(size=len(order)), rng.normal(size=len(order))
    mass, force = (np.array(value) for value in function(0.0, y, v, model.nominal))
    return [mass[np.ix_(order, order)], force[order]]


@pytest.mark.few(3)
@pytest.mark.parametrize("style", STYLES)
def test_every_style_is_the_same_model(tmp_path, style):
    reference = imported(tmp_path, urdf()).build()
    robot = imported(tmp_path, sdf(style), "sdf")
    assert robot.omissions == []
    model = robot.build()
    for seed in range(3):
        for computed, expected in zip(terms(model, seed), terms(reference, seed), strict=True):
            np.testing.assert_allclose(computed, expected, atol=1e-12 * np.abs(expected).max())
