"""Imported robots: numbers, loops, names, omissions, model files, command."""

from __future__ import annotations

import json
import math
import tomllib

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from robots import ARM, BARS, MOMENT, four_bar, imported

import dalembert as da
from dalembert import spatial
from dalembert.cli import main


def at_start(model, name: str) -> np.ndarray:
    """A measure at the assembled start."""
    return da.solve_dynamics(model, 1e-3, step=1e-3)[name][0].values


def test_arm_becomes_a_readable_model(tmp_path):
    arm = imported(tmp_path, ARM)
    bodies, joints = arm.document["bodies"], arm.document["joints"]
    assert list(bodies) == ["upper", "tip"] and list(joints) == ["shoulder", "slide"]
    assert joints["shoulder"]["connect"] == ["ground.shoulder", "upper.shoulder"]
    assert bodies["tip"]["frames"]["tool"] == {"at": [0.1, 0.0, 0.0]}
    assert bodies["upper"]["geometry"] == [{"type": "Box", "size": [0.4, 0.1, 0.1]}]
    assert arm.document["forces"]["shoulder_friction"]["viscous"] == 0.3
    contents = {omission.content for omission in arm.omissions}
    assert contents == {"limit effort", "limit velocity", "limits of joints"}
    model = arm.build()
    assert model.diagnosis.degrees_of_freedom == 2
    assert at_start(model, "shoulder.angle") == pytest.approx(0.0, abs=1e-14)
    np.testing.assert_allclose(at_start(model, "tip.tool.position"), [0, 0.5, 1], atol=1e-14)


def test_written_file_is_the_same_model(tmp_path, capsys):
    path = tmp_path / "arm.urdf"
    path.write_text(ARM, encoding="utf-8")
    target = tmp_path / "arm.toml"
    assert main(["import", str(path), "-o", str(target), "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["sections"]["bodies"] == 2 and len(summary["omissions"]) == 4
    assert tomllib.loads(target.read_text(encoding="utf-8")) == da.import_model(path).document
    assert main(["check", str(target)]) == 0
    assert main(["import", str(path), "-o", str(target)]) == 2  # never replaced without --force
    assert main(["import", str(path), "-o", str(target), "--stops", "1e4", "--force"]) == 0
    assert '[forces.shoulder_stop]\ntype = "Stop"' in target.read_text(encoding="utf-8")


def direct_four_bar():
    """The parallelogram in Python."""
    system = da.System("four-bar", gravity=(0, 0, -9.81))
    y = {"axis": (0, 1, 0)}
    bars = {
        name: system.add(
            spatial.Body(
                name,
                mass=mass,
                inertia=(MOMENT,) * 3,
                center_of_mass=center,
                position=place,
                rotation=da.rotation.bryant(0, 0, 0),
            )
        )
        for name, (mass, center, place) in BARS.items()
    }
    crank, coupler, rocker = bars.values()
    system.add(spatial.Revolute("O1", system.ground.frame(**y), crank.frame(**y)))
    system.add(spatial.Revolute("A", crank.frame((0, 0, 0.5), **y), coupler.frame(**y)))
    system.add(spatial.Revolute("O2", system.ground.frame((1, 0, 0), **y), rocker.frame(**y)))
    system.add(spatial.Spherical("B", coupler.point(1, 0, 0), rocker.point(0, 0, 0.5)))
    return system.build()


@pytest.mark.few(2)
@pytest.mark.parametrize("kind", ["urdf", "xml", "sdf"])
def test_loops_move_like_a_direct_model(kind, tmp_path):
    robot = imported(tmp_path, four_bar(kind), kind)
    assert robot.omissions == []
    model = robot.build()
    assert model.diagnosis.degrees_of_freedom == 1
    runs = [
        da.solve_dynamics(m, 0.5, step=0.01, coordinates=da.JointCoordinates())
        for m in (model, direct_four_bar())
    ]
    for name in ("crank.angular_velocity", "coupler.position", "B.force"):
        np.testing.assert_allclose(*(run[name].values for run in runs), atol=1e-8)


angles = st.floats(-3.0, 3.0).map(lambda a: round(a, 6))
vectors = st.tuples(*[st.floats(-1.0, 1.0).map(lambda x: round(x, 6))] * 3)
axes = vectors.filter(lambda v: math.hypot(*v) > 0.1)
kinds = st.sampled_from(["revolute", "prismatic"])
chains = st.lists(
    st.tuples(kinds, axes, vectors, st.tuples(angles, angles, angles), vectors, st.integers(0, 9)),
    min_size=1,
    max_size=4,
)


def urdf_of(chain) -> str:
    """URDF of random links, each carried by an earlier one."""
    links, joints = ['<link name="l0"/>'], []
    for k, (kind, axis, xyz, rpy, center, parent) in enumerate(chain, 1):
        texts = [" ".join(map(str, numbers)) for numbers in (center, xyz, rpy, axis)]
        links.append(
            f'<link name="l{k}"><inertial><origin xyz="{texts[0]}"/><mass value="{k}"/>'
            '<inertia ixx="0.2" iyy="0.3" izz="0.4"/></inertial></link>'
        )
        joints.append(
            f'<joint name="j{k}" type="{kind}"><parent link="l{parent % k}"/><child link="l{k}"/>'
            f'<origin xyz="{texts[1]}" rpy="{texts[2]}"/><axis xyz="{texts[3]}"/></joint>'
        )
    return f'<robot name="random">{"".join(links + joints)}</robot>'


def direct(chain):
    """The same links in Python."""
    system = da.System("random", gravity=(0, 0, -9.81))
    bodies: list = [system.ground]
    for k, (kind, axis, xyz, rpy, center, parent) in enumerate(chain, 1):
        body = spatial.Body(f"l{k}", mass=k, inertia=(0.2, 0.3, 0.4), center_of_mass=center)
        bodies.append(system.add(body))
        turn = da.rotation.euler("zyx", *reversed(rpy))
        rows = np.array(ca.DM(turn.matrix))
        helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
        base = bodies[parent % k].frame(xyz, axis=tuple(rows @ axis), x=tuple(rows @ helper))
        types = {"revolute": spatial.Revolute, "prismatic": spatial.Prismatic}
        system.add(types[kind](f"j{k}", base, body.frame(axis=axis, x=tuple(helper))))
    return system.build()


@pytest.mark.thorough
@settings(deadline=None, max_examples=8)
@given(chains)
def test_random_trees_equal_direct_models(tmp_path_factory, chain):
    model = imported(tmp_path_factory.mktemp("tree"), urdf_of(chain)).build()
    names = [f"l{k}.{m}" for k in range(1, len(chain) + 1) for m in ("position", "acceleration")]
    for coordinates in (da.JointCoordinates(), da.AbsoluteCoordinates()):
        runs = [
            da.solve_dynamics(m, 0.01, step=0.01, coordinates=coordinates)
            for m in (model, direct(chain))
        ]
        for name in names:
            first, second = (run[name].values for run in runs)
            np.testing.assert_allclose(first, second, atol=1e-8 * max(1.0, np.abs(second).max()))


def test_mimic_joints_are_coupled(tmp_path):
    mimic = '<mimic joint="shoulder" multiplier="0.1" offset="0.05"/>'
    text = ARM.replace('<limit lower="0" upper="0.2"/>', mimic)
    model = imported(tmp_path, text).build()
    assert model.diagnosis.degrees_of_freedom == 1
    motion = da.solve_dynamics(model, 0.5, step=0.01)
    expected = 0.05 + 0.1 * motion["shoulder.angle"].values
    np.testing.assert_allclose(motion["slide.displacement"].values, expected, atol=1e-9)


def test_free_base_falls(tmp_path):
    mass = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>'
    text = ARM.replace('<link name="base"/>', f'<link name="base">{mass}</link>')
    model = imported(tmp_path, text, base="free").build()
    assert model.diagnosis.degrees_of_freedom == 8
    motion = da.solve_dynamics(model, 0.1, step=0.05)
    assert motion["base.az"][0].item() == pytest.approx(-9.81)


def test_floating_links_start_at_their_joint(tmp_path):
    text = """<robot name="m"><link name="base"/><link name="stand"/><link name="box"><inertial>
      <mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
      <joint name="a" type="fixed"><parent link="base"/><child link="stand"/>
        <origin xyz="1 0 0" rpy="0 0 1.5707963267948966"/></joint>
      <joint name="b" type="floating"><parent link="stand"/><child link="box"/>
        <origin xyz="2 0 3"/></joint></robot>"""
    model = imported(tmp_path, text).build()
    np.testing.assert_allclose(at_start(model, "box.position"), [1, 2, 3], atol=1e-14)


@pytest.mark.thorough
def test_universal_joints_of_sdf_are_two_hinges(tmp_path):
    """Two hinges with a massless link between them, the second one coupled to a slide."""
    moments = "<ixx>0.2</ixx><iyy>0.3</iyy><izz>0.4</izz>"
    sdf = f"""<sdf version="1.9"><world name="w"><gravity>0 0 -9.81</gravity><model name="m">
      <link name="b"><inertial><pose>0.1 0.2 0.3 0 0 0</pose><mass>2</mass>
        <inertia>{moments}</inertia></inertial></link>
      <link name="c"><inertial><mass>1</mass><inertia>{moments}</inertia></inertial></link>
      <joint name="u" type="universal"><parent>world</parent><child>b</child>
        <axis><xyz>1 0.2 0</xyz></axis><axis2><xyz>0 1 0.4</xyz></axis2></joint>
      <joint name="s" type="prismatic"><parent>b</parent><child>c</child><axis><xyz>0 0 1</xyz>
        <mimic joint="u" axis="axis2"><multiplier>0.5</multiplier></mimic></axis></joint>
      </model></world></sdf>"""
    mass = '<mass value="{}"/><inertia ixx="0.2" iyy="0.3" izz="0.4"/>'
    urdf = f"""<robot name="m"><link name="w"/><link name="a"/>
      <link name="b"><inertial><origin xyz="0.1 0.2 0.3"/>{mass.format(2)}</inertial></link>
      <link name="c"><inertial>{mass.format(1)}</inertial></link>
      <joint name="u1" type="continuous"><parent link="w"/><child link="a"/>
        <axis xyz="1 0.2 0"/></joint>
      <joint name="u2" type="continuous"><parent link="a"/><child link="b"/>
        <axis xyz="0 1 0.4"/></joint>
      <joint name="s" type="prismatic"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
        <mimic joint="u2" multiplier="0.5"/></joint></robot>"""
    models = [imported(tmp_path, sdf, "sdf").build(), imported(tmp_path, urdf).build()]
    first, second = (da.solve_dynamics(model, 0.3, step=0.01) for model in models)
    assert models[0].diagnosis.degrees_of_freedom == 2
    for name in ("b.position", "c.position", "b.angular_velocity"):
        np.testing.assert_allclose(first[name].values, second[name].values, atol=1e-9)


def test_mjcf_defaults_frames_copies_and_keyframes(tmp_path):
    text = """<mujoco model="m"><compiler angle="radian" eulerseq="XYZ"/>
      <default><geom density="500"/><default class="big"><geom size="0.2"/>
        <joint damping="2" armature="0.1" springref="0.3" stiffness="4"/></default></default>
      <worldbody><frame pos="0 0 1" childclass="big"><body name="a"><joint name="h" axis="0 1 0"/>
        <geom/></body></frame>
        <replicate count="3" offset="1 0 0"><body name="b"><joint name="s" type="slide"/>
        <geom size="0.1"/></body></replicate></worldbody>
      <equality><joint joint1="s1" joint2="s0" polycoef="0 1 0.5 0 0"/></equality>
      <actuator><position name="servo" joint="h" kp="7" ctrlrange="-1 1"/></actuator>
      <keyframe><key name="up" qpos="0.5 0.1 0.105 0.2"/></keyframe></mujoco>"""
    robot = imported(tmp_path, text, "xml", keyframe="up")
    document = robot.document
    assert document["bodies"]["a"]["mass"] == pytest.approx(500 * 4 / 3 * math.pi * 0.2**3)
    assert document["joints"]["s1_coupling"]["formula"] == (
        "s1.displacement - (0.0 + 1.0*s0.displacement + 0.5*s0.displacement**2)"
    )
    assert document["forces"]["h_rotor"]["inertia"] == 0.1
    assert document["inputs"]["servo"] == {"value": 0.0, "bounds": [-1.0, 1.0]}
    assert document["forces"]["servo_force"]["value"] == "7.0*servo - 7.0*h.angle"
    model = robot.build()
    for name, value in {"h.angle": 0.5, "s0.displacement": 0.1, "b2.x": 2.0}.items():
        assert at_start(model, name) == pytest.approx(value, abs=1e-12)


def test_every_attribute_is_read_or_listed(tmp_path):
    text = ARM.replace('name="shoulder"', 'name="shoulder" colour="red"')
    text = text.replace("</robot>", '<plant height="3"><leaf/></plant></robot>')
    omissions = imported(tmp_path, text).omissions
    listed = {(o.content, o.place.partition(": ")[2]) for o in omissions}
    assert ("joint colour", '<joint name="shoulder">') in listed
    assert ("<plant>", "<plant>") in listed


def test_names_become_valid_and_stay_unique(tmp_path):
    text = ARM.replace('"upper"', '"1-left.arm"').replace('name="slide"', 'name="1_left_arm"')
    text = text.replace('name="arm"', 'name="\u202earm"', 1)
    robot = imported(tmp_path, text)
    assert robot.document["name"] == "\\u202earm"
    assert list(robot.document["bodies"]) == ["n1_left_arm", "tip"]
    assert list(robot.document["joints"]) == ["shoulder", "n1_left_arm_joint"]
    assert robot.build().diagnosis.degrees_of_freedom == 2
