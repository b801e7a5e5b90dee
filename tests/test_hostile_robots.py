"""Damaged and hostile robot files: one message with file, line and remedy, exit code 2."""

from __future__ import annotations

import json
from contextlib import suppress

import pytest
from hypothesis import given, settings, strategies as st
from robots import ARM, four_bar, imported

import dalembert as da
from dalembert.cli import main

BOMB = """<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>
<robot name="&b;"/>"""
OUTSIDE = """<!DOCTYPE r [<!ENTITY secret SYSTEM "file:///etc/passwd">]><robot name="&secret;"/>"""


def changed(old: str, new: str, text: str = ARM) -> str:
    assert old in text
    return text.replace(old, new, 1)


URDF = {
    "bomb": (BOMB, "document types and entities"),
    "external entity": (OUTSIDE, "document types and entities"),
    "document type": ('<!DOCTYPE robot SYSTEM "x.dtd">' + ARM, "document types and entities"),
    "empty": ("", "empty"),
    "text": ("robot", "not valid XML"),
    "open": (ARM[:300], "not valid XML"),
    "binary": (b"\x00\xff\xfe\x01" * 50, "not valid XML"),
    "encoding": (b'<?xml version="1.0" encoding="klingon"?><robot/>', "XML"),
    "wrong bytes": (b'<robot name="\xe9"/>', "not valid XML"),
    "root": ("<mujoco/>", "expected <robot>"),
    "no link": ("<robot name='x'/>", "has no <link>"),
    "deep": ("<a>" * 10_000, "nested more than"),
    "nan": (changed('value="2"', 'value="nan"'), "finite number"),
    "infinite": (changed('value="2"', 'value="1e999"'), "finite number"),
    "huge": (changed('value="2"', 'value="1e300"'), "finite number"),
    "words": (changed('value="2"', 'value="two"'), "finite number"),
    "underscore": (changed('value="2"', 'value="1_0"'), "finite number"),
    "template": (changed('value="2"', 'value="${mass}"'), "xacro"),
    "unprocessed template": (
        changed("</robot>", '<xacro:leg xmlns:xacro="x" side="left"/></robot>'),
        "xacro model.urdf > converted.urdf",
    ),
    "template name": (changed('link="base"', 'link="$(arg base)"'), "template"),
    "two numbers": (changed('value="2"', 'value="1 2"'), "expected 1 number"),
    "negative mass": (changed('value="2"', 'value="-2"'), "not negative"),
    "inertia": (changed('izz="0.25"', 'izz="2.5"'), "--repair-inertia"),
    "negative inertia": (changed('ixx="0.1"', 'ixx="-0.1"'), "--repair-inertia"),
    "no axis": (changed('xyz="0 1 0"', 'xyz="0 0 0"'), "no direction"),
    "no name": (changed('<link name="tip">', "<link>"), "name is missing"),
    "no parent": (changed('<parent link="base"/>', ""), "has no <parent>"),
    "two parents": (
        changed('<parent link="base"/>', '<parent link="base"/>' * 2),
        "second <parent>",
    ),
    "unknown link": (
        changed('<parent link="base"/>', '<parent link="bose"/>'),
        "no link of this file",
    ),
    "unknown type": (changed('type="revolute"', 'type="revolve"'), "unknown type"),
    "duplicate link": (changed('name="tool"', 'name="tip"'), "already"),
    "duplicate joint": (changed('name="mount"', 'name="slide"'), "exists already"),
    "child twice": (changed('<child link="tool"/>', '<child link="tip"/>'), "<constraint>"),
    "cycle": (
        changed('<parent link="base"/>', '<parent link="tool"/>').replace(
            '<link name="base"/>', ""
        ),
        "cycle",
    ),
    "two roots": (changed("</robot>", '<link name="other"/></robot>'), "no parent joint"),
    "negative damping": (changed('damping="0.3"', 'damping="-1"'), "not negative"),
    "nothing moves": ('<robot name="x"><link name="a"/></robot>', "--base free"),
    "itself": (
        changed(
            '<child link="rocker"/>\n        <parent_origin',
            '<child link="coupler"/>\n        <parent_origin',
            four_bar("urdf"),
        ),
        "rigidly connected",
    ),
}
MJCF = {
    "include cycle": ('<mujoco><include file="model.xml"/></mujoco>', "second time"),
    "include outside": ('<mujoco><include file="../secret.xml"/></mujoco>', "--root"),
    "include absolute": ('<mujoco><include file="/etc/passwd"/></mujoco>', "--root"),
    "missing include": ('<mujoco><include file="no.xml"/></mujoco>', "no such file"),
    "no such class": (
        '<mujoco><worldbody><body><joint class="x"/></body></worldbody></mujoco>',
        "no default class",
    ),
    "no size": (
        "<mujoco><worldbody><body><joint/><geom/></body></worldbody></mujoco>",
        "size",
    ),
    "global coordinates": (
        '<mujoco><compiler coordinate="global"/><worldbody/></mujoco>',
        "coordinate 'global'",
    ),
    "two orientations": (
        '<mujoco><worldbody><body><joint/><geom size="1" quat="1 0 0 0" euler="0 0 1"/></body>'
        "</worldbody></mujoco>",
        "keep one orientation",
    ),
    "copies of copies": (
        "<mujoco><worldbody>"
        + '<replicate count="900">' * 3
        + '<body><joint/><geom size="1"/></body>'
        + "</replicate>" * 3
        + "</worldbody></mujoco>",
        "more than 20000 copies in all",
    ),
    "second inertia": (
        '<mujoco><worldbody><body><joint/><inertial pos="0 0 0" mass="1"/><frame>'
        '<inertial pos="0 0 0" mass="1"/></frame></body></worldbody></mujoco>',
        "the first <inertial>",
    ),
    "copies": (
        '<mujoco><worldbody><replicate count="1000000000"><body/></replicate></worldbody></mujoco>',
        "expected 1 to",
    ),
    "mesh": (
        '<mujoco><asset><mesh name="m" file="../../etc/passwd"/></asset><worldbody><body><joint/>'
        '<geom type="mesh" mesh="m"/></body></worldbody></mujoco>',
        "<inertial>",
    ),
    "unknown body": (
        '<mujoco><worldbody><body name="a"><joint/><geom size="1"/></body></worldbody><equality>'
        '<connect body1="a" body2="b" anchor="0 0 0"/></equality></mujoco>',
        "no body 'b'",
    ),
    "unknown joint": (
        '<mujoco><worldbody><body name="a"><joint/><geom size="1"/></body></worldbody><actuator>'
        '<motor joint="b"/></actuator></mujoco>',
        "no joint 'b'",
    ),
}
SDF = {
    "frame cycle": (
        '<sdf><model name="m"><frame name="a"><pose relative_to="b"/></frame>'
        '<frame name="b"><pose relative_to="a"/></frame>'
        '<link name="l"><pose relative_to="a"/></link></model></sdf>',
        "cycle",
    ),
    "unknown frame": (
        '<sdf><model name="m"><link name="l"><pose relative_to="a">0 0 0 0 0 0</pose></link>'
        "</model></sdf>",
        "no frame 'a'",
    ),
    "include outside": (
        '<sdf><model name="m"><include><uri>../secret.sdf</uri></include></model></sdf>',
        "--root",
    ),
    "no axis": (four_bar("sdf").replace("<xyz>0 1 0</xyz>", "<xyz>0 0 0</xyz>"), "no direction"),
    "short pose": (four_bar("sdf").replace("0 0 0.5 0 0 0", "0 0 0.5"), "expected 6 numbers"),
}
LONG = ("copies of copies",)
CASES = [
    pytest.param(
        suffix,
        name,
        case,
        id=f"{suffix}-{name}",
        marks=[pytest.mark.thorough] * (name in LONG),
    )
    for suffix, cases in (("urdf", URDF), ("xml", MJCF), ("sdf", SDF))
    for name, case in cases.items()
]


@pytest.mark.parametrize(("suffix", "name", "case"), CASES)
def test_one_message_and_nothing_written(suffix, name, case, tmp_path, capsys):
    text, message = case
    folder = tmp_path / "robot"
    folder.mkdir()
    (tmp_path / "secret.xml").write_text("<mujoco/>", encoding="utf-8")
    (tmp_path / "secret.sdf").write_text("<sdf/>", encoding="utf-8")
    path = folder / f"model.{suffix}"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    assert main(["import", str(path), "-o", str(folder / "out.toml"), "--json"]) == 2
    error = json.loads(capsys.readouterr().out)["error"]["message"]
    assert message in error and str(path) in error and "\n" not in error
    assert [file.name for file in folder.iterdir()] == [path.name]


def test_meshes_outside_are_listed_and_never_opened(tmp_path):
    folder = tmp_path / "robot"
    folder.mkdir()
    (tmp_path / "secret.stl").write_text("solid", encoding="utf-8")
    for reference in (
        "../secret.stl",
        str(tmp_path / "secret.stl"),
        "package://robot/../secret.stl",
    ):
        mesh = f'<mesh filename="{reference}"/>'
        robot = imported(folder, ARM.replace('<box size="0.4 0.1 0.1"/>', mesh))
        assert "geometry" not in robot.document["bodies"]["upper"]
        assert any(o.content == "mesh" and "--root" in o.reason for o in robot.omissions)
    allowed = imported(folder, ARM.replace('<box size="0.4 0.1 0.1"/>', mesh), root=tmp_path)
    assert allowed.document["bodies"]["upper"]["geometry"][0]["file"].name == "secret.stl"


@pytest.mark.thorough
def test_many_links_are_refused_quickly(tmp_path):
    links = "".join(f'<link name="l{k}"/>' for k in range(600_000))
    with pytest.raises(da.BudgetError, match="elements"):
        imported(tmp_path, f'<robot name="many">{links}</robot>')


def test_impossible_inertia_can_be_repaired(tmp_path):
    robot = imported(tmp_path, URDF["inertia"][0], repair_inertia=True)
    assert any(o.content == "inertia" and "raised" in o.reason for o in robot.omissions)
    assert robot.build().diagnosis.degrees_of_freedom == 2


@settings(deadline=None, max_examples=60)
@given(st.binary(max_size=300), st.sampled_from(["urdf", "xml", "sdf"]))
def test_random_bytes_raise_only_own_errors(tmp_path_factory, data, suffix):
    with pytest.raises(da.DalembertError):
        imported(tmp_path_factory.mktemp("bytes"), data, suffix)


TEXTS = {"urdf": ARM, "xml": four_bar("xml"), "sdf": four_bar("sdf")}


@settings(deadline=None, max_examples=100)
@given(st.sampled_from(list(TEXTS)), st.data())
def test_damaged_files_raise_only_own_errors(tmp_path_factory, suffix, data):
    text = TEXTS[suffix]
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(text) - 1))
        length = data.draw(st.integers(0, 12))
        new = data.draw(st.sampled_from(["", "0", "-", " ", "1e9", '"', "<a/>", "name", "world"]))
        text = text[:at] + new + text[at + length :]
    with suppress(da.DalembertError):
        imported(tmp_path_factory.mktemp("damaged"), text, suffix).system()
