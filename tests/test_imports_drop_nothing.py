"""Nothing of a robot file is dropped silently.

Each attribute, text and element is removed from a file in turn: the model, the omissions or the
error must change. The values in these files are no defaults.
"""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree import ElementTree

import pytest
from robots import ARM, imported

import dalembert as da

MASS = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>'
NO_DEFAULTS = ARM.replace('ixz="0"', 'ixz="0.03"').replace("1 0 0", "1 0.5 0")
URDF = NO_DEFAULTS.replace('lower="0"', 'lower="0.05"').replace(
    "</robot>",
    f"""<link name="x"><inertial><origin xyz="0 0 1" rpy="1 0 0"/><mass value="1"/>
      <inertia ixx="1" iyy="1.1" izz="1.2" ixy="0.1" ixz="0.1" iyz="0.1"/></inertial>
      <visual><origin xyz="0 0 1" rpy="0 1 0"/>
        <geometry><cylinder radius="1" length="2"/></geometry><material name="red"/></visual>
      <collision><origin xyz="0 0 2"/></collision></link>
    <joint name="jx" type="continuous"><parent link="tip"/><child link="x"/><origin xyz="0 0 1"/>
      <axis xyz="0 1 0"/><limit lower="1" upper="2" effort="1" velocity="2"/>
      <dynamics damping="1" friction="2"/><mimic joint="shoulder" multiplier="2" offset="1"/>
      <calibration rising="0"/><safety_controller k_velocity="1"/></joint>
    <link name="z">{MASS}</link>
    <joint name="jz" type="floating"><parent link="base"/><child link="z"/><origin xyz="0 0 1"/>
      <limit lower="1" upper="3" effort="1"/><dynamics damping="1" friction="2"/></joint>
    <link name="w">{MASS}</link>
    <joint name="jw" type="planar"><parent link="base"/><child link="w"/><axis xyz="0 1 0"/>
      <limit lower="1" upper="3" effort="1"/><dynamics damping="1" friction="2"/></joint>
    <transmission name="t"/><gazebo reference="x"><mu1>2</mu1></gazebo></robot>""",
)
MJCF = """<mujoco model="m">
  <compiler angle="radian" eulerseq="XYZ" inertiagrouprange="1 2" boundmass="5" settotalmass="50"/>
  <option timestep="0.01" gravity="0 0 -9" integrator="RK4" density="1"/><size njmax="3"/>
  <default><geom density="500" friction="1 2 3"/><motor ctrlrange="-3 3"/>
    <default class="big"><geom group="1"/><joint damping="2" armature="0.1" stiffness="4"
      springref="0.3" frictionloss="1" range="-1 2" margin="0.1" solreflimit="1 2"/></default>
  </default>
  <asset><mesh name="tet" vertex="0 0 0 1 0 0 0 1 0 0 0 1" scale="1 2 3" refpos="1 2 3"
    refquat="1 1 0 0" smoothnormal="true"/></asset>
  <worldbody><light pos="0 0 1"/><geom type="plane"/>
    <body name="a" pos="1 0 0" quat="1 1 0 0" childclass="big" gravcomp="1">
      <joint name="h" pos="0 0 1" axis="0 1 0" ref="0.1" actuatorfrcrange="-1 1"/>
      <geom type="box" size=".1 .2 .3" pos="1 0 0" euler="0.2 1 0.3" contype="1" conaffinity="2"
        condim="3" mass="2" margin="1" gap="2" solmix="1" priority="1" fluidshape="ellipsoid"/>
      <geom mesh="tet" density="3"/><geom size="0.1" group="3"/>
      <site name="s" pos="0 0 1" euler="1 0 0"/>
      <body name="b" pos="0 1 0"><joint name="k" type="slide" axis="1 0 0" springdamper="1 2"/>
        <geom type="capsule" fromto="0 0 0 1 0 0" size=".1"/>
        <inertial pos="1 0 0" mass="7" diaginertia="1 2 2.5" euler="1 0 0"/>
        <body name="b2" pos="0 0 1"><joint name="bb" type="ball" damping="1" pos="0 0 1"
          range="0 1"/><geom size=".3"/></body></body></body>
    <frame pos="0 0 3" euler="0 1 0"><body name="fr" pos="1 1 1"><freejoint/>
      <geom size=".3" pos="0 1 0" group="2"/></body></frame>
    <replicate count="2" offset="0 0 1" euler="0 0.1 0" sep="x" childclass="big">
      <body name="r" pos="5 5 5"><joint name="rj" axis="0 1 1"/><geom size=".1"/></body></replicate>
  </worldbody>
  <contact><exclude body1="a" body2="b"/></contact>
  <tendon><fixed name="ten"><joint joint="h" coef="2"/><joint joint="k" coef="3"/></fixed></tendon>
  <equality><connect name="c1" body1="b" body2="fr" anchor="0 0 1" solref="1 2" solimp="1 2 3"/>
    <joint name="eq" joint1="k" joint2="h" polycoef="0 1 .1 0 0"/>
    <weld name="off" body1="a" active="false"/></equality>
  <actuator><motor name="m" joint="h" gear="3" ctrlrange="-1 1" forcerange="-1 1"/>
    <position name="p" joint="h" kp="2" kv="1" timeconst="0.1"/>
    <general name="g" tendon="ten" gainprm="2 2 3" biasprm="1 2 3" gaintype="affine"
      biastype="affine" dynprm="1" actrange="0 1" lengthrange="0 1"/><muscle name="mu" joint="h"/>
  </actuator>
  <sensor><jointpos joint="h"/></sensor><keyframe><key/></keyframe><custom/></mujoco>"""
SDF = """<sdf><world name="w"><gravity>0 0 -9</gravity><magnetic_field>1 2 3</magnetic_field>
  <physics/><light/><plugin/><scene/>
  <model name="m" placement_frame="f"><self_collide>true</self_collide><enable_wind>1</enable_wind>
    <pose relative_to="world" degrees="true">1 2 3 40 50 60</pose>
    <frame name="f" attached_to="a"><pose>1 0 0 0 0 1</pose></frame>
    <link name="a"><pose relative_to="b">1 0 0 0 0 1</pose><gravity>false</gravity>
      <kinematic>true</kinematic><velocity_decay/>
      <inertial><pose>1 0 0 0 0 1</pose><mass>2</mass><density>3</density>
        <inertia><ixx>2</ixx><iyy>2.1</iyy><izz>2.2</izz><ixy>.1</ixy><ixz>.1</ixz><iyz>.1</iyz>
        </inertia><fluid_added_mass/></inertial>
      <visual><pose>1 0 0 0 0 0</pose><geometry><box><size>1 2 3</size></box></geometry>
        <material/></visual><collision/><sensor/></link>
    <link name="b"><pose>0 3 0 0 0 0</pose></link><link name="c"><pose>0 0 1 0 0 0</pose></link>
    <link name="d"><pose>0 0 2 0 0 0</pose></link>
    <joint name="j" type="revolute"><pose relative_to="f">1 0 0 0 0 0</pose>
      <parent>b</parent><child>a</child><thread_pitch>1</thread_pitch>
      <axis><xyz expressed_in="b">0 1 0</xyz><initial_position>1</initial_position>
        <limit><lower>-1</lower><upper>1</upper><effort>1</effort><stiffness>1</stiffness></limit>
        <dynamics><damping>1</damping><friction>1</friction><spring_stiffness>1</spring_stiffness>
          <spring_reference>1</spring_reference></dynamics></axis><axis2/><physics/></joint>
    <joint name="u" type="universal"><parent>b</parent><child>c</child>
      <axis><xyz>0 1 0</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis>
      <axis2><xyz>1 0 0</xyz><mimic joint="j"><multiplier>2</multiplier><offset>1</offset>
        <reference>.1</reference></mimic></axis2></joint>
    <joint name="bl" type="ball"><pose>0 1 0 0 0 0</pose><parent>c</parent><child>d</child>
      <axis/></joint><gripper/></model><state/></world></sdf>"""
LISTED = ("weld", "muscle")
"""Elements of the samples that are listed as a whole, without their tag."""


def variants(text: str) -> Iterator[tuple[ElementTree.Element, str, str]]:
    """Files without one attribute, text or element: the element, the part, the file."""
    count = sum(1 for _ in ElementTree.fromstring(text).iter())
    for k in range(count):
        element = list(ElementTree.fromstring(text).iter())[k]
        parts = [*element.attrib, *(["text"] if (element.text or "").strip() else [])]
        for part in [*parts, *([""] if k else [])]:
            root = ElementTree.fromstring(text)
            changed = list(root.iter())[k]
            if part in element.attrib:
                del changed.attrib[part]
            elif part:
                changed.text = ""
            else:
                next(p for p in root.iter() if changed in list(p)).remove(changed)
            yield element, part, ElementTree.tostring(root, encoding="unicode")


def contents(robot: da.Imported) -> tuple[str, list[str]]:
    lines = [line for line in robot.text.splitlines() if "Not converted" not in line]
    return "\n".join(lines), sorted(omission.content for omission in robot.omissions)


@pytest.mark.parametrize(("suffix", "text"), [("urdf", URDF), ("xml", MJCF), ("sdf", SDF)])
def test_nothing_is_dropped_silently(tmp_path, suffix, text):
    reference = imported(tmp_path, text, suffix)
    whole = contents(reference)
    listed = {*LISTED, *(omission.content[1:-1] for omission in reference.omissions)}
    root = ElementTree.fromstring(text)
    inner = {c.tag for e in root.iter() if e.tag in listed for c in e.iter() if c is not e}
    silent = []
    for element, part, changed in variants(text):
        if element.tag in inner or (part and element.tag in listed):
            continue  # in an element that is listed as a whole
        try:
            same = contents(imported(tmp_path, changed, suffix)) == whole
        except da.DalembertError:
            continue
        if same and (element.tag, part) != ("world", "name"):
            silent.append(f"<{element.tag} {element.attrib}> {part}")
    assert not silent, "\n".join(silent)
