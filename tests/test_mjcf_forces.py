"""Limits of actuators, damping ratios, lifted weights and fitted shapes of MJCF beside MuJoCo."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from robots import imported

import dalembert as da

mujoco = pytest.importorskip("mujoco")

ARM = """<mujoco model="arm"><option gravity="0 0 -9"/>
  <worldbody><body name="a" pos="0 0 1" gravcomp="0.7"><joint name="h" axis="0 1 .2" ref="10"
      range="-90 90" armature=".1" {limit}/>
    <geom type="box" size=".3 .1 .1" pos=".4 .1 0"/>
    <body name="b" pos=".8 0 0" gravcomp="1.2"><joint name="s" type="slide" axis="1 0 .3"
        damping=".4" range="0 1"/>
      <geom type="capsule" size=".05 .2"/>
      <body name="c" pos="0 0 .4" gravcomp="1"><joint name="k" axis="1 0 0"/>
        <geom type="box" size=".1 .1 .2" pos="0 .1 .1"/>
        <body name="d" pos=".1 0 0" gravcomp=".5"><geom size=".1"/></body></body></body></body>
    <body name="free" pos="3 0 0" euler="10 20 30"><joint type="free" damping=".3"/>
      <geom type="box" size=".1 .2 .3" pos="0 .2 0"/></body></worldbody>
  <tendon><fixed name="t"><joint joint="h" coef="2"/><joint joint="k" coef="-1"/></fixed></tendon>
  <actuator>{actuators}</actuator></mujoco>"""
ACTUATORS = {
    "limited force": '<motor joint="h" gear="3" forcerange="-.5 .2"/>',
    "limited servo": '<position joint="h" kp="40" kv="3" gear="2" forcerange="-1 2"/>',
    "unlimited in spite of a range": '<motor joint="h" forcerange="-.5 .2" forcelimited="false"/>',
    "damping ratio": '<position joint="k" kp="40" dampratio="0.8"/>',
    "damping ratio of a slide with a gear": '<position joint="s" kp="9" dampratio="1" gear="4"/>',
    "damping ratio of a tendon": '<position tendon="t" kp="7" dampratio="1.5" gear="2"/>',
    "bounds from the joint": '<position joint="h" kp="10" inheritrange=".5"/>',
}


def accelerations(tmp_path: Path, text: str) -> tuple[np.ndarray, np.ndarray]:
    """Of the imported model and of MuJoCo's, in random states: bias forces by coordinates."""
    from benchmarks.imports.mujoco_peer import MujocoPeer

    path = tmp_path / "peer.xml"
    path.write_text(text)
    peer = MujocoPeer(path, tmp_path)
    assert peer.actuators
    own, reference = [], []
    for state, terms in peer.states(5):
        mass, bias, _, _ = peer.ours.terms(state)
        own.append(state.map.T @ (bias + mass @ state.drift))
        reference.append(terms[1])
    return np.array(own), np.array(reference)


@pytest.mark.few(4)
@pytest.mark.parametrize("actuators", ACTUATORS.values(), ids=ACTUATORS)
def test_forces_are_those_of_mujoco(tmp_path, actuators):
    text = ARM.format(limit="", actuators=actuators)
    own, reference = accelerations(tmp_path, text)
    assert np.abs(own - reference).max() < 1e-12 * np.abs(reference).max()
    omitted = {omission.content for omission in imported(tmp_path, text, "xml").omissions}
    assert omitted <= {"limits of joints", "<fixed>"}


def test_the_sum_of_the_forces_in_a_joint_is_limited(tmp_path):
    actuators = '<position joint="h" kp="40" forcerange="-1 9"/><motor tendon="t"/>'
    limit = 'actuatorfrcrange="-3 1"'
    own, reference = accelerations(tmp_path, ARM.format(limit=limit, actuators=actuators))
    assert np.abs(own - reference).max() < 1e-12 * np.abs(reference).max()
    other = 'actuatorfrcrange="-3 1" actuatorfrclimited="false"'
    unlimited, _ = accelerations(tmp_path, ARM.format(limit=other, actuators=actuators))
    assert np.abs(unlimited - own).max() > 1


def test_the_bounds_of_a_control_are_those_of_the_joint(tmp_path):
    text = ARM.format(limit="", actuators=ACTUATORS["bounds from the joint"])
    (table,) = imported(tmp_path, text, "xml").document["inputs"].values()
    path = tmp_path / "peer.xml"
    path.write_text(text)
    model = mujoco.MjModel.from_xml_path(str(path))
    assert table["bounds"] == pytest.approx(model.actuator_ctrlrange[0])


def test_a_welded_hand_leaves_the_coordinates_of_its_motors(tmp_path):
    """A loop is cut where no rotor needs the coordinate of the joint."""
    text = """<mujoco><worldbody><body name="target" mocap="true" pos=".9 0 1"/>
      <body name="a" pos="0 0 1"><joint name="h" axis="0 1 0" armature=".1"/>
        <geom type="box" size=".3 .1 .1" pos=".3 0 0"/>
        <body name="b" pos=".6 0 0"><joint name="k" axis="0 1 0" armature=".2"/>
          <geom type="box" size=".1 .1 .1" pos=".2 0 0"/></body></body></worldbody>
      <equality><weld body1="target" body2="b"/></equality></mujoco>"""
    model = imported(tmp_path, text, "xml").build()
    names = da.JointCoordinates().view(model).names
    assert {"h.angle", "k.angle"} <= set(names)


@pytest.mark.parametrize("box", ["false", "true"])
@pytest.mark.parametrize("kind", ["sphere", "capsule", "cylinder", "box", "ellipsoid"])
def test_shapes_fitted_to_a_mesh(tmp_path, kind, box):
    corners = np.random.default_rng(0).normal(size=(30, 3)) * [0.3, 0.1, 0.05] + [1, 2, 3]
    text = f"""<mujoco><compiler fitaabb="{box}"/><asset><mesh name="m" inertia="convex"
      vertex="{" ".join(map(str, corners.ravel()))}"/></asset><worldbody><body name="b">
      <freejoint/><geom type="{kind}" mesh="m" pos="1 0 0" euler="10 20 30" fitscale="1.1"/>
      </body></worldbody></mujoco>"""
    body = imported(tmp_path, text, "xml").document["bodies"]["b"]
    path = tmp_path / "peer.xml"
    path.write_text(text)
    model = mujoco.MjModel.from_xml_path(str(path))
    single = 1e-6  # meshes of MuJoCo have single precision
    assert body["mass"] == pytest.approx(model.body_mass[1], rel=single)
    assert body["center_of_mass"] == pytest.approx(model.body_ipos[1], rel=single)
    tensor = np.diag(body["inertia"][:3]).astype(float)
    for (i, j), product in zip([(0, 1), (1, 2), (0, 2)], body["inertia"][3:], strict=False):
        tensor[i, j] = tensor[j, i] = product
    moments = np.linalg.eigvalsh(tensor)[::-1]
    assert moments == pytest.approx(model.body_inertia[1], rel=single)


DRONE = """<mujoco><worldbody><body name="d" pos="0 0 1" euler="0 10 0"><freejoint/>
  <geom type="box" size=".2 .2 .05" pos="0 0 .02"/>
  <site name="left" pos="0 .3 0" euler="20 0 0"/><site name="right" pos="0 -.3 .1"/>
  <body name="fan" pos=".1 0 0"><geom size=".05"/><site name="tail" pos=".2 0 0"/></body>
  </body></worldbody><actuator>
  <motor site="left" gear="0 0 2 0 0 -.3"/><motor site="right" gear="1 0 2 0 0 .3"/>
  <general site="tail" gear="0 1 0" gainprm="3" biastype="affine" biasprm="1 0 0"/>
  </actuator></mujoco>"""


def test_forces_at_sites(tmp_path):
    document = imported(tmp_path, DRONE, "xml").document
    assert len(document["inputs"]) == 3
    controls = [0.7, -0.4, 1.3]
    for table, control in zip(document["inputs"].values(), controls, strict=True):
        table["value"] = control
    robot = imported(tmp_path, DRONE, "xml")
    robot.document.update(document)
    motion = da.solve_dynamics(robot.build(), 1e-6, step=1e-6)
    path = tmp_path / "peer.xml"
    path.write_text(DRONE)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    data.ctrl[:] = controls
    mujoco.mj_forward(model, data)
    axes = data.xmat[1].reshape(3, 3)
    spin = motion["d.angular_acceleration"][0].values
    assert motion["d.acceleration"][0].values == pytest.approx(data.qacc[:3], rel=1e-9)
    assert axes.T @ spin == pytest.approx(data.qacc[3:], rel=1e-9)


@pytest.mark.parametrize(
    "actuator",
    [
        '<position joint="h" kp="30" kv="2" timeconst=".1"/>',
        '<general joint="h" dyntype="filter" dynprm=".2" gainprm=".4"/>',
        '<general joint="h" dyntype="integrator" gainprm="4" biastype="affine" biasprm="0 -4 -1"/>',
    ],
)
def test_actuators_with_a_state(tmp_path, actuator):
    text = f"""<mujoco><option timestep="1e-4" integrator="RK4"/><worldbody>
      <body name="a"><joint name="h" axis="0 1 0" damping=".1"/>
      <geom type="box" size=".2 .05 .05" pos=".2 0 0"/></body></worldbody>
      <actuator>{actuator}</actuator></mujoco>"""
    robot = imported(tmp_path, text, "xml")
    (table,) = robot.document["inputs"].values()
    table["value"] = 0.6
    motion = da.solve_dynamics(robot.build(), 0.5)
    path = tmp_path / "peer.xml"
    path.write_text(text)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    data.ctrl[:] = 0.6
    for _ in range(5000):
        mujoco.mj_step(model, data)
    assert motion["h.angle"][-1].item() == pytest.approx(data.qpos[0], abs=1e-5)
