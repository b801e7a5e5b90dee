"""Bodies of solids: exact masses and moments of STEP files and meshes, places of assemblies."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

import dalembert as da
from dalembert.io.imports.registry import import_model

trimesh = pytest.importorskip("trimesh")
RADIUS, HEIGHT = 5.0, 30.0


def assembly(path: Path) -> Path:
    """A plate, and two instances of a shaft, one turned by 90° about x [mm]."""
    pytest.importorskip("OCP")
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
    from OCP.Message import Message
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.TCollection import TCollection_ExtendedString as Text
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDocStd import TDocStd_Document
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    for printer in list(Message.DefaultMessenger_s().Printers()):
        Message.DefaultMessenger_s().RemovePrinter(printer)
    document = TDocStd_Document(Text("XmlOcaf"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    whole = shapes.NewShape()
    plate = shapes.AddShape(BRepPrimAPI_MakeBox(20, 10, 5).Shape(), False)
    shaft = shapes.AddShape(BRepPrimAPI_MakeCylinder(RADIUS, HEIGHT).Shape(), False)
    for label, name in ((whole, "rig"), (plate, "base plate"), (shaft, "shaft")):
        TDataStd_Name.Set_s(label, Text(name))
    moved, turned = gp_Trsf(), gp_Trsf()
    moved.SetTranslation(gp_Vec(100, 0, 0))
    turned.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), math.pi / 2)
    for label, place in ((plate, gp_Trsf()), (shaft, moved), (shaft, turned)):
        shapes.AddComponent(whole, label, TopLoc_Location(place))
    shapes.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    writer.Transfer(document)
    writer.Write(str(path))
    return path


def test_assembly_of_a_step_file(tmp_path, capfd) -> None:
    """Closed forms of box and cylinder; instances keep their names and places."""
    path = assembly(tmp_path / "rig.step")
    imported = import_model(path, density=1000.0)
    assert capfd.readouterr().out == ""
    model = imported.build()
    names = [body.name for body in model.bodies]
    assert names == ["base_plate", "shaft", "shaft_2"]
    plate, shaft, turned = (imported.document["bodies"][name] for name in names)
    numbers = [float(e.removeprefix("density*").split()[0]) for e in shaft["inertia"]]
    volume = math.pi * RADIUS**2 * HEIGHT
    across = volume * (RADIUS**2 / 4 + HEIGHT**2 / 12)
    expected = np.array([across, across, volume * RADIUS**2 / 2]) * 1e-15
    np.testing.assert_allclose(numbers, expected, rtol=1e-9)
    assert shaft["position"] == [0.1, 0.0, 0.0] and "rotation" not in shaft
    assert plate["center_of_mass"] == [0.01, 0.005, 0.0025]
    assert np.allclose(turned["rotation"]["rows"], [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-12)
    assert model.parameters["density"].value == 1000
    total = import_model(path, mass="2 kg").build()
    assert total.parameters["density"].value == pytest.approx(2 / (1e-6 + 2 * volume * 1e-9))
    folder = tmp_path / "surfaces"
    folder.mkdir()
    drawn = import_model(path, surfaces=folder)
    assert len(list(folder.iterdir())) == 3
    assert {body["type"] for body in drawn.document["bodies"].values()} == {"Mesh"}
    assert da.load_model(drawn.write(tmp_path / "rig.toml")).build().bodies


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".ply", ".off"])
def test_mesh(suffix, tmp_path) -> None:
    path = tmp_path / f"brick{suffix}"
    trimesh.creation.box((20, 10, 5)).export(path)
    imported = import_model(path, unit="cm", density="2 g/cm^3")
    model = da.load_model(imported.write(tmp_path / "brick.toml")).build()
    fall = da.solve_dynamics(model, 0.1, step=0.1)
    energy = 2.0 * (9.81 * 0.1) ** 2 / 2  # 2 kg
    assert float(fall["kinetic_energy"][-1]) == pytest.approx(energy)
    assert imported.document["bodies"]["brick"]["scale"] == 0.01
    heavy = import_model(path, mass=3.0)
    assert heavy.document["parameters"]["density"]["value"] == pytest.approx(3 / 1e-6)


def test_parts_of_a_scene(tmp_path) -> None:
    """Parts of a glTF file are bodies, in metres; other folders are not read."""
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box((2, 1, 1)), node_name="left arm")
    shift = trimesh.transformations.translation_matrix((5, 0, 0))
    scene.add_geometry(trimesh.creation.box((1, 1, 1)), node_name="hand", transform=shift)
    path = tmp_path / "arm.glb"
    scene.export(path)
    imported = import_model(path)
    bodies = imported.document["bodies"]
    assert set(bodies) == {"left_arm", "hand"}
    assert bodies["hand"]["center_of_mass"] == pytest.approx([5, 0, 0])
    assert bodies["left_arm"]["mass"] == "density*2 m^3"
    assert imported.build().diagnosis.degrees_of_freedom == 12
    for uri in ("../../secret.bin", "http://example.org/a.bin", "/etc/passwd"):
        gltf = tmp_path / "arm.gltf"
        text = json.dumps({"asset": {"version": "2.0"}, "buffers": [{"uri": uri, "byteLength": 4}]})
        gltf.write_text(text, encoding="utf-8")
        with pytest.raises(da.FileError, match="not in its folder"):
            import_model(gltf)


def test_refused(tmp_path) -> None:
    """Open surfaces, empty files, other contents, contradictory options."""
    box = trimesh.creation.box((20, 10, 5))
    box.faces = box.faces[:-1]
    box.export(tmp_path / "open.stl")
    trimesh.creation.box((20, 10, 5)).export(tmp_path / "box.stl")
    for name, content in (
        ("empty.stl", b""),
        ("empty.step", b""),
        ("text.step", b"no step"),
        ("text.glb", b"glTF"),
        ("text.obj", b"\x00\xff"),
        ("head.step", b"ISO-10303-21;\nHEADER;\n"),
    ):
        (tmp_path / name).write_bytes(content)
    for name, options, message in (
        ("open.stl", {}, "no closed surface"),
        ("empty.stl", {}, "empty"),
        ("text.obj", {}, "text.obj"),
        ("text.glb", {}, "no glTF scene"),
        ("box.stl", {"density": 1, "mass": 1}, "not both"),
        ("box.stl", {"density": -1}, "above 0"),
        ("box.stl", {"unit": "kg"}, "does not fit"),
    ):
        with pytest.raises(da.DalembertError, match=message):
            import_model(tmp_path / name, **options)
    pytest.importorskip("OCP")
    for name, message in (
        ("empty.step", "empty"),
        ("text.step", "no STEP file"),
        ("head.step", "STEP"),
    ):
        with pytest.raises(da.FileError, match=message):
            import_model(tmp_path / name)
