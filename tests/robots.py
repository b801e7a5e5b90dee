"""Robots in the formats that are imported."""

from __future__ import annotations

from pathlib import Path

import dalembert as da

ARM = """<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial>
      <origin xyz="0.2 0 0.1" rpy="0 0.3 0"/>
      <mass value="2"/>
      <inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0.01" ixz="0" iyz="-0.02"/>
    </inertial>
    <visual><geometry><box size="0.4 0.1 0.1"/></geometry></visual>
  </link>
  <link name="tip">
    <inertial><mass value="0.5"/><inertia ixx="0.01" iyy="0.01" izz="0.01"/></inertial>
  </link>
  <link name="tool"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/>
    <origin xyz="0 0 1" rpy="0 0 1.5707963267948966"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="2" effort="10" velocity="3"/>
    <dynamics damping="0.3"/>
  </joint>
  <joint name="slide" type="prismatic">
    <parent link="upper"/><child link="tip"/>
    <origin xyz="0.4 0 0"/>
    <axis xyz="1 0 0"/>
    <limit lower="0" upper="0.2"/>
  </joint>
  <joint name="mount" type="fixed">
    <parent link="tip"/><child link="tool"/>
    <origin xyz="0.1 0 0"/>
  </joint>
</robot>
"""
"""A hinge, a slide, a fixed tool, limits and damping."""

FOUR_BAR = {
    "urdf": """<robot name="four_bar"><link name="ground"/>
      {links}
      <joint name="O1" type="continuous"><parent link="ground"/><child link="crank"/>
        <origin xyz="0 0 0"/><axis xyz="0 1 0"/></joint>
      <joint name="A" type="continuous"><parent link="crank"/><child link="coupler"/>
        <origin xyz="0 0 0.5"/><axis xyz="0 1 0"/></joint>
      <joint name="O2" type="continuous"><parent link="ground"/><child link="rocker"/>
        <origin xyz="1 0 0"/><axis xyz="0 1 0"/></joint>
      <constraint name="B" type="spherical"><parent link="coupler"/><child link="rocker"/>
        <parent_origin xyz="1 0 0"/><child_origin xyz="0 0 0.5"/></constraint>
    </robot>""",
    "xml": """<mujoco model="four_bar"><worldbody>
      <body name="crank"><joint name="O1" axis="0 1 0"/>{crank}
        <body name="coupler" pos="0 0 0.5"><joint name="A" axis="0 1 0"/>{coupler}</body></body>
      <body name="rocker" pos="1 0 0"><joint name="O2" axis="0 1 0"/>{rocker}</body>
      </worldbody>
      <equality><connect name="B" body1="coupler" body2="rocker" anchor="1 0 0"/></equality>
    </mujoco>""",
    "sdf": """<sdf version="1.9"><world name="w"><gravity>0 0 -9.81</gravity><model name="four_bar">
      {links}
      <joint name="O1" type="revolute"><parent>world</parent><child>crank</child>
        <axis><xyz>0 1 0</xyz></axis></joint>
      <joint name="A" type="revolute"><parent>crank</parent><child>coupler</child>
        <axis><xyz>0 1 0</xyz></axis></joint>
      <joint name="O2" type="revolute"><parent>world</parent><child>rocker</child>
        <axis><xyz>0 1 0</xyz></axis></joint>
      <joint name="B" type="ball"><parent>coupler</parent><child>rocker</child>
        <pose>0 0 0.5 0 0 0</pose></joint>
    </model></world></sdf>""",
}
"""Format → a parallelogram with a ball joint that closes the loop."""
BARS = {
    "crank": (1.0, (0, 0, 0.25), (0, 0, 0)),
    "coupler": (2.0, (0.5, 0, 0), (0, 0, 0.5)),
    "rocker": (1.5, (0, 0, 0.25), (1, 0, 0)),
}
"""Bar of the parallelogram → mass, mass centre, position."""
MOMENT = 0.01
"""All principal moments of inertia of its bars [kg m²]."""


def four_bar(kind: str) -> str:
    """The parallelogram in a format."""
    bars = {}
    for name, (mass, center, place) in BARS.items():
        at = " ".join(map(str, center))
        if kind == "urdf":
            moments = f'ixx="{MOMENT}" iyy="{MOMENT}" izz="{MOMENT}"'
            bars[name] = (
                f'<link name="{name}"><inertial><origin xyz="{at}"/><mass value="{mass}"/>'
                f"<inertia {moments}/></inertial></link>"
            )
        elif kind == "xml":
            moments = f"{MOMENT} {MOMENT} {MOMENT}"
            bars[name] = f'<inertial pos="{at}" mass="{mass}" diaginertia="{moments}"/>'
        else:
            moments = "".join(f"<{m}>{MOMENT}</{m}>" for m in ("ixx", "iyy", "izz"))
            pose = " ".join(map(str, place))
            bars[name] = (
                f'<link name="{name}"><pose>{pose} 0 0 0</pose><inertial><pose>{at} 0 0 0</pose>'
                f"<mass>{mass}</mass><inertia>{moments}</inertia></inertial></link>"
            )
    return FOUR_BAR[kind].format(links="".join(bars.values()), **bars)


def imported(folder: Path, text: str | bytes, suffix: str = "urdf", **options) -> da.Imported:
    """The model of a text, as a file in a folder."""
    path = folder / f"model.{suffix}"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return da.import_model(path, **options)
